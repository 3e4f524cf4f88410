//! The controller of a multicopter.

use core::fmt;
use core::time::Duration;

use fcc_core::blocks::wrap_two_pi;
use fcc_core::flight::{MOST_ROTORS, Measurements, Motors};
use fcc_core::framework::{Controller, Flags, Notice, Reading, Switch, Tick};
use fcc_core::units::GRAVITY_MPS2;
use libm::{hypot, tan};
use nalgebra::{UnitQuaternion, Vector3};

use crate::airframe::{Airframe, Refusal};
use crate::allocation::{Allocator, Demand};
use crate::attitude::{attitude_of_thrust, rates_to};
use crate::estimator::{Estimator, State};
use crate::gains::Gains;
use crate::guidance::{Guidance, ITEM_REACHED, Limits};
use crate::hover_thrust::HoverThrust;
use crate::landing::LandingDetector;
use crate::plan::Item;
use crate::position::{PositionLoop, Reference};
use crate::rate::RateLoop;
use crate::rotor_watch::RotorWatch;
use crate::values::{Command, Estimate, GroundContact, Mode, Setpoints, Shortfall};

/// Faults, conditions, and what prevents engaging.
pub mod flags {
    use fcc_core::framework::Flags;

    /// Attitude, heading, turn rates or acceleration are silent: it falls slowly.
    pub const NO_ATTITUDE: Flags = Flags::bit(0);
    /// Position or velocity are silent: it descends.
    pub const NO_POSITION: Flags = Flags::bit(1);
    /// Tilted by more than 30°.
    pub const TILTED: Flags = Flags::bit(2);
    /// Less than a fifth of the battery is left.
    pub const BATTERY_LOW: Flags = Flags::bit(3);
    /// A rotor does not turn: it flies on with the others, and holds its heading as far as they
    /// can.
    pub const ROTOR_LOST: Flags = Flags::bit(4);
}

/// A position may be older than an attitude by so many times.
const POSITION_AGES: u32 = 5;
/// The cosine of the tilt from which it does not engage: 30°.
const COS_ENGAGES: f64 = 0.866;
/// Without an attitude it only damps its turning, and descends: thrust over hover thrust.
const FALLS: f64 = 0.8;
/// On the ground the collective falls to this share of hovering, by so much in a second.
const SETTLED: f64 = 0.1;
const SETTLES_PER_S: f64 = 2.0;
/// A reference that sinks by less does not look for the ground, m/s.
const SINKS_MPS: f64 = 0.3;
/// Above home by more than this, or faster, it flies when it engages, m and m/s.
const FLIES_M: f64 = 2.0;
const FLIES_MPS: f64 = 1.5;

/// The configuration of a multicopter.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MulticopterConfig {
    /// The airframe.
    pub airframe: Airframe,
    /// The loop's period, s.
    pub period_s: f64,
    /// The age of the measurements when they arrive, s.
    pub latency_s: f64,
    /// What is not exceeded.
    pub limits: Limits,
    /// What is flown after engaging on the ground.
    pub plan: &'static [Item],
    /// Magnetic variation, rad, positive east.
    pub magnetic_variation_rad: f64,
    /// An attitude older than this is lost; a position five times as old.
    pub max_age: Duration,
}

impl Default for MulticopterConfig {
    fn default() -> Self {
        Self {
            airframe: Airframe::default(),
            period_s: 0.002_5,
            latency_s: 0.01,
            limits: Limits::default(),
            plan: &[],
            magnetic_variation_rad: 0.0,
            max_age: Duration::from_millis(100),
        }
    }
}

/// What a tick has demanded of the rotors.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Given {
    attitude: UnitQuaternion<f64>,
    reference: Reference,
    missing: Demand,
    /// Over hover thrust.
    thrust: f64,
}

/// The controller of a multicopter.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Multicopter {
    config: MulticopterConfig,
    attitude_gain: Vector3<f64>,
    estimator: Estimator,
    guidance: Guidance,
    position: PositionLoop,
    rate: RateLoop,
    allocator: Allocator,
    rotors: RotorWatch,
    /// The number of a rotor that is lost, from 0.
    lost: Option<usize>,
    hover: HoverThrust,
    landing: LandingDetector,
    given: Given,
    notice: Option<Notice>,
}

impl Multicopter {
    /// A multicopter on the ground.
    ///
    /// # Errors
    /// When it cannot be flown as configured: see [`Refusal`].
    pub fn new(config: &MulticopterConfig) -> Result<Self, Refusal> {
        let gains = Gains::of(&config.airframe, config.period_s, config.latency_s)?;
        let lag_s = config.airframe.motor_lag_s + config.latency_s;
        Ok(Self {
            attitude_gain: Vector3::new(1.0, 1.0, 0.5) * gains.attitude,
            estimator: Estimator::new(config.magnetic_variation_rad),
            guidance: Guidance::new(config.limits, config.plan),
            position: PositionLoop::new(gains),
            rate: RateLoop::new(&gains, &config.airframe),
            allocator: Allocator::new(&config.airframe)?,
            rotors: RotorWatch::new(&config.airframe, config.latency_s),
            lost: None,
            hover: HoverThrust::new(config.airframe.hover_share(), lag_s),
            landing: LandingDetector::LANDED,
            given: Given::default(),
            notice: None,
            config: *config,
        })
    }

    fn is_attitude_fresh(&self, tick: &Tick, measured: &Measurements) -> bool {
        let (now, age) = (tick.woke, self.config.max_age);
        self.are_rates_fresh(tick, measured)
            && measured.attitude.is_fresh(now, age)
            && measured.heading_rad.is_fresh(now, age)
            && measured.specific_force.is_fresh(now, age)
    }

    fn are_rates_fresh(&self, tick: &Tick, measured: &Measurements) -> bool {
        let age = self.config.max_age;
        measured.body_rates.is_fresh(tick.woke, age)
    }

    fn is_position_fresh(&self, tick: &Tick, measured: &Measurements) -> bool {
        let (now, age) = (tick.woke, self.config.max_age * POSITION_AGES);
        measured.velocity.is_fresh(now, age) && measured.position.is_fresh(now, age)
    }

    /// All motors off.
    fn off(&mut self) -> Motors {
        self.position.reset();
        self.rate.reset();
        self.given = Given::default();
        self.motors(&[0.0; MOST_ROTORS])
    }

    fn motors(&self, shares: &[f64]) -> Motors {
        let airframe = &self.config.airframe;
        let mut speeds = [None; MOST_ROTORS];
        let rotors = speeds.iter_mut().zip(airframe.rotors).zip(shares);
        for ((speed, rotor), share) in rotors {
            *speed = rotor.as_ref().map(|_| airframe.speed_of(*share));
        }
        Motors::from(speeds)
    }

    /// The motors for a reference.
    fn fly(&mut self, reference: &Reference, dt_s: f64) -> Motors {
        let mut state = *self.estimator.state();
        let hover = self.hover.share();
        state.drag_mps2 -= state.attitude * Vector3::z() * self.hover.surplus_mps2();
        let tan_tilt = tan(self.config.limits.tilt_rad);
        let mut thrust = self.position.step(&state, reference, tan_tilt, hover, dt_s);
        let free = 1.0 - self.landing.suspicion();
        thrust = Vector3::new(thrust.x * free, thrust.y * free, thrust.z);
        if self.landing.stage() != GroundContact::Flying {
            let falls = (self.given.thrust - SETTLES_PER_S * dt_s).max(SETTLED);
            thrust = Vector3::new(0.0, 0.0, -falls * GRAVITY_MPS2);
        }
        self.given.reference = *reference;
        self.given.attitude = attitude_of_thrust(&thrust, reference.heading_rad);
        let mut rates = rates_to(&self.given.attitude, &state.attitude, &self.attitude_gain);
        // About down, as the heading turns.
        rates += state.attitude.inverse() * Vector3::z() * reference.heading_rate_radps;
        let limits = self.guidance.limits();
        let (most, most_yaw) = (limits.rate_radps, 2.0 * limits.yaw_rate_radps);
        let scale = (most / hypot(rates.x, rates.y).max(1e-9)).min(1.0);
        let rates = Vector3::new(
            rates.x * scale,
            rates.y * scale,
            rates.z.clamp(-most_yaw, most_yaw),
        );
        // The vertical part is kept while the tilt follows.
        let collective = -thrust.z / state.cos_tilt().max(0.5);
        self.allocate(&state, collective, &rates, dt_s)
    }

    /// The motors for a specific thrust and turn rates.
    fn allocate(
        &mut self,
        state: &State,
        collective_mps2: f64,
        rates_radps: &Vector3<f64>,
        dt_s: f64,
    ) -> Motors {
        let missing = self.given.missing.fixed_rows::<3>(1).into_owned();
        let learns = self.landing.suspicion() <= 0.0;
        let rates = &state.rates_radps;
        let turn = self.rate.step(rates_radps, rates, &missing, learns, dt_s);
        // The allocation takes the thrust from the airframe; the hover thrust corrects it.
        let nominal = self.hover.share() / self.config.airframe.hover_share();
        let demand = Demand::new(collective_mps2 * nominal, turn.x, turn.y, turn.z);
        let allocated = self.allocator.allocate(&demand);
        self.given.missing = allocated.missing;
        // The ground turns it, too.
        if learns && self.lost.is_none() && !self.guidance.descends() {
            let effect = self.allocator.effectiveness();
            let lost = self.rotors.step(effect, &allocated.shares, rates, dt_s);
            let rest = lost.and_then(|rotor| self.allocator.without(rotor));
            if let Some(rest) = rest {
                (self.allocator, self.lost) = (rest, lost);
                self.rate.reset();
            }
        }
        let given_mps2 = (demand - allocated.missing).x;
        self.given.thrust = given_mps2 / (GRAVITY_MPS2 * nominal);
        self.motors(&allocated.shares)
    }
}

/// Roll, pitch and heading, rad.
fn angles(attitude: &UnitQuaternion<f64>) -> (f64, f64, f64) {
    let (roll_rad, pitch_rad, heading_rad) = attitude.euler_angles();
    (roll_rad, pitch_rad, wrap_two_pi(heading_rad))
}

impl Controller for Multicopter {
    type Measurements = Measurements;
    type Estimate = Estimate;
    type Setpoints = Setpoints;
    type Outputs = Motors;
    type Command = Command;

    fn estimate(&mut self, tick: &Tick, measured: &Measurements) {
        self.estimator.step(tick, measured);
    }

    fn engage_inhibits(&self, tick: &Tick, measured: &Measurements) -> Flags {
        let tilted = self.estimator.state().cos_tilt() < COS_ENGAGES;
        self.faults(tick, measured).with(flags::TILTED, tilted)
    }

    fn faults(&self, tick: &Tick, measured: &Measurements) -> Flags {
        let attitude = self.is_attitude_fresh(tick, measured);
        let position = self.is_position_fresh(tick, measured);
        Flags::NONE
            .with(flags::NO_ATTITUDE, !attitude)
            .with(flags::NO_POSITION, !position)
    }

    /// Until it has landed: nobody else can.
    fn failsafe_goes_on(&self) -> bool {
        !self.guidance.is_idle()
    }

    fn is_unattended(&self) -> bool {
        !self.guidance.is_idle()
    }

    fn releases_on_the_ground(&self) -> bool {
        true
    }

    fn prepare_release(&mut self, tick: &Tick, measured: &Measurements) -> bool {
        self.guidance.land(self.faults(tick, measured).is_empty());
        !self.guidance.is_idle()
    }

    fn is_ready_for_release(&self) -> bool {
        self.guidance.is_idle()
    }

    fn notices(&self) -> &[Notice] {
        self.notice.as_slice()
    }

    fn write_notice(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match notice.kind {
            ITEM_REACHED => write!(f, "item {} of the plan is flown", notice.item),
            _ => f.write_str("a notice of another version"),
        }
    }

    fn conditions(&self, _: &Tick, measured: &Measurements) -> Flags {
        let charge = measured.battery.value.charge;
        Flags::NONE
            .with(
                flags::BATTERY_LOW,
                charge.is_some_and(|charge| charge < 0.2),
            )
            .with(flags::ROTOR_LOST, self.lost.is_some())
    }

    fn flag_name(bit: u32) -> &'static str {
        match Flags::bit(bit) {
            flags::NO_ATTITUDE => "attitude, turn rates or acceleration are lost",
            flags::NO_POSITION => "position or velocity is lost",
            flags::TILTED => "tilted by more than 30°",
            flags::BATTERY_LOW => "the battery is below 20 %",
            flags::ROTOR_LOST => "a rotor does not turn: flown with the others",
            _ => "a condition of another version",
        }
    }

    fn write_command(command: &Command, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match command {
            Command::Hover => f.write_str("hover"),
            Command::TakeOff(height_m) => write!(f, "take off to {height_m:.1} m"),
            Command::GoTo(to) => write!(
                f,
                "go to {:.1} m north, {:.1} m east, {:.1} m high",
                to.north_m, to.east_m, to.height_m
            ),
            Command::Plan(item) => write!(f, "fly the plan from item {item} on"),
            Command::Circle(radius_m) => write!(f, "circle with a radius of {radius_m:.1} m"),
            Command::Return => f.write_str("return home"),
            Command::Land => f.write_str("land"),
            Command::Move(to) => write!(
                f,
                "move by {:.1} m/s forward, {:.1} m/s right, {:.1} m/s up, {:.0}°/s of yaw",
                to.forward_mps,
                to.right_mps,
                to.climb_mps,
                to.yaw_radps.to_degrees()
            ),
            Command::Tilt(to) => write!(
                f,
                "tilt by {:.1}° of roll, {:.1}° of pitch, {:.1} m/s up, {:.0}°/s of yaw",
                to.roll_rad.to_degrees(),
                to.pitch_rad.to_degrees(),
                to.climb_mps,
                to.yaw_radps.to_degrees()
            ),
            Command::StopMotors => f.write_str("stop the motors"),
        }
    }

    fn engage(&mut self, _: &Tick, _: &Measurements) {
        let state = *self.estimator.state();
        let flies = -state.position_m.z > FLIES_M || state.velocity_mps.norm() > FLIES_MPS;
        self.landing = if flies {
            LandingDetector::FLYING
        } else {
            LandingDetector::LANDED
        };
        if !flies {
            self.estimator.set_home();
        }
        self.guidance.engage(self.estimator.state(), flies);
        self.position.reset();
        self.rate.reset();
    }

    fn control(&mut self, tick: &Tick, _: &Measurements) -> Motors {
        let state = *self.estimator.state();
        let has_landed = self.landing.stage() == GroundContact::Landed;
        if has_landed && !self.guidance.descends() {
            self.landing = LandingDetector::FLYING;
        }
        let reference = self.guidance.step(&state, has_landed, tick.dt_s);
        self.notice = self.guidance.reached().map(|item| Notice {
            kind: ITEM_REACHED,
            item: item as u16,
            ..Notice::default()
        });
        let Some(reference) = reference else {
            self.landing = LandingDetector::LANDED;
            return self.off();
        };
        let motors = self.fly(&reference, tick.dt_s);
        let thrust = self.given.thrust;
        if self.landing.stage() == GroundContact::Flying {
            let given = thrust * self.hover.share();
            let specific_mps2 = -state.specific_force_mps2.z;
            let change = self.hover.update(given, specific_mps2, tick.dt_s);
            self.position.rescale(change);
        }
        let descends = reference.descends && reference.velocity_mps.z > SINKS_MPS;
        self.landing.step(descends, thrust, &state, tick.dt_s);
        motors
    }

    fn failsafe(&mut self, tick: &Tick, measured: &Measurements) -> Motors {
        let state = *self.estimator.state();
        self.guidance.land(false);
        if !self.is_attitude_fresh(tick, measured) && !self.guidance.is_idle() {
            if !self.are_rates_fresh(tick, measured) {
                return self.off();
            }
            return self.allocate(&state, FALLS * GRAVITY_MPS2, &Vector3::zeros(), tick.dt_s);
        }
        self.control(tick, measured)
    }

    fn disengage(&mut self) {
        self.guidance.stop();
    }

    fn command(&mut self, command: &Command) {
        self.guidance.command(command);
    }

    fn estimated(&self) -> Estimate {
        let state = self.estimator.state();
        let (roll_rad, pitch_rad, heading_rad) = angles(&state.attitude);
        let [thrust, roll, pitch, yaw] = self.given.missing.data.0[0];
        Estimate {
            north_m: state.position_m.x,
            east_m: state.position_m.y,
            height_m: -state.position_m.z,
            north_mps: state.velocity_mps.x,
            east_mps: state.velocity_mps.y,
            climb_mps: -state.velocity_mps.z,
            roll_rad,
            pitch_rad,
            heading_rad,
            hover_thrust: self.hover.share(),
            ground: self.landing.stage(),
            missing: Shortfall {
                thrust_mps2: thrust,
                roll_radps2: roll,
                pitch_radps2: pitch,
                yaw_radps2: yaw,
            },
        }
    }

    fn setpoints(&self) -> Setpoints {
        let Given {
            attitude,
            reference,
            ..
        } = &self.given;
        let (roll_rad, pitch_rad, heading_rad) = angles(attitude);
        let (mode, item) = self.guidance.mode();
        Setpoints {
            north_m: reference.position_m.x,
            east_m: reference.position_m.y,
            height_m: -reference.position_m.z,
            north_mps: reference.velocity_mps.x,
            east_mps: reference.velocity_mps.y,
            climb_mps: -reference.velocity_mps.z,
            roll_rad,
            pitch_rad,
            heading_rad,
            mode,
            item,
        }
    }

    fn mode(&self) -> u8 {
        self.guidance.mode().0 as u8
    }

    fn mode_name(mode: u8) -> &'static str {
        match Mode::from_number(mode) {
            Some(Mode::Idle) => "idle",
            Some(Mode::TakeOff) => "take-off",
            Some(Mode::Hover) => "hover",
            Some(Mode::GoTo) => "go-to",
            Some(Mode::Plan) => "plan",
            Some(Mode::Circle) => "circle",
            Some(Mode::Return) => "return",
            Some(Mode::Land) => "land",
            Some(Mode::Descend) => "descend",
            Some(Mode::Stick) => "stick",
            None => "a mode of another version",
        }
    }

    fn outputs_are_valid(&self, motors: &Motors) -> bool {
        motors.are_valid()
    }

    fn switch(&self, measured: &Measurements) -> Reading<Switch> {
        measured.engage_switch
    }
}

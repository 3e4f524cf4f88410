//! The equations of motion of a multicopter.

use fcc_core::flight::{BodyRates, MOST_ROTORS, SpecificForce, Velocity};
use libm::exp;
use nalgebra::{UnitQuaternion, Vector3};

use super::frame::{Frame, FrameRotor, LithiumBattery, density_share};
use crate::aircraft::LONGEST_STEP_S;
use crate::atmosphere::{Air, SEA_LEVEL_DENSITY_KGPM3};
use crate::config::{SimConfig, SimError};
use crate::ground::GroundBelow;
use crate::state::State;
use crate::truth::{Truth, turn};
use crate::turbulence::Dryden;
use crate::units::STANDARD_GRAVITY_MPS2;

/// Of a foot: N/m and N s/m. The weight presses it by 3 mm.
const STIFFNESS: f64 = 1_200.0;
const DAMPING: f64 = 30.0;
/// Of rubber on grass or concrete; below the speed it falls to nothing, m/s.
const FRICTION: f64 = 0.7;
const CREEPS_MPS: f64 = 0.05;
/// What the feet withstand, m/s.
const MOST_SINK_MPS: f64 = 3.0;
/// The cosine of the tilt at which rotors touch the ground: 60°.
const COS_CAPSIZED: f64 = 0.5;
/// The gusts' turning is that of a body of this size, m.
const SPAN_M: f64 = 0.5;

/// A multicopter and the air around it. It begins on the ground, motors off.
///
/// Semi-implicit Euler steps of the configured length: at 1 ms the fastest mode, a foot on the
/// ground with some 60 1/s, is stable and known to some percent; nothing else is faster than
/// the motors.
#[derive(Clone, Debug)]
pub struct Multirotor {
    frame: Frame,
    state: State,
    /// Of the rotors, rad/s.
    speeds_radps: [f64; MOST_ROTORS],
    specific_force_mps2: Vector3<f64>,
    wind_mps: Vector3<f64>,
    air_mps: Vector3<f64>,
    gusts: Option<Dryden>,
    downwind: UnitQuaternion<f64>,
    battery: LithiumBattery,
    below: GroundBelow,
    substep_s: f64,
    time_s: f64,
    impact_s: Option<f64>,
}

impl Multirotor {
    /// A frame in a world: of that the ground, the wind, the gusts, the heading, the step and the
    /// seed are used.
    ///
    /// # Errors
    /// [`SimError`] if a number of the world is out of range.
    pub fn new(frame: &Frame, world: &SimConfig) -> Result<Self, SimError> {
        world.validate()?;
        let below = GroundBelow::new(world);
        let (sin, cos) = libm::sincos(world.wind.from_rad);
        let wind_mps = Vector3::new(-cos, -sin, 0.0) * world.wind.speed_mps;
        let pressed_m = frame.mass_kg * STANDARD_GRAVITY_MPS2 / (4.0 * STIFFNESS);
        let altitude_m = below.elevation_m(0.0, 0.0) + frame.foot_m.z - pressed_m;
        Ok(Self {
            state: State {
                position_m: Vector3::new(0.0, 0.0, -altitude_m),
                velocity_mps: Vector3::zeros(),
                attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, world.heading_rad),
                rates_radps: Vector3::zeros(),
            },
            speeds_radps: [0.0; MOST_ROTORS],
            specific_force_mps2: Vector3::new(0.0, 0.0, -STANDARD_GRAVITY_MPS2),
            wind_mps,
            air_mps: wind_mps,
            gusts: world
                .gusts
                .map(|severity| Dryden::new(severity, world.seed)),
            downwind: UnitQuaternion::from_euler_angles(
                0.0,
                0.0,
                world.wind.from_rad + core::f64::consts::PI,
            ),
            battery: frame.battery,
            below,
            substep_s: world.substep_s,
            time_s: 0.0,
            impact_s: None,
            frame: frame.clone(),
        })
    }

    /// Simulates `dt_s`, at most [`LONGEST_STEP_S`], with motors at these shares of full speed,
    /// in equal steps; calls `watch` after each.
    pub fn step(&mut self, motors: &[f64; MOST_ROTORS], dt_s: f64, mut watch: impl FnMut(&Self)) {
        if dt_s.is_nan() || dt_s <= 0.0 {
            return;
        }
        let dt_s = dt_s.min(LONGEST_STEP_S);
        let count = libm::ceil(dt_s / self.substep_s - 1e-6).max(1.0);
        for _ in 0..count as u32 {
            self.substep(motors, dt_s / count);
            watch(self);
        }
    }

    fn substep(&mut self, motors: &[f64; MOST_ROTORS], dt_s: f64) {
        self.time_s += dt_s;
        if self.impact_s.is_some() {
            return;
        }
        self.blow(dt_s);
        let mut motors = *motors;
        if let Some((rotor, at_s)) = self.frame.stops
            && self.time_s >= at_s
            && let Some(stopped) = motors.get_mut(rotor)
        {
            *stopped = 0.0;
        }
        let (force_n, torque_nm) = self.loads(&motors, dt_s);
        let state = &mut self.state;
        let inertia = &self.frame.inertia_kgm2;
        let momentum = inertia.component_mul(&state.rates_radps);
        let net = torque_nm - state.rates_radps.cross(&momentum);
        self.specific_force_mps2 = force_n / self.frame.mass_kg;
        let mut acceleration = state.attitude * self.specific_force_mps2;
        acceleration.z += STANDARD_GRAVITY_MPS2;
        state.velocity_mps += acceleration * dt_s;
        state.position_m += state.velocity_mps * dt_s;
        state.rates_radps += net.component_div(inertia) * dt_s;
        let turned = UnitQuaternion::from_scaled_axis(state.rates_radps * dt_s);
        state.attitude = UnitQuaternion::new_normalize((state.attitude * turned).into_inner());
        if self.touches() {
            let capsized = (self.state.attitude * Vector3::z()).z < COS_CAPSIZED;
            if capsized || self.state.velocity_mps.z > MOST_SINK_MPS {
                self.impact_s = Some(self.time_s);
            }
        }
    }

    /// The air's velocity, north-east-down.
    fn blow(&mut self, dt_s: f64) {
        self.air_mps = self.wind_mps;
        let airspeed_mps = (self.state.velocity_mps - self.wind_mps).norm();
        let height_m = self.height_m();
        if let Some(gusts) = &mut self.gusts {
            let gust = gusts.step(dt_s, airspeed_mps, height_m, SPAN_M);
            self.air_mps += self.downwind * gust.velocity_mps;
        }
    }

    /// Force and torque of rotors, body and feet, body axes.
    fn loads(&mut self, motors: &[f64; MOST_ROTORS], dt_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let frame = &self.frame;
        let state = &self.state;
        let through_air = state
            .attitude
            .inverse_transform_vector(&(state.velocity_mps - self.air_mps));
        let density = density_share(state.altitude_m());
        let drag = 0.5 * SEA_LEVEL_DENSITY_KGPM3 * density * frame.drag_area_m2;
        let mut force = -through_air * (drag * through_air.norm());
        let mut torque = Vector3::zeros();
        let follows = 1.0 - exp(-dt_s / frame.motor_lag_s);
        let full_radps = frame.full_speed_radps * self.battery.voltage_share();
        let mut shafts_w = 0.0;
        let rotors = frame.rotors.iter().zip(&mut self.speeds_radps).zip(motors);
        for ((rotor, speed), motor) in rotors {
            let FrameRotor { place_m, clockwise } = *rotor;
            let change = (motor.clamp(0.0, 1.0) * full_radps - *speed) * follows;
            *speed += change;
            let flow = through_air + state.rates_radps.cross(&place_m);
            let climbs_mps = -flow.z;
            let thrust =
                density * *speed * (frame.thrust_n_s2 * *speed - frame.inflow_n_s2pm * climbs_mps);
            let thrust = thrust.max(0.0);
            let across = Vector3::new(flow.x, flow.y, 0.0);
            let on_hub =
                Vector3::new(0.0, 0.0, -thrust) - across * (density * frame.drag_n_s2pm * *speed);
            let shaft_nm = frame.torque_ratio_m * thrust;
            let reaction = shaft_nm + frame.rotor_inertia_kgm2 * change / dt_s;
            // A rotor that turns clockwise about down drives the body the other way.
            torque.z += if clockwise { -reaction } else { reaction };
            torque += place_m.cross(&on_hub);
            force += on_hub;
            shafts_w += shaft_nm * *speed;
        }
        self.battery.give(shafts_w, dt_s);
        let (on_feet, about) = self.on_feet();
        (force + on_feet, torque + about)
    }

    /// Force and torque of the ground on the feet, body axes.
    fn on_feet(&self) -> (Vector3<f64>, Vector3<f64>) {
        let state = &self.state;
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for foot_m in self.feet() {
            let arm = state.attitude * foot_m;
            let pressed_m = arm.z - self.height_m();
            if pressed_m <= 0.0 {
                continue;
            }
            let velocity = state.velocity_mps + state.attitude * state.rates_radps.cross(&foot_m);
            let normal_n = (STIFFNESS * pressed_m + DAMPING * velocity.z).max(0.0);
            let slides = Vector3::new(velocity.x, velocity.y, 0.0);
            let held = slides * (FRICTION * normal_n / slides.norm().max(CREEPS_MPS));
            let in_body = state
                .attitude
                .inverse_transform_vector(&(Vector3::new(0.0, 0.0, -normal_n) - held));
            force += in_body;
            torque += foot_m.cross(&in_body);
        }
        (force, torque)
    }

    fn feet(&self) -> [Vector3<f64>; 4] {
        let foot = self.frame.foot_m;
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
            .map(|(ahead, right)| Vector3::new(ahead * foot.x, right * foot.y, foot.z))
    }

    /// Whether a foot bears weight.
    pub fn touches(&self) -> bool {
        let height_m = self.height_m();
        let attitude = &self.state.attitude;
        self.feet()
            .iter()
            .any(|foot| (attitude * foot).z > height_m)
    }

    /// Height of the centre of gravity above the ground, m.
    pub fn height_m(&self) -> f64 {
        let place = &self.state.position_m;
        self.state.altitude_m() - self.below.elevation_m(place.x, place.y)
    }

    /// When it crashed, s of simulated time; its state is then held.
    pub const fn impact_s(&self) -> Option<f64> {
        self.impact_s
    }

    /// The battery.
    pub const fn battery(&self) -> &LithiumBattery {
        &self.battery
    }

    /// The rigid body's state.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Sets the rigid body's state, for experiments.
    pub const fn set_state(&mut self, state: State) {
        self.state = state;
    }

    /// The present truth; of control surfaces it has none.
    pub fn truth(&self) -> Truth {
        let state = &self.state;
        let (roll_rad, pitch_rad, heading_rad) = state.euler_rad();
        let airspeed_mps = (state.velocity_mps - self.air_mps).norm();
        let count = self.frame.rotors.len().max(1) as f64;
        let speeds: f64 = self.speeds_radps.iter().sum();
        Truth {
            time_s: self.time_s,
            roll_rad,
            pitch_rad,
            heading_rad: turn(heading_rad),
            rates: BodyRates {
                roll_radps: state.rates_radps.x,
                pitch_radps: state.rates_radps.y,
                yaw_radps: state.rates_radps.z,
            },
            specific_force: SpecificForce {
                x_mps2: self.specific_force_mps2.x,
                y_mps2: self.specific_force_mps2.y,
                z_mps2: self.specific_force_mps2.z,
            },
            true_airspeed_mps: airspeed_mps,
            indicated_airspeed_mps: Air::at(state.altitude_m()).indicated_mps(airspeed_mps),
            north_m: state.position_m.x,
            east_m: state.position_m.y,
            altitude_m: state.altitude_m(),
            velocity: Velocity {
                north_mps: state.velocity_mps.x,
                east_mps: state.velocity_mps.y,
                down_mps: state.velocity_mps.z,
            },
            throttle: speeds / (count * self.frame.full_speed_radps),
            ..Truth::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.001;

    fn world() -> SimConfig {
        SimConfig {
            substep_s: DT_S,
            ..SimConfig::default()
        }
    }

    fn after(body: &mut Multirotor, share: f64, seconds: f64) {
        body.step(&[share; MOST_ROTORS], seconds, |_| ());
    }

    /// Motors off on the ground: the feet carry the weight, and an accelerometer reads 1 g.
    #[test]
    fn it_stands_on_its_feet() {
        let mut body = Multirotor::new(&Frame::quadrotor(), &world()).unwrap();
        after(&mut body, 0.0, 1.0);
        let truth = body.truth();
        assert!(truth.velocity.down_mps.abs() < 1e-6 && body.touches());
        assert!((truth.specific_force.z_mps2 + STANDARD_GRAVITY_MPS2).abs() < 1e-3);
        assert!(body.impact_s().is_none());
    }

    /// Full thrust over weight minus one, in the first moment; then momentum theory: a climb at
    /// the induced velocity of hovering takes some 40 % of it (between the 25 % of an ideal
    /// actuator disc with constant power and the 50 % of a fixed pitch at zero inflow).
    #[test]
    fn it_climbs_by_its_thrust() {
        let frame = Frame::quadrotor();
        let mut body = Multirotor::new(&frame, &world()).unwrap();
        after(&mut body, 1.0, 0.15);
        let up = -body.truth().specific_force.z_mps2;
        let (full_n, weight_n) = (4.0 * frame.thrust_n_s2 * 960.0_f64.powi(2), 13.73);
        // A battery that gives so much has 14 % less voltage.
        assert!((up * 1.4 / full_n - 0.74).abs() < 0.06, "{up}");
        assert!((full_n / weight_n - 3.4).abs() < 0.1);
        let hover_radps = (weight_n / 4.0 / frame.thrust_n_s2).sqrt();
        let disc_m2 = core::f64::consts::PI * 0.127_f64.powi(2);
        let induced_mps = (weight_n / 4.0 / (2.0 * SEA_LEVEL_DENSITY_KGPM3 * disc_m2)).sqrt();
        let lost_n = frame.inflow_n_s2pm * hover_radps * induced_mps;
        assert!(
            (0.25..0.5).contains(&(lost_n / (weight_n / 4.0))),
            "{lost_n}"
        );
    }

    /// A rotor's lag: 63 % of the speed after one time constant.
    #[test]
    fn motors_lag() {
        let frame = Frame::quadrotor();
        let mut body = Multirotor::new(&frame, &world()).unwrap();
        after(&mut body, 0.3, frame.motor_lag_s);
        let share = body.speeds_radps[0] / (0.3 * frame.full_speed_radps);
        assert!((share - 0.632).abs() < 0.01, "{share}");
    }

    /// It falls on the ground with 6 m/s, or on its back: both end it.
    #[test]
    fn a_crash_ends_the_flight() {
        for (height_m, roll_rad) in [(4.0, 0.0), (0.2, 2.5)] {
            let mut body = Multirotor::new(&Frame::quadrotor(), &world()).unwrap();
            let mut state = *body.state();
            state.position_m.z = -height_m;
            state.attitude = UnitQuaternion::from_euler_angles(roll_rad, 0.0, 0.0);
            body.set_state(state);
            after(&mut body, 0.0, 1.0);
            assert!(body.impact_s().is_some());
        }
    }

    /// Rotors that turn counter-clockwise faster than the others drive the body clockwise.
    #[test]
    fn reaction_torque_yaws() {
        let mut body = Multirotor::new(&Frame::quadrotor(), &world()).unwrap();
        let mut state = *body.state();
        state.position_m.z = -50.0;
        body.set_state(state);
        body.step(&[0.66, 0.6, 0.66, 0.6, 0.0, 0.0, 0.0, 0.0], 0.3, |_| ());
        let rates = body.truth().rates;
        assert!(rates.yaw_radps > 0.1, "{rates:?}");
        assert!(rates.roll_radps.abs() < 1e-9 && rates.pitch_radps.abs() < 1e-9);
    }
}

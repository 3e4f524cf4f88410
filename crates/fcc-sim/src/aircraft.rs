//! The plant: an aircraft and the air around it, advanced by surfaces and time.

use fcc_core::flight::{BodyRates, SpecificForce, Surfaces, Velocity};
use nalgebra::{UnitQuaternion, Vector3};

use crate::aerodynamics::{Deflections, Flow};
use crate::airframe::Airframe;
use crate::atmosphere::Air;
use crate::config::{SimConfig, SimError};
use crate::electrical::Battery;
use crate::gear::{Ground, MOST_SINK_MPS};
use crate::ground::GroundBelow;
use crate::motion::{self, AirMotion, State};
use crate::propeller::{running_radps, stopped_radps};
use crate::servos::{Servos, deflections};
use crate::trim::{Trim, trim};
use crate::truth::{Truth, turn};
use crate::turbulence::Dryden;

/// The longest time that one step simulates, s. A loop that was halted for
/// longer, by a debugger or a suspended computer, must not then simulate hours
/// of flight.
pub const LONGEST_STEP_S: f64 = 1.0;

/// An aircraft in flight.
///
/// It starts trimmed, with the elevator's trim tab set: with all surfaces zero
/// and the throttle at [`Trim::throttle`] it flies straight and level.
#[derive(Clone, Debug)]
pub struct Aircraft {
    airframe: Airframe,
    servos: Servos,
    trim: Trim,
    state: State,
    positions: Surfaces,
    /// The last commands that were valid.
    commands: Surfaces,
    motion: AirMotion,
    gusts: Option<Dryden>,
    substep_s: f64,
    time_s: f64,
    diverged: bool,
    below: GroundBelow,
    /// It touched the ground faster than its gear withstands.
    crashes: bool,
    impact_s: Option<f64>,
    /// The commands with hands off the controls.
    hands_off: Surfaces,
    engine_stops_at_s: Option<f64>,
    battery: Battery,
}

impl Aircraft {
    /// The aircraft as configured, trimmed for level flight.
    ///
    /// # Errors
    /// [`SimError`] if a number is out of range or there is no trim.
    pub fn new(config: &SimConfig) -> Result<Self, SimError> {
        config.validate()?;
        let trim = trim(
            &config.airframe,
            config.indicated_airspeed_mps,
            config.altitude_m,
        )?;
        let (sin_wind, cos_wind) = libm::sincos(config.wind.from_rad);
        let wind_mps = Vector3::new(-cos_wind, -sin_wind, 0.0) * config.wind.speed_mps;
        let (sin_heading, cos_heading) = libm::sincos(config.heading_rad);
        let through_air = Vector3::new(cos_heading, sin_heading, 0.0) * trim.true_airspeed_mps;
        let below = GroundBelow::new(config);
        let (velocity_mps, altitude_m, pitch_rad, hands_off) = if config.on_runway {
            let height_m = config.airframe.gear.main.at_m.z;
            let parked = Surfaces {
                left_brake: Some(1.0),
                right_brake: Some(1.0),
                elevator_trim: Some(0.0),
                ..Surfaces::IDLE
            };
            (
                Vector3::zeros(),
                below.elevation_m(0.0, 0.0) + height_m,
                0.0,
                parked,
            )
        } else {
            let flying = through_air + wind_mps;
            (flying, config.altitude_m, trim.alpha_rad, hands_off(&trim))
        };
        Ok(Self {
            airframe: config.airframe,
            servos: config.servos,
            trim,
            state: State {
                position_m: Vector3::new(0.0, 0.0, -altitude_m),
                velocity_mps,
                attitude: UnitQuaternion::from_euler_angles(0.0, pitch_rad, config.heading_rad),
                rates_radps: Vector3::zeros(),
            },
            positions: hands_off,
            commands: hands_off,
            motion: AirMotion {
                wind_mps,
                ..AirMotion::CALM
            },
            gusts: config
                .gusts
                .map(|severity| Dryden::new(severity, config.seed)),
            substep_s: config.substep_s,
            time_s: 0.0,
            diverged: false,
            below,
            crashes: false,
            impact_s: None,
            hands_off,
            engine_stops_at_s: config.engine_stops_at_s,
            battery: Battery::new(config.electrical),
        })
    }

    /// Simulates `dt_s` under these commands, at most [`LONGEST_STEP_S`], in
    /// equal sub-steps no longer than configured. Returns the simulated time,
    /// s. Invalid commands are ignored, and the last valid ones held.
    pub fn step(&mut self, commands: &Surfaces, dt_s: f64) -> f64 {
        self.step_watched(commands, dt_s, |_| ())
    }

    /// Like [`step`](Self::step), calling `watch` with the aircraft after each
    /// sub-step.
    pub fn step_watched(
        &mut self,
        commands: &Surfaces,
        dt_s: f64,
        mut watch: impl FnMut(&Self),
    ) -> f64 {
        /// Tolerance: rounding may make the number of sub-steps of a tick
        /// slightly more than a whole number.
        const ROUNDING: f64 = 1e-6;
        if commands.is_valid() {
            self.commands = *commands;
        }
        if dt_s.is_nan() || dt_s <= 0.0 || self.diverged {
            return 0.0;
        }
        let dt_s = dt_s.min(LONGEST_STEP_S);
        let count = libm::ceil(dt_s / self.substep_s - ROUNDING).max(1.0);
        let substep_s = dt_s / count;
        for _ in 0..count as u32 {
            self.substep(substep_s);
            watch(self);
        }
        let engine_radps = self.engine_speed_radps();
        self.battery.step(dt_s, self.time_s, engine_radps);
        dt_s
    }

    fn substep(&mut self, dt_s: f64) {
        if self.impact_s.is_some() {
            self.time_s += dt_s;
            return;
        }
        let air = Air::at(self.state.altitude_m());
        self.positions = self.servos.follow(&self.positions, &self.commands, dt_s);
        let height_m = self.height_m();
        if let Some(gusts) = &mut self.gusts {
            let flow = Flow::of(&self.state.air_velocity_mps(&self.motion));
            let gust = gusts.step(dt_s, flow.airspeed_mps, height_m, self.airframe.wing_span_m);
            self.motion.gust_mps = gust.velocity_mps;
            self.motion.gust_rates_radps = gust.rates_radps;
        }
        // The air's density changes by less than a millionth within a step.
        let next = self.state.after(
            dt_s,
            &self.airframe,
            &self.deflections(),
            &self.motion,
            &air,
            self.ground(&self.state).as_ref(),
        );
        // The ground may rise towards it.
        let rises_mps = (self.ground_m(&next) - self.ground_m(&self.state)) / dt_s;
        if next.is_finite() {
            let closes_mps = next.velocity_mps.z + rises_mps;
            self.crashes |= closes_mps > MOST_SINK_MPS && self.on_wheels_in(&next);
            self.state = next;
        } else {
            self.diverged = true;
        }
        self.time_s += dt_s;
        if self.height_m() <= 0.0 && self.state.velocity_mps.z + rises_mps > 0.0 {
            self.impact_s = Some(self.time_s);
        }
    }

    /// The ground, as far as the gear withstands it.
    fn ground(&self, state: &State) -> Option<Ground> {
        let brake = |brake: Option<f64>| brake.unwrap_or(0.0);
        let positions = &self.positions;
        (!self.crashes).then(|| Ground {
            altitude_m: self.ground_m(state),
            brakes: [brake(positions.left_brake), brake(positions.right_brake)],
            steering: positions.nose_wheel.unwrap_or(positions.rudder),
        })
    }

    fn on_wheels_in(&self, state: &State) -> bool {
        let gear = &self.airframe.gear;
        self.ground(state)
            .is_some_and(|ground| gear.touches(state, &ground))
    }

    /// Whether a wheel bears weight.
    pub fn on_wheels(&self) -> bool {
        self.on_wheels_in(&self.state)
    }

    /// Height of the centre of gravity above the ground, m.
    pub fn height_m(&self) -> f64 {
        self.state.altitude_m() - self.ground_m(&self.state)
    }

    /// The elevation of the ground below, m above mean sea level.
    fn ground_m(&self, state: &State) -> f64 {
        let position_m = state.position_m;
        self.below.elevation_m(position_m.x, position_m.y)
    }

    /// When it hit the ground, s of simulated time; its state is then held as it
    /// was at the impact. Its gear withstands a sink rate of 10 ft/s.
    pub fn impact_s(&self) -> Option<f64> {
        self.impact_s
    }

    /// Simulated time, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Whether the equations diverged; the aircraft's state is then held.
    pub fn has_diverged(&self) -> bool {
        self.diverged
    }

    /// The trim that the flight began with.
    pub fn trim(&self) -> &Trim {
        &self.trim
    }

    /// The commands with hands off the controls: the throttle and the neutral
    /// surfaces of the beginning, and the elevator's trim where it is.
    pub fn hands_off(&self) -> Surfaces {
        Surfaces {
            elevator_trim: self.positions.elevator_trim,
            ..self.hands_off
        }
    }

    /// The airframe.
    pub fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// The rigid body's state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Sets the rigid body's state, for experiments.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
    }

    /// The present deflections of the control surfaces and the throttle, which an engine
    /// that has stopped has closed.
    pub fn deflections(&self) -> Deflections {
        let found = deflections(
            &self.airframe.travel,
            &self.positions,
            self.trim.elevator_rad,
        );
        if self.engine_is_out() {
            return Deflections {
                throttle: 0.0,
                ..found
            };
        }
        found
    }

    /// Whether the engine has stopped, as configured.
    fn engine_is_out(&self) -> bool {
        self.engine_stops_at_s
            .is_some_and(|stops_s| self.time_s >= stops_s)
    }

    /// The speed of the engine and its propeller, rad/s.
    pub fn engine_speed_radps(&self) -> f64 {
        let propulsion = &self.airframe.propulsion;
        let air = Air::at(self.state.altitude_m());
        let airspeed_mps = self.state.air_velocity_mps(&self.motion).norm();
        if self.engine_is_out() {
            stopped_radps(propulsion, airspeed_mps, &air)
        } else {
            running_radps(propulsion, self.positions.throttle, airspeed_mps, &air)
        }
    }

    /// The battery.
    pub fn battery(&self) -> &Battery {
        &self.battery
    }

    /// The present truth.
    pub fn truth(&self) -> Truth {
        let state = &self.state;
        let deflections = self.deflections();
        let air = Air::at(state.altitude_m());
        let flow = Flow::of(&state.air_velocity_mps(&self.motion));
        let ground = self.ground(state);
        let slope = motion::derivative(
            &self.airframe,
            state,
            &deflections,
            &self.motion,
            &air,
            ground.as_ref(),
        );
        let (roll_rad, pitch_rad, heading_rad) = state.euler_rad();
        let force = slope.specific_force_mps2;
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
                x_mps2: force.x,
                y_mps2: force.y,
                z_mps2: force.z,
            },
            true_airspeed_mps: flow.airspeed_mps,
            indicated_airspeed_mps: air.indicated_mps(flow.airspeed_mps),
            angle_of_attack_rad: flow.alpha_rad,
            sideslip_rad: flow.beta_rad,
            north_m: state.position_m.x,
            east_m: state.position_m.y,
            altitude_m: state.altitude_m(),
            velocity: Velocity {
                north_mps: state.velocity_mps.x,
                east_mps: state.velocity_mps.y,
                down_mps: state.velocity_mps.z,
            },
            throttle: deflections.throttle,
            elevator_rad: deflections.elevator_rad,
            aileron_rad: deflections.aileron_rad,
            rudder_rad: deflections.rudder_rad,
        }
    }
}

fn hands_off(trim: &Trim) -> Surfaces {
    Surfaces {
        throttle: trim.throttle,
        elevator_trim: Some(0.0),
        ..Surfaces::default()
    }
}

//! Where the multicopter is and how it moves, from measured states.
//!
//! Attitude and turn rates are used as measured. Position and velocity are those of the
//! accelerometer, corrected by what is measured: so the noise of a satellite receiver does not
//! reach the rotors, and gusts do not wait for its next fix.

use core::time::Duration;

use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::orientation::{EulerAngles, quaternion_from_euler};
use fcc_core::flight::{Measurements, Position};
use fcc_core::framework::{Reading, Tick, Time};
use fcc_core::units::GRAVITY_MPS2;
use libm::exp;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// How fast a difference from the measured position and velocity disappears, 1/s.
const POSITION_PER_S: f64 = 0.25;
const VELOCITY_PER_S: f64 = 3.0;
/// The same of the accelerometer's bias, 1/s².
const BIAS_PER_S2: f64 = 0.3;
/// As long as this after the first position, home is where it is.
const HOME_SETTLES: Duration = Duration::from_secs(1);
/// The time constant of the measured drag, s: gusts last longer, vibrations do not.
const DRAG_S: f64 = 0.05;
/// Motion, north-east-down from home.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct State {
    /// m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// Turns body axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// About the body axes, rad/s.
    pub rates_radps: Vector3<f64>,
    /// Along the body axes, m/s².
    pub specific_force_mps2: Vector3<f64>,
    /// What acts across the thrust, smoothed, m/s²: the drag of rotors and body in the wind.
    pub drag_mps2: Vector3<f64>,
}

impl State {
    /// The cosine of the tilt.
    pub fn cos_tilt(&self) -> f64 {
        (self.attitude * Vector3::z()).z
    }
}

/// Estimates a [`State`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Estimator {
    state: State,
    bias_mps2: Vector3<f64>,
    magnetic_variation_rad: f64,
    /// None before the first position.
    home: Option<Position>,
    /// When that was measured.
    home_since: Time,
    velocity: Correction,
    position: Correction,
}

impl Estimator {
    /// With the magnetic variation of the place, rad, positive east.
    pub fn new(magnetic_variation_rad: f64) -> Self {
        Self {
            state: State::default(),
            bias_mps2: Vector3::zeros(),
            magnetic_variation_rad,
            home: None,
            home_since: Time::NEVER,
            velocity: Correction::new(VELOCITY_PER_S),
            position: Correction::new(POSITION_PER_S),
        }
    }

    /// The present state.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Home is where it is now.
    pub fn set_home(&mut self) {
        let offset_m = self.state.position_m;
        if let Some(home) = &mut self.home {
            let (north, east) = metres_per_radian(home.latitude_rad, 0.0);
            home.latitude_rad += offset_m.x / north;
            home.longitude_rad += offset_m.y / east;
            home.altitude_m -= offset_m.z;
            self.state.position_m = Vector3::zeros();
        }
    }

    /// Takes a tick's measurements.
    pub fn step(&mut self, tick: &Tick, measured: &Measurements) {
        let (rates, force) = (measured.body_rates.value, measured.specific_force.value);
        let [w, x, y, z] = quaternion_from_euler(EulerAngles {
            roll_rad: measured.attitude.value.roll_rad,
            pitch_rad: measured.attitude.value.pitch_rad,
            heading_rad: measured.heading_rad.value + self.magnetic_variation_rad,
        });
        let state = &mut self.state;
        state.attitude = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        state.rates_radps = Vector3::new(rates.roll_radps, rates.pitch_radps, rates.yaw_radps);
        state.specific_force_mps2 = Vector3::new(force.x_mps2, force.y_mps2, force.z_mps2);
        let gravity = Vector3::new(0.0, 0.0, GRAVITY_MPS2);
        let acceleration = state.attitude * state.specific_force_mps2 + gravity - self.bias_mps2;
        state.velocity_mps += acceleration * tick.dt_s;
        let across = Vector3::new(force.x_mps2, force.y_mps2, 0.0);
        let change = state.attitude * across - state.drag_mps2;
        state.drag_mps2 += change * (tick.dt_s / (DRAG_S + tick.dt_s));
        state.position_m += state.velocity_mps * tick.dt_s;
        self.correct_velocity(measured);
        self.correct_position(measured);
    }

    fn correct_velocity(&mut self, measured: &Measurements) {
        let velocity = measured.velocity.value;
        let seen = Vector3::new(velocity.north_mps, velocity.east_mps, velocity.down_mps);
        let error = seen - self.state.velocity_mps;
        let Some((share, since_s)) = self.velocity.share(&measured.velocity) else {
            return;
        };
        self.state.velocity_mps += error * share;
        if self.velocity.is_settled() {
            self.bias_mps2 -= error * (BIAS_PER_S2 * since_s.min(1.0));
        }
    }

    fn correct_position(&mut self, measured: &Measurements) {
        let Some((share, _)) = self.position.share(&measured.position) else {
            return;
        };
        let place = measured.position.value;
        let taken = measured.position.taken;
        if self.home.is_none() {
            self.home_since = taken;
        }
        let home = *self.home.get_or_insert(place);
        let (north, east) = metres_per_radian(home.latitude_rad, 0.0);
        let seen = Vector3::new(
            north * (place.latitude_rad - home.latitude_rad),
            east * fcc_core::blocks::wrap_pi(place.longitude_rad - home.longitude_rad),
            home.altitude_m - place.altitude_m,
        );
        self.state.position_m += (seen - self.state.position_m) * share;
        // The first position alone is noise.
        if taken.since(self.home_since) < HOME_SETTLES {
            self.set_home();
        }
    }
}

/// What share of a difference each reading corrects: the mean of the first ones, and later as
/// much as disappears since the last one.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Correction {
    per_s: f64,
    count: f64,
    last: Time,
}

impl Correction {
    const fn new(per_s: f64) -> Self {
        Self {
            per_s,
            count: 0.0,
            last: Time::NEVER,
        }
    }

    /// The share, and the time since the last reading, s; none if it is the same one.
    fn share<T>(&mut self, reading: &Reading<T>) -> Option<(f64, f64)> {
        if reading.is_never() || reading.taken == self.last {
            return None;
        }
        let since_s = reading.taken.since(self.last).as_secs_f64();
        self.last = reading.taken;
        self.count += 1.0;
        Some((
            (1.0 - exp(-self.per_s * since_s)).max(1.0 / self.count),
            since_s,
        ))
    }

    fn is_settled(&self) -> bool {
        self.count > 100.0
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::{Attitude, BodyRates, SpecificForce, Velocity};

    use super::*;

    /// Accelerates by 2 m/s² to the east from 47° north, with an accelerometer that errs by
    /// 0.1 m/s² and fixes that come five times a second: after a while position and velocity
    /// are s = ½at² and v = at.
    #[test]
    fn an_accelerometer_is_corrected_by_fixes() {
        let mut estimator = Estimator::new(0.0);
        let dt_s = 0.0025;
        let mut measured = Measurements::default();
        let (mut speed_mps, mut way_m) = (0.0, 0.0);
        for number in 0..8_000_u32 {
            let time_s = f64::from(number) * dt_s;
            let acceleration = if time_s > 15.0 { 2.0 } else { 0.0 };
            (speed_mps, way_m) = (speed_mps + acceleration * dt_s, way_m + speed_mps * dt_s);
            let woke = Time::from_nanos(1 + i64::from(number) * 2_500_000);
            let tick = Tick {
                woke,
                dt_s,
                ..Tick::default()
            };
            measured.attitude = Reading::new(Attitude::default(), woke);
            measured.heading_rad = Reading::new(0.0, woke);
            measured.body_rates = Reading::new(BodyRates::default(), woke);
            let force = SpecificForce {
                y_mps2: acceleration + 0.1,
                z_mps2: -GRAVITY_MPS2,
                ..SpecificForce::default()
            };
            measured.specific_force = Reading::new(force, woke);
            if number % 80 == 0 {
                // A degree of longitude at 47° is 76,056 m (NGA's calculator).
                let longitude_rad = (way_m / 76_056.0).to_radians();
                let latitude_rad = 47.0_f64.to_radians();
                let place = Position {
                    latitude_rad,
                    longitude_rad,
                    altitude_m: 400.0,
                };
                measured.position = Reading::new(place, woke);
                let velocity = Velocity {
                    east_mps: speed_mps,
                    ..Velocity::default()
                };
                measured.velocity = Reading::new(velocity, woke);
            }
            estimator.step(&tick, &measured);
        }
        let state = estimator.state();
        assert!(
            (state.position_m.y - way_m).abs() < 0.2,
            "{} {way_m}",
            state.position_m
        );
        assert!(
            (state.velocity_mps.y - speed_mps).abs() < 0.05,
            "{}",
            state.velocity_mps
        );
        assert!(state.position_m.x.abs() < 1e-6 && state.position_m.z.abs() < 1e-6);
    }
}

//! Which readings are new, and what a solution says in the place of others.

use crate::inertial::{GeodeticPosition, Solution};
use fcc_core::flight::orientation::euler_from_quaternion;
use fcc_core::flight::{
    Attitude, BodyRates, GnssFix, MagneticField, Measurements, PlantState, SpecificForce,
};
use fcc_core::framework::schema::{Schema, in_range};
use fcc_core::framework::{Reading, Time};

/// Roll and pitch less certain than this are none, rad.
const USABLE_TILT: f64 = 0.15;

/// Rates as a vector, rad/s.
pub(super) const fn rates_in(of: &BodyRates) -> [f64; 3] {
    [of.roll_radps, of.pitch_radps, of.yaw_radps]
}

/// Specific force as a vector, m/s².
pub(super) const fn force_in(of: &SpecificForce) -> [f64; 3] {
    [of.x_mps2, of.y_mps2, of.z_mps2]
}

/// A magnetic field as a vector, µT.
pub(super) const fn field_in(of: &MagneticField) -> [f64; 3] {
    [of.x_ut, of.y_ut, of.z_ut]
}

/// The place of a fix.
pub(super) const fn place_in(of: &GnssFix) -> GeodeticPosition {
    GeodeticPosition {
        latitude_rad: of.position.latitude_rad,
        longitude_rad: of.position.longitude_rad,
        altitude_m: of.position.altitude_m,
    }
}

/// The velocity of a fix: north, east, down, m/s.
pub(super) const fn velocity_in(of: &GnssFix) -> [f64; 3] {
    let v = &of.velocity;
    [v.north_mps, v.east_mps, v.down_mps]
}

/// What a raw reading says, or the one that is measured if there is none.
pub(super) fn either<R: Copy, T>(
    raw: Reading<R>,
    says: impl FnOnce(R) -> T,
    measured: Reading<T>,
) -> Reading<T> {
    if raw.is_never() {
        return measured;
    }
    Reading {
        value: says(raw.value),
        taken: raw.taken,
        source: raw.source,
    }
}

pub(super) fn attitude_of(solution: &Solution, at: Time) -> Option<Reading<Attitude>> {
    let angles = euler_from_quaternion(solution.quaternion);
    let sigma = solution.sigma;
    let is_known = angles.roll_rad.is_finite()
        && angles.pitch_rad.is_finite()
        && is_certain(sigma.roll_rad.max(sigma.pitch_rad), USABLE_TILT);
    is_known.then(|| {
        let attitude = Attitude {
            pitch_rad: angles.pitch_rad,
            roll_rad: angles.roll_rad,
        };
        Reading::new(attitude, at)
    })
}

pub(super) fn rates_of(raw: &Reading<BodyRates>, solution: &Solution) -> Reading<BodyRates> {
    let [roll, pitch, yaw] = solution.gyroscope_bias_radps.map(known);
    Reading {
        value: BodyRates {
            roll_radps: raw.value.roll_radps - roll,
            pitch_radps: raw.value.pitch_radps - pitch,
            yaw_radps: raw.value.yaw_radps - yaw,
        },
        ..*raw
    }
}

pub(super) fn force_of(
    raw: &Reading<SpecificForce>,
    solution: &Solution,
) -> Reading<SpecificForce> {
    let [x, y, z] = solution.accelerometer_bias_mps2.map(known);
    Reading {
        value: SpecificForce {
            x_mps2: raw.value.x_mps2 - x,
            y_mps2: raw.value.y_mps2 - y,
            z_mps2: raw.value.z_mps2 - z,
        },
        ..*raw
    }
}

/// Whether a standard deviation is small enough; a method that states none is
/// believed.
pub(super) fn is_certain(sigma: f64, usable: f64) -> bool {
    sigma.is_nan() || sigma <= usable
}

/// A bias that the method does not know is none.
pub(super) fn known(bias: f64) -> f64 {
    if bias.is_finite() { bias } else { 0.0 }
}

/// Whether the plant is another, or was put somewhere else.
pub(super) fn is_elsewhere(measured: &Measurements) -> bool {
    let state = measured.plant.value.state;
    !measured.plant.is_never() && matches!(state, PlantState::Jumped | PlantState::Reloaded)
}

/// Whether a reading is later than the last one, not of the future, and possible;
/// then it becomes the last one.
pub(super) fn is_new<T: Schema>(last: &mut Reading<T>, reading: &Reading<T>, now: Time) -> bool {
    let is_later = !reading.is_never() && reading.taken > last.taken && reading.taken <= now;
    let is_new = is_later && in_range(&reading.value);
    if is_new {
        *last = *reading;
    }
    is_new
}

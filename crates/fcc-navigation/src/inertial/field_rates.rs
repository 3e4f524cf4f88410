//! Rates without gyroscopes: by how the magnetic field turns in body axes, and about
//! its direction by a coordinated turn.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::Solution;
use super::kalman::GAP_S;
use crate::force_sample::LEAST_AIRSPEED_MPS;
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// No turn is steeper (60° of bank).
const STEEPEST: f64 = 1.73;

/// The last sample of the field.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FieldRates(Option<(Time, Vector3<f64>)>);

impl FieldRates {
    /// Takes a sample of the field, µT, body axes; the rates since the one before,
    /// rad/s. Across the field ω = (dm/dt × m) / m²; along it those of a turn with the
    /// bank of the estimate, ψ' = g tan φ / V.
    pub(super) fn step(
        &mut self,
        taken: Time,
        field: [f64; 3],
        known: &Solution,
    ) -> Option<[f64; 3]> {
        let own = Vector3::from(known.body_field_ut);
        let field = Vector3::from(field) - own;
        let (then, before) = self.0.replace((taken, field))?;
        let dt_s = taken.since(then).as_secs_f64();
        let middle = 0.5 * (field + before);
        let squared = middle.norm_squared();
        if dt_s > GAP_S || dt_s <= 0.0 || squared <= 0.0 {
            return None;
        }
        let across = ((field - before) / dt_s).cross(&middle) / squared;
        let along = middle * (middle.dot(&turn_rates(known)) / squared);
        let rates = across + along;
        rates
            .iter()
            .all(|rate| rate.is_finite())
            .then(|| rates.into())
    }
}

/// The rates of a coordinated turn with the estimated bank and airspeed, rad/s.
fn turn_rates(known: &Solution) -> Vector3<f64> {
    let [w, x, y, z] = known.quaternion;
    let to_earth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let down = to_earth.inverse() * Vector3::z();
    let ([north, east, _], [wind_north, wind_east]) = (known.velocity_mps, known.wind_mps);
    let airspeed = libm::hypot(north - wind_north, east - wind_east).max(LEAST_AIRSPEED_MPS);
    // In inverted flight there is no coordinated turn.
    let slope = if down.z > 0.0 { down.y / down.z } else { 0.0 };
    down * (GRAVITY_MPS2 * slope.clamp(-STEEPEST, STEEPEST) / airspeed)
}

//! The speed of the engine, which turns a fixed-pitch propeller without gears.
//!
//! The propeller's inertia is left out: the engine's torque is at each moment what the
//! propeller takes, `2πM = C_P·ρn²d⁵`, with `C_P = C_P0 - k·J²` and `J = V/nd`
//! (Phillips, *Mechanics of Flight*, 2010, ch. 2, for the
//! coefficients), which gives `n` without iteration.

use core::f64::consts::TAU;

use libm::sqrt;

use crate::aerodynamics::torque_ratio;
use crate::airframe::Propulsion;
use crate::atmosphere::Air;

/// The slowest that an engine runs, its throttle closed: 650 rpm, rad/s.
pub const IDLE_RADPS: f64 = 650.0 * TAU / 60.0;

/// The speed of an engine that runs, rad/s, at a share of the torque that it has at this
/// density and a true airspeed in m/s.
pub fn running_radps(propulsion: &Propulsion, throttle: f64, airspeed_mps: f64, air: &Air) -> f64 {
    let torque_nm = throttle * propulsion.rated_torque_nm * torque_ratio(propulsion, air);
    balanced_radps(propulsion, torque_nm, airspeed_mps, air).max(IDLE_RADPS)
}

/// The speed at which the air turns an engine that has stopped, rad/s. Its friction is that
/// of Gagg and Farrar's relation; below the airspeed that overcomes it the propeller stands.
pub fn stopped_radps(propulsion: &Propulsion, airspeed_mps: f64, air: &Air) -> f64 {
    let share = propulsion.friction_share;
    let friction_nm = propulsion.rated_torque_nm * share / (1.0 - share);
    balanced_radps(propulsion, -friction_nm, airspeed_mps, air)
}

/// The speed at which the propeller takes this torque; 0 if there is none.
fn balanced_radps(propulsion: &Propulsion, torque_nm: f64, airspeed_mps: f64, air: &Air) -> f64 {
    let diameter_m = propulsion.diameter_m;
    let square_m2 = diameter_m * diameter_m;
    let of_torque = TAU * torque_nm / (air.density_kgpm3 * square_m2 * square_m2 * diameter_m);
    let of_airspeed = propulsion.power_fall * airspeed_mps * airspeed_mps / square_m2;
    TAU * sqrt(((of_torque + of_airspeed) / propulsion.power_at_rest).max(0.0))
}

//! The readings of an aircraft.

use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

/// The times of all twelve readings; an adapter with fewer lists its own in
/// [`SensorBench::taken`](crate::SensorBench::taken).
pub fn flight_times(measured: &Measurements) -> Vec<Time> {
    vec![
        measured.attitude.taken,
        measured.heading_rad.taken,
        measured.body_rates.taken,
        measured.specific_force.taken,
        measured.airspeed_mps.taken,
        measured.altitude_m.taken,
        measured.angle_of_attack_rad.taken,
        measured.position.taken,
        measured.velocity.taken,
        measured.surfaces.taken,
        measured.engage_switch.taken,
        measured.plant.taken,
    ]
}

//! An airspeed that is held by the pitch alone, without power.

use super::{AltitudeLoop, Envelope, PitchCommand, Schedule};
use fcc_navigation::Estimate;

impl AltitudeLoop {
    /// One step towards an indicated airspeed (m/s), within its limits.
    pub fn hold_airspeed(
        &mut self,
        airspeed_mps: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        // By the energy of the last tick: it changes slowly.
        let pitch_rad = self.speed.pitch_for(airspeed_mps, estimate);
        self.hold_pitch(pitch_rad, estimate, envelope, schedule, dt_s)
    }
}

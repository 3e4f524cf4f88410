//! What the monitors of the air data are given.

use super::Navigation;
use super::airspeed_monitor::MonitorInput;
use super::force_sample::{ForceSample, in_g};
use super::motion::KnownMotion;
use super::path::Path;
use super::sample_tracker::is_current;
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

impl Navigation {
    /// One tick's measurements, on a path, as the airspeed's monitor takes them.
    pub(super) fn monitor_input(
        &self,
        now: Time,
        measurements: &Measurements,
        path: &Path<'_>,
    ) -> MonitorInput {
        let force = measurements.specific_force.value;
        let (forward, up) = in_g(force.x_mps2, force.z_mps2);
        let airspeed = measurements.airspeed_mps;
        MonitorInput {
            sample: ForceSample {
                forward,
                up,
                pitch_rad: path.orientation.pitch_rad,
                roll_rad: path.orientation.roll_rad,
                upward: path.upward,
                climb_rate_mps: path.vertical.climb_rate_mps,
                climbs_by_lift: self.altitude_monitor.is_doubted()
                    && !is_current(&measurements.velocity, now),
                sqrt_density: path.sqrt_density,
                ..ForceSample::NONE
            },
            throttle: self.throttle,
            altitude_m: path.vertical.altitude_m,
            sensor_mps: is_current(&airspeed, now).then_some((airspeed.value, airspeed.source)),
            over_ground: None,
            altimeter_is_doubted: self.altitude_monitor.is_doubted(),
            motion_is_known: self.known_motion == KnownMotion::InFlight && !self.is_flaring,
            may_doubt: self.is_engaged && !self.is_flaring,
        }
    }
}

//! Altitude and climb rate, with the altimeter or without it.

use libm::tan;

use super::Navigation;
use super::altitude_input::AltitudeInput;
use super::altitude_monitor::{self, Verdict};
use super::attitude::Orientation;
use super::motion::KnownMotion;
use super::path::Path;
use super::sample_tracker::is_current;
use super::upward::Upward;
use super::vertical::VerticalState;
use fcc_core::blocks::limit_abs;
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

impl Navigation {
    /// √(density over its value at sea level) at an altitude, or, while neither altimeter
    /// nor receiver measures one, where it was measured last.
    pub(super) fn sqrt_density(
        &mut self,
        now: Time,
        measurements: &Measurements,
        altitude_m: f64,
    ) -> f64 {
        let is_measured =
            is_current(&measurements.altitude_m, now) || is_current(&measurements.velocity, now);
        if is_measured {
            self.density.sqrt_ratio(altitude_m)
        } else {
            self.density.last_sqrt_ratio()
        }
    }

    /// Altitude and climb rate, without the altimeter while it is doubted or silent.
    pub(super) fn step_vertical(
        &mut self,
        now: Time,
        measurements: &Measurements,
        (attitude, upward): (&Orientation, Upward),
        dt_s: f64,
    ) -> VerticalState {
        let (before, _) = self.vertical.state();
        let before = Path {
            orientation: attitude,
            upward,
            vertical: before,
            sqrt_density: self.sqrt_density(now, measurements, before.altitude_m),
        };
        let sample = self.monitor_input(now, measurements, &before).sample;
        let path = self.monitor.path(&sample);
        let path_mps = path.map(|(climb_rate_mps, _)| climb_rate_mps);
        let ground_mps = is_current(&measurements.velocity, now)
            .then_some(-measurements.velocity.value.down_mps);
        let altitude = measurements.altitude_m;
        let is_doubted = self.altitude_monitor.is_doubted();
        if is_doubted || !is_current(&altitude, now) {
            let by_path_mps = path_mps.filter(|_| is_doubted);
            let level = (!is_doubted).then_some(altitude_monitor::LEVEL);
            let reference = altitude_monitor::reference(ground_mps, by_path_mps);
            let reference = reference.or(level);
            self.vertical
                .step_without_altimeter(now, measurements, attitude, reference, dt_s);
        } else {
            self.vertical.step(now, measurements, attitude, dt_s);
        }
        let (followed, bias_mps2) = self.vertical.state();
        let is_felt = is_current(&measurements.specific_force, now)
            && (self.known_motion != KnownMotion::Unknown || self.altitude_monitor.is_doubted());
        let input = AltitudeInput {
            altitude_m: (is_felt && is_current(&altitude, now)).then_some(altitude.value),
            step_m: self.vertical.resolution().step(),
            has_stepped: self.vertical.has_stepped(),
            followed,
            bias_mps2,
            felt_mps2: self.vertical.felt_mps2() + bias_mps2,
            path_mps,
            ground_mps,
            range_m: measurements.height_by_range_m(now, attitude.roll_rad, attitude.pitch_rad),
            tan_bank: limit_abs(tan(attitude.roll_rad), 3.0),
            gusts_mps: self.monitor.gusts_mps(),
            may_doubt: self.is_engaged,
        };
        if dt_s > 0.0 {
            match self.altitude_monitor.step(&input, dt_s) {
                Verdict::Believed | Verdict::Doubted => {}
                Verdict::DoubtBegins(copy) => {
                    self.vertical.adopt(copy.state, copy.bias_mps2);
                    self.monitor.exclude_altimeter();
                }
                Verdict::BelievedAgain(altitude_m) => self.vertical.adopt_altitude(altitude_m),
            }
        }
        self.vertical.state().0
    }
}

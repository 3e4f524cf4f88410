//! Whether an aircraft moves although its simulator's time has stopped.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::Measurements;

/// It moves if it has changed by more than this: five times the noise of a
/// phone's sensors.
const STILL_RAD: f64 = 0.052; // 3°
const STILL_ALTITUDE_M: f64 = 8.0;

/// The attitude and altitude of the aircraft when the plant's time last advanced.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Whereabouts {
    angles_rad: [f64; 3],
    altitude_m: f64,
}

impl Whereabouts {
    /// Those of accepted measurements.
    pub(super) const fn of(accepted: &Measurements) -> Self {
        let attitude = accepted.attitude.value;
        Self {
            angles_rad: [
                attitude.roll_rad,
                attitude.pitch_rad,
                accepted.heading_rad.value,
            ],
            altitude_m: accepted.altitude_m.value,
        }
    }

    /// Whether the aircraft moves although the plant's time does not advance.
    pub(super) fn is_left(&self, measured: &Measurements) -> bool {
        let now = Self::of(measured);
        let turned = now.angles_rad.iter().zip(self.angles_rad);
        turned
            .into_iter()
            .any(|(now, before)| wrap_pi(now - before).abs() > STILL_RAD)
            || (now.altitude_m - self.altitude_m).abs() > STILL_ALTITUDE_M
    }
}

//! What has to be calibrated before something else.

use super::{CalibrationKind, Entry, Extent, SessionError};
use crate::config::{AccelerometerSection, CalibrationSection, Config, RawSource};

/// Whether what a calibration builds on was found, or is given: the mounting, the
/// gyroscope that is turned and the magnetometer are found with the accelerometer as
/// it is calibrated, the last as it is mounted, too. `force` is its source, `used`
/// what was found before.
///
/// # Errors
/// With what comes before.
pub(super) fn check_order(
    kind: CalibrationKind,
    extent: Extent,
    force: &RawSource,
    used: &[Entry],
    config: &Config,
) -> Result<(), SessionError> {
    let needed: &[_] = match (kind, extent) {
        (CalibrationKind::Magnetometer, _) => {
            &[CalibrationKind::Accelerometer, CalibrationKind::Mounting]
        }
        (CalibrationKind::Mounting, _) | (CalibrationKind::Gyroscope, Extent::Whole) => {
            &[CalibrationKind::Accelerometer]
        }
        _ => &[],
    };
    let given = force.calibration.accelerometer;
    let usual = CalibrationSection::default().accelerometer;
    let mounted = AccelerometerSection {
        mounting: given.mounting,
        rotation_deg: given.rotation_deg,
        ..usual
    };
    let calibrated = AccelerometerSection {
        mounting: usual.mounting,
        rotation_deg: usual.rotation_deg,
        delay_ms: usual.delay_ms,
        ..given
    };
    for before in needed {
        let is_given = match before {
            CalibrationKind::Mounting => mounted != usual,
            _ => calibrated != usual,
        };
        let mut used = used.iter();
        let is_found = used.any(|of| of.kind == *before && of.place == force.place);
        if !is_given && !is_found {
            let disabled = if config.calibration.enabled {
                ""
            } else {
                "; calibration.enabled is false, so nothing that was found is used"
            };
            return Err(SessionError::Order {
                kind: kind.name(),
                before: before.name(),
                place: force.place.clone(),
                disabled,
            });
        }
    }
    Ok(())
}

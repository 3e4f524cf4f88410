//! The raw sensors of the built-in aircraft, in a simulated person's hands.

use fcc_sim::{HandledSensors, HandlingFault, HandlingTask, SimConfig};

use super::{CalibrationKind, Extent};
use crate::config::{Config, RawSource};

/// The sensors of the built-in aircraft in a simulated person's hands, who does
/// what this calibration needs; none of another source.
pub(super) fn in_hands(
    config: &Config,
    source: &RawSource,
    calibration: (CalibrationKind, Extent),
    fault: Option<HandlingFault>,
) -> Option<HandledSensors> {
    let section = config.built_in.as_ref()?;
    if !source.is_built_in() {
        return None;
    }
    let task = match calibration {
        (CalibrationKind::Accelerometer, _) => HandlingTask::Places,
        (CalibrationKind::Gyroscope, Extent::Whole) => HandlingTask::TurnOver,
        (CalibrationKind::Gyroscope | CalibrationKind::Airspeed, _) => HandlingTask::LeaveAlone,
        (CalibrationKind::Magnetometer, _) => HandlingTask::Tumble,
        (CalibrationKind::Mounting, _) => HandlingTask::LevelAndNoseUp,
    };
    HandledSensors::new(&SimConfig::from(section), task, fault)
}

//! What the person is to do, in words.

use fcc_calibration::Next;

use super::{CalibrationKind, Extent};

/// What to do before it begins.
pub const fn beforehand(kind: CalibrationKind, extent: Extent) -> &'static str {
    match kind {
        CalibrationKind::Accelerometer => {
            "Hold the sensor still with each of its six faces up, and with six of its edges, 3 s \
             each. Lean it against something firm: no hand is still enough."
        }
        CalibrationKind::Gyroscope => match extent {
            Extent::Whole => {
                "Put it on something firm and take your hands off for 11 s. Then turn it over, about \
                 each of its axes, by half and quarter turns, and put it down for 3 s after each. \
                 Calibrate the accelerometer before."
            }
            Extent::Part => "Put it on something firm and take your hands off for 11 s.",
        },
        CalibrationKind::Magnetometer => {
            "With everything switched on that is on in flight, go away from steel and magnets and \
             turn it slowly through all directions. Calibrate accelerometer and mounting before."
        }
        CalibrationKind::Airspeed => {
            "Shield the tube from wind, without touching it, and leave the aircraft alone for 11 s."
        }
        CalibrationKind::Mounting => {
            "Put the aircraft level as in cruise, then raise its nose. Calibrate the accelerometer \
             before."
        }
    }
}

/// What to do next.
pub fn words(next: Next) -> String {
    match next {
        Next::Wait => "wait for the first readings".to_owned(),
        Next::LeaveAlone => "leave it alone".to_owned(),
        Next::Place(place) => format!("put it with {place} up, and let go"),
        Next::Hold(place) => format!("{place} is up: keep it still"),
        Next::Turn(place) => format!("turn it slowly; missing: {place} along the field"),
        Next::TurnOver { axis, half } => {
            let turn = if half { "half" } else { "a quarter of" };
            let axis = ["x", "y", "z"].get(usize::from(axis)).unwrap_or(&"");
            format!("turn it by {turn} a turn about its {axis} axis, and let go")
        }
        Next::CoverTube => "shield the tube from wind, and leave it alone".to_owned(),
        Next::Level => "put the aircraft level, and leave it alone".to_owned(),
        Next::RaiseNose => "raise its nose by 20° or more, and hold it there".to_owned(),
        Next::Done => "done".to_owned(),
    }
}

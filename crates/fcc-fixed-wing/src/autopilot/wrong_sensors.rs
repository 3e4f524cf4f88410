//! That one of several sensors is wrong: which, and why.

use core::fmt;

use fcc_core::framework::{Notice, PERMILLE};
use fcc_navigation::inertial::{FoundBy, SensorKind, WrongSensor};

/// The numbers of notices: from the first one on, one for each kind and reason.
const FIRST: u8 = 9;
const KINDS: [(SensorKind, &str); 4] = [
    (SensorKind::InertialUnit, "inertial unit"),
    (SensorKind::Magnetometer, "magnetometer"),
    (SensorKind::Barometer, "barometer"),
    (SensorKind::Receiver, "satellite receiver"),
];
const REASONS: [(FoundBy, &str); 5] = [
    (FoundBy::Majority, "most others of its kind differ from it"),
    (
        FoundBy::OtherKinds,
        "another of its kind differs from it, and agrees better with the other sensors",
    ),
    (
        FoundBy::MagneticField,
        "the magnetic field contradicts its gyroscope",
    ),
    (FoundBy::Repeats, "it repeats itself in motion"),
    (FoundBy::Silence, "it is silent"),
];

/// The notice of a sensor that is not used any more.
pub(super) fn notice(wrong: WrongSensor) -> Notice {
    let place = |at: Option<usize>| at.and_then(|at| u8::try_from(at).ok()).unwrap_or_default();
    let kind = place(KINDS.iter().position(|(kind, _)| *kind == wrong.kind));
    let reason = place(REASONS.iter().position(|(by, _)| *by == wrong.by));
    Notice {
        kind: FIRST + kind * REASONS.len() as u8 + reason,
        amount_permille: (u16::from(wrong.sensor) + 1).saturating_mul(PERMILLE),
        ..Notice::default()
    }
}

/// Writes the notice; `None` if it is another one.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> Option<fmt::Result> {
    let number = usize::from(notice.kind.checked_sub(FIRST)?);
    let (_, name) = KINDS.get(number / REASONS.len())?;
    let (_, reason) = REASONS.get(number % REASONS.len())?;
    let sensor = notice.amount_permille / PERMILLE;
    Some(write!(
        f,
        "{name} of sensor {sensor} is not used again: {reason}"
    ))
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;
    use crate::Autopilot;
    use fcc_core::framework::Controller;

    struct Text(Notice);

    impl fmt::Display for Text {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            Autopilot::write_notice(&self.0, f)
        }
    }

    #[test]
    fn the_notice_names_sensor_and_reason() {
        let text = |kind, sensor, by| Text(notice(WrongSensor { kind, sensor, by })).to_string();
        assert_eq!(
            text(SensorKind::InertialUnit, 0, FoundBy::Majority),
            "inertial unit of sensor 1 is not used again: most others of its kind differ from it"
        );
        assert_eq!(
            text(SensorKind::Receiver, 11, FoundBy::Silence),
            "satellite receiver of sensor 12 is not used again: it is silent"
        );
    }
}

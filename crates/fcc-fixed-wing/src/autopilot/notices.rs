//! The texts of what happened once.

use core::fmt;

use super::{
    airspeed_doubt, contingency, degraded, journal, pilot_takeover, plant_clock, receiver, refusal,
    routing, runway, wrong_sensors,
};
use fcc_core::framework::Notice;

/// Writes the text of a notice.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let lasted_s = notice.lasted_s();
    match notice.kind {
        plant_clock::STOOD_STILL => write!(f, "the simulator stood still for {lasted_s:.1} s"),
        plant_clock::LINK_LOST => write!(
            f,
            "link lost for {lasted_s:.1} s: the simulator ran on meanwhile"
        ),
        plant_clock::CLOCK_MISSING => f.write_str(
            "the simulator's clock is missing while its other values arrive: our time is used",
        ),
        degraded::GOOD_AGAIN => write!(
            f,
            "failsafe cleared after {lasted_s:.1} s: back to what was flown before"
        ),
        degraded::FLOWN_OTHERWISE => receiver::write(notice, f).unwrap_or_else(|| {
            f.write_str("no control law is left: gliding in a gentle turn, with idle throttle")
        }),
        routing::ITEM_REACHED if notice.item == 0 => {
            f.write_str("the plan is flown to its end: circling")
        }
        routing::ITEM_REACHED => {
            write!(f, "item {} of the plan is reached", notice.item)?;
            match notice.amount_permille {
                0 => Ok(()),
                off_m => write!(f, ", {off_m} m off its altitude"),
            }
        }
        contingency::CONTINGENCY => contingency::write(notice, f),
        refusal::COMMAND_ANSWER => refusal::write(notice, f),
        runway::RUNWAY => runway::write(notice, f),
        journal::LEFT_OUT => journal::write(notice, f),
        kind => match pilot_takeover::axis_of(kind) {
            Some(axis) => {
                let deflection = f64::from(notice.amount_permille) / 1_000.0;
                write!(
                    f,
                    "the pilot takes over: the {axis} control is {deflection:.2} of full \
                     deflection from where it rested"
                )
            }
            None => {
                wrong_sensors::write(notice, f).unwrap_or_else(|| airspeed_doubt::write(kind, f))
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;
    use crate::Autopilot;
    use fcc_core::framework::EventKind;

    fn text(kind: u8) -> std::string::String {
        let notice = Notice {
            kind,
            ..Notice::default()
        };
        EventKind::Noticed(notice)
            .description::<Autopilot>()
            .to_string()
    }

    /// Each number is that of one notice: those of airspeed sensors begin at 32.
    #[test]
    fn each_number_is_one_notice() {
        let single = [
            refusal::COMMAND_ANSWER,
            plant_clock::STOOD_STILL,
            plant_clock::LINK_LOST,
            degraded::GOOD_AGAIN,
            degraded::FLOWN_OTHERWISE,
            plant_clock::CLOCK_MISSING,
            runway::RUNWAY,
            routing::ITEM_REACHED,
            contingency::CONTINGENCY,
        ];
        assert!(single.is_sorted_by(|a, b| a < b), "{single:?}");
        for kind in single {
            assert_eq!(pilot_takeover::axis_of(kind), None, "{kind}");
            assert!(!text(kind).contains("is not used again"), "{kind}");
        }
        // From 160 on no reason is assigned.
        for kind in 32..160 {
            assert!(text(kind).contains("is excluded"), "{kind}: {}", text(kind));
        }
    }
}

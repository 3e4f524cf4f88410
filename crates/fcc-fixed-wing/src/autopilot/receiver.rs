//! What is said of a satellite receiver that is flown by otherwise than it says.

use core::fmt;

use super::degraded::flown_otherwise;
use super::degraded::otherwise::{LATE_FIXES, VELOCITY_REFUSED, VELOCITY_USED};
use fcc_core::framework::Notice;

const PERMILLE: f64 = 1_000.0;

/// The notice that fixes are later by this, s, than they say.
pub(super) fn late_fixes(late_s: f64) -> Notice {
    Notice {
        amount_permille: (late_s * PERMILLE) as u16,
        ..flown_otherwise(LATE_FIXES)
    }
}

/// The notice that the receiver's velocity is refused, or used again.
pub(super) fn velocity(is_refused: bool) -> Notice {
    flown_otherwise(if is_refused {
        VELOCITY_REFUSED
    } else {
        VELOCITY_USED
    })
}

/// Writes a notice of the receiver; `None` if it is another one.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> Option<fmt::Result> {
    let late_s = f64::from(notice.amount_permille) / PERMILLE;
    let text = match (notice.item, notice.amount_permille) {
        (LATE_FIXES, 0) => "the satellite receiver's fixes come in time again",
        (LATE_FIXES, _) => {
            return Some(write!(
                f,
                "the satellite receiver's fixes come {late_s:.1} s later than they say: they \
                 are used at the time that they are of"
            ));
        }
        (VELOCITY_REFUSED, _) => {
            "the satellite receiver's velocity contradicts its own positions, or airspeed and \
             compass, or is only repeated: it is not used"
        }
        (VELOCITY_USED, _) => "the satellite receiver's velocity is used again",
        _ => return None,
    };
    Some(f.write_str(text))
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::super::Autopilot;
    use super::*;
    use fcc_core::framework::EventKind;

    fn text(notice: Notice) -> std::string::String {
        EventKind::Noticed(notice)
            .description::<Autopilot>()
            .to_string()
    }

    #[test]
    fn each_says_what_is_flown() {
        assert!(text(late_fixes(1.04)).contains("come 1.0 s later than they say"));
        assert!(text(late_fixes(0.0)).contains("come in time again"));
        assert!(text(velocity(true)).contains("contradicts its own positions"));
        assert!(text(velocity(false)).contains("is used again"));
    }
}

//! What is said of a satellite receiver that is flown by otherwise than it says.

use core::fmt;

use super::degraded::flown_otherwise;
use super::degraded::otherwise::{LATE_FIXES, VELOCITY_REFUSED, VELOCITY_USED};
use fcc_core::framework::Notice;

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
    let text = match notice.item {
        VELOCITY_REFUSED => {
            "the satellite receiver's velocity contradicts its own positions, or airspeed and \
             compass, or is only repeated: it is not used"
        }
        VELOCITY_USED => "the satellite receiver's velocity is used again",
        LATE_FIXES => "not used (item 1)",
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
        assert!(text(velocity(true)).contains("contradicts its own positions"));
        assert!(text(velocity(false)).contains("is used again"));
    }
}

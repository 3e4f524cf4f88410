//! The texts of what happened once.

use core::fmt;

use super::{airspeed_doubt, degraded, plant_clock};
use crate::framework::Notice;

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
            "all is good again: back to what was flown {lasted_s:.1} s ago"
        ),
        degraded::GLIDES => write!(
            f,
            "nothing can be held any longer: gliding in a gentle turn, with idle throttle"
        ),
        kind => airspeed_doubt::write(kind, f),
    }
}

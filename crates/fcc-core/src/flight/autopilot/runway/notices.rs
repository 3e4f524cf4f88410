//! Notices of a take-off or a landing.

use core::fmt;

use super::RunwayControl;
use crate::flight::route::RunwayReason;
use crate::framework::Notice;

/// The number of their notices: the item is the reason's.
pub(in super::super) const RUNWAY: u8 = 29;

impl RunwayControl {
    pub(in super::super) fn announce(&mut self, reason: RunwayReason) {
        self.news = Some(Notice {
            kind: RUNWAY,
            item: reason as u16,
            ..Notice::default()
        });
    }

    pub(in super::super) const fn take_news(&mut self) -> Option<Notice> {
        self.news.take()
    }
}

/// Whether a notice says that the wheels touch the ground where neither a take-off nor a
/// landing is flown.
pub fn touches_ground(notice: &Notice) -> bool {
    notice.kind == RUNWAY && notice.item == RunwayReason::Touched as u16
}

/// Whether a notice says why a take-off or a landing is given up.
pub fn gives_up_runway(notice: &Notice) -> bool {
    let others = [
        RunwayReason::Touched,
        RunwayReason::RangeFinder,
        RunwayReason::NoClimb,
    ];
    notice.kind == RUNWAY && others.iter().all(|other| notice.item != *other as u16)
}

/// Writes the notice of a runway.
pub(in super::super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let number = u8::try_from(notice.item).unwrap_or_default();
    let reason = RunwayReason::from_number(number).unwrap_or_default();
    write!(f, "{reason}")
}

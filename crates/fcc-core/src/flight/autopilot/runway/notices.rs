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

/// Writes the notice of a runway.
pub(in super::super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let number = u8::try_from(notice.item).unwrap_or_default();
    let reason = RunwayReason::from_number(number).unwrap_or_default();
    write!(f, "{reason}")
}

//! Notices of a take-off or a landing, and commands that are not carried out in them.

use core::fmt;

use super::super::{Autopilot, AutopilotCommand};
use super::RunwayControl;
use crate::flight::route::RunwayReason;
use crate::framework::Notice;

/// The number of their notices: the item is the reason's.
pub(in super::super) const RUNWAY: u8 = 29;
/// Lower than this over a runway nothing else is begun, m.
const COMMANDED_M: f64 = 30.0;

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

impl Autopilot {
    /// Whether a command would turn the aircraft low over a runway: a landing is given up
    /// for it, and it is not carried out.
    pub(in super::super) fn is_too_low_for(&mut self, command: &AutopilotCommand) -> bool {
        let stays = matches!(
            command,
            AutopilotCommand::GoAround | AutopilotCommand::Resume(_)
        );
        let Some(demand) = self.runway().filter(|_| !stays) else {
            return false;
        };
        let on_wheels = demand.phase.is_on_wheels();
        if !on_wheels && demand.height_m >= COMMANDED_M {
            return false;
        }
        self.on_runway.announce(RunwayReason::Low);
        if !on_wheels {
            self.guidance.go_around();
        }
        true
    }
}

//! Reports a servo board's serial line on which too much arrives, of which the loop's
//! events say that something is invalid, and not why; and messages that arrive late.

use std::time::{Duration, Instant};

use fcc_core::framework::Controller;
use fcc_servo_link::{LineStatus, LinkStatus};
use fcc_xplane::OldDatagrams;

use super::observer::{Access, Observer};

/// A flood is over when nothing was dropped for this long.
const OVER_AFTER: Duration = Duration::from_secs(5);

const FLOOD: &str = "servo board: more than 1,000,000 bytes arrive in a second, and no board sends \
                     that: the rest is dropped, and readings may be missing; check which device \
                     servo-board.serial is (`ls -l /dev/serial/by-id`), and its firmware";
const OVER: &str = "servo board: no longer more arrives than is read";

/// How often too much arrived.
#[derive(Default)]
struct Floods {
    count: u64,
    /// When one was last seen; none once it is over.
    seen: Option<Instant>,
}

impl Floods {
    /// What is to be reported at this time, after so many floods.
    fn follow(&mut self, floods: u64, now: Instant) -> Option<&'static str> {
        if floods != self.count {
            self.count = floods;
            return self.seen.replace(now).is_none().then_some(FLOOD);
        }
        let is_over = |at: &mut Instant| now.duration_since(*at) >= OVER_AFTER;
        self.seen.take_if(is_over).map(|_| OVER)
    }
}

/// Watches the link.
pub(super) struct LineWatch {
    link: LinkStatus,
    floods: Floods,
    old: OldDatagrams,
}

impl LineWatch {
    pub(super) fn new(link: LinkStatus) -> Self {
        Self {
            link,
            floods: Floods::default(),
            old: OldDatagrams::default(),
        }
    }
}

impl<C: Controller> Observer<C> for LineWatch {
    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        let now = Instant::now();
        let floods = self.link.line.as_ref().map_or(0, LineStatus::floods);
        if let Some(words) = self.floods.follow(floods, now) {
            access.reports.remark(words.to_owned());
        }
        let late = self.link.messages.counts().late;
        if let Some(rate) = self.old.step(now, late) {
            access.reports.remark(format!(
                "servo board: {rate:.0} messages a second are older than others that arrived \
                 before, and are not used: the network delivers them late or twice"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_is_said_at_its_beginning_and_at_its_end() {
        let mut watch = Floods::default();
        let began = Instant::now();
        let mut at = |floods, s| watch.follow(floods, began + Duration::from_secs(s));
        assert_eq!(at(0, 0), None);
        assert_eq!(at(1, 1), Some(FLOOD));
        assert_eq!(at(11, 2), None);
        assert_eq!(at(11, 6), None);
        assert_eq!(at(11, 7), Some(OVER));
        assert_eq!(at(11, 20), None);
        assert_eq!(at(12, 21), Some(FLOOD));
    }
}

//! Reports a servo board's serial line on which too much arrives: the loop's events say
//! that something is invalid, and not why.

use std::time::{Duration, Instant};

use fcc_core::framework::Controller;
use fcc_servo_link::LineStatus;

use super::observer::{Access, Observer};

/// A flood is over when nothing was dropped for this long.
const OVER_AFTER: Duration = Duration::from_secs(5);

const FLOOD: &str = "servo board: more than 1,000,000 bytes arrive in a second, and no board sends \
                     that: the rest is dropped, and readings may be missing; check which device \
                     servo-board.serial is (`ls -l /dev/serial/by-id`), and its firmware";
const OVER: &str = "servo board: no longer more arrives than is read";

/// Watches the line.
pub(super) struct LineWatch {
    line: LineStatus,
    floods: u64,
    /// When one was last seen; none once it is over.
    flooded: Option<Instant>,
}

impl LineWatch {
    pub(super) const fn new(line: LineStatus) -> Self {
        Self {
            line,
            floods: 0,
            flooded: None,
        }
    }

    /// What is to be reported at this time, after so many floods.
    fn follow(&mut self, floods: u64, now: Instant) -> Option<&'static str> {
        if floods != self.floods {
            self.floods = floods;
            return self.flooded.replace(now).is_none().then_some(FLOOD);
        }
        let is_over = |at: &mut Instant| now.duration_since(*at) >= OVER_AFTER;
        self.flooded.take_if(is_over).map(|_| OVER)
    }
}

impl<C: Controller> Observer<C> for LineWatch {
    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        if let Some(words) = self.follow(self.line.floods(), Instant::now()) {
            access.reports.remark(words.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_is_said_at_its_beginning_and_at_its_end() {
        let mut watch = LineWatch::new(LineStatus::default());
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

//! The engage switch of a servo board that sends no time.
//!
//! Without one, a frame that arrives again seconds later cannot be told from a new
//! one, so no single frame moves the switch.

use core::time::Duration;

use fcc_core::framework::{Switch, Time};

/// On counts once all frames of so long have it.
const ON_LASTS: Duration = Duration::from_millis(300);
/// Off, which is the safe one, counts with the second frame in a row.
const OFF_FRAMES: u32 = 2;

/// Frames in a row with one position.
#[derive(Clone, Copy, Debug)]
struct Run {
    position: Switch,
    since: Time,
    frames: u32,
}

/// Follows the position in each frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct UntimedSwitch {
    run: Option<Run>,
    believed: Option<Switch>,
}

impl UntimedSwitch {
    /// Takes the position in a frame.
    pub(crate) fn take(&mut self, position: Switch, now: Time) {
        let same = self.run.filter(|run| run.position == position);
        let run = same.unwrap_or(Run {
            position,
            since: now,
            frames: 0,
        });
        self.run = Some(Run {
            frames: run.frames.saturating_add(1),
            ..run
        });
    }

    /// The position, unless it is one that may be that of an old frame.
    pub(crate) fn position(&mut self, now: Time) -> Option<Switch> {
        let Run {
            position,
            since,
            frames,
        } = self.run?;
        let counts = match position {
            Switch::On => now.since(since) >= ON_LASTS,
            Switch::Off => frames >= OFF_FRAMES,
        };
        if counts {
            self.believed = Some(position);
        }
        Some(position).filter(|position| self.believed == Some(*position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: i64) -> Time {
        Time::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn no_single_frame_moves_it_and_what_lasts_does() {
        use Switch::{Off, On};
        let mut switch = UntimedSwitch::default();
        let mut read = |ms, position| {
            switch.take(position, at(ms));
            switch.position(at(ms))
        };
        assert_eq!(read(0, Off), None);
        assert_eq!(read(20, Off), Some(Off));
        // 0.3 s of on, of which an off in between is the end.
        for ms in (40..320).step_by(20) {
            assert_eq!(read(ms, On), None, "{ms}");
        }
        assert_eq!(read(320, Off), Some(Off));
        for ms in (340..640).step_by(20) {
            assert_eq!(read(ms, On), None, "{ms}");
        }
        assert_eq!(read(640, On), Some(On));
        assert_eq!(read(660, Off), None);
        assert_eq!(read(680, On), Some(On), "a single off moved nothing");
        assert_eq!(read(700, Off), None);
        assert_eq!(read(720, Off), Some(Off));
    }
}

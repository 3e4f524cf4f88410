//! How fast the simulator's time runs.

use core::time::Duration;

use fcc_core::framework::Time;

use super::ClockSample;

/// The simulator's pace is measured over at least this long, at most twice this
/// long: 25 ms of jitter at its end are then at most 2.5 %.
const PACE_OVER: Duration = Duration::from_secs(1);
/// Slow below this share of our time, until it is above [`PACE_REGAINED`].
const PACE_LOST: f64 = 0.9;
const PACE_REGAINED: f64 = 0.95;
/// Fast above this share of our time, until it is below [`PACE_SLOWED`]: twice
/// our time, which is flown, plus the jitter of the measurement.
const PACE_FAST: f64 = 2.2;
const PACE_SLOWED: f64 = 2.1;
/// Above this frame period (20 frames a second, where X-Plane begins to slow its
/// time) it is slow already below [`PACE_REGAINED`], and until the period is
/// below [`FRAME_REGAINED_S`] (22 a second). The period alone says nothing: it
/// is smoothed, and long for seconds after a single freeze.
const FRAME_LOST_S: f64 = 1.0 / 20.0;
const FRAME_REGAINED_S: f64 = 1.0 / 22.0;

/// A frame in which the clock fell behind ours by more than this was a freeze.
/// The pace is measured anew after it, unless the last freeze was less than
/// [`FREEZE_ALONE`] ago: then the simulator is slow.
const FREEZE_S: f64 = 0.05;
const FREEZE_ALONE: Duration = Duration::from_secs(2);

/// How fast the simulator's time runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Pace {
    Slow,
    Even,
    Fast,
}

/// Measures the pace.
#[derive(Clone, Copy, Debug)]
pub(super) struct PaceMeter {
    /// The time a frame takes, s of our time; 0 while it is not known.
    pub(super) frame_period_s: f64,
    /// When the last freeze ended.
    froze: Time,
    /// The samples from which the pace is measured: the older one, until the
    /// younger is [`PACE_OVER`] old.
    marks: [ClockSample; 2],
    pace: Pace,
}

impl Default for PaceMeter {
    fn default() -> Self {
        Self {
            frame_period_s: 0.0,
            froze: Time::NEVER,
            marks: [ClockSample::default(); 2],
            pace: Pace::Even,
        }
    }
}

impl PaceMeter {
    pub(super) const fn pace(&self) -> Pace {
        self.pace
    }

    /// Restarts the measurement.
    pub(super) const fn restart(&mut self, latest: ClockSample) {
        self.marks = [latest; 2];
        self.pace = Pace::Even;
    }

    /// Follows a frame at whose end the simulator's time had fallen behind ours
    /// by `behind_s`.
    pub(super) fn follow(&mut self, latest: ClockSample, behind_s: f64) {
        if behind_s <= FREEZE_S {
            return;
        }
        if latest.seen.since(self.froze) >= FREEZE_ALONE {
            self.marks = [latest; 2];
        }
        self.froze = latest.seen;
    }

    /// Updates the pace.
    pub(super) fn update(&mut self, now: Time, latest: ClockSample) {
        let [older, younger] = self.marks;
        if now.since(younger.seen) >= PACE_OVER {
            self.marks = [younger, latest];
        }
        let measured = latest.seen.since(older.seen) >= PACE_OVER;
        let pace = if measured {
            latest.pace_since(older)
        } else {
            1.0
        };
        let in_slow_frames = self.frame_period_s > FRAME_LOST_S && pace < PACE_REGAINED;
        if pace < PACE_LOST || in_slow_frames {
            self.pace = Pace::Slow;
        } else if pace > PACE_FAST {
            self.pace = Pace::Fast;
        } else if measured {
            self.pace = match self.pace {
                Pace::Slow if pace <= PACE_REGAINED || self.frame_period_s >= FRAME_REGAINED_S => {
                    Pace::Slow
                }
                Pace::Fast if pace >= PACE_SLOWED => Pace::Fast,
                _ => Pace::Even,
            };
        }
    }
}

//! The simulator's state, from its clock compared with ours.
//!
//! X-Plane slows its time below about 20 frames a second, stops it when paused
//! or behind a dialog, and sets it back when a flight is loaded. Each is a
//! separate state here. Nothing in this file reads a clock: the time of the
//! tick and the contents of the datagrams are passed in.

use core::time::Duration;

use fcc_core::flight::PlantState;
use fcc_core::framework::Time;

/// Two datagrams of one flight are mostly less than this apart when one overtakes
/// the other; time that goes back further and continues there was set back.
const LATE_S: f64 = 1.0;
/// For this long, from the first one on, older times may belong to late datagrams,
/// also after a silence: those may arrive first that were sent before it. A newer
/// one follows within the network's jitter; without one, another flight runs.
const LATE: Duration = Duration::from_millis(400);
/// If the simulator's clock gains this much on twice ours between two ticks, it
/// was set forward: it may run twice as fast.
const AHEAD_S: f64 = 1.0;
const AHEAD_OF: f64 = 2.0;
/// What a network held back may arrive in several ticks: for this long after a
/// gap of this length the clock is compared with that before the gap, too.
const HELD_BACK: Duration = Duration::from_millis(500);
/// Stalled if its clock has not advanced for this long: five frames at 20 a second.
const STALLED_AFTER: Duration = Duration::from_millis(250);
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

/// The simulator's state.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(u8)]
pub enum SimulatorState {
    /// Nothing has arrived for the configured time.
    #[default]
    Silent = 0,
    /// Its time runs at the rate of ours.
    Running = 1,
    /// Paused by its user.
    Paused = 2,
    /// It sends and is not paused, but its clock has not advanced for 250 ms: a
    /// dialog, or loading.
    Stalled = 3,
    /// Its time runs at less than 90 % of ours over 1 to 2 s, or at less than
    /// 95 % in frames of more than 50 ms; until 95 % and 45 ms are regained.
    /// A single freeze is not counted.
    Slow = 4,
    /// Its clock went back by a second or more and continued there, or gained a
    /// second on ours: a flight was loaded. This lasts for one tick only.
    Jumped = 5,
    /// Its time runs more than 2.2 times as fast as ours over 1 to 2 s, until it
    /// is less than 2.1 times as fast.
    Fast = 6,
    /// It shows a recorded flight.
    Replaying = 7,
    /// In this tick it cleared the overrides by itself: an aircraft was loaded.
    /// This lasts for one tick only.
    Reloaded = 8,
}

impl SimulatorState {
    /// The corresponding state of the framework; `None` for silence, which the
    /// framework detects by the age of the readings.
    pub const fn plant_state(self) -> Option<PlantState> {
        match self {
            Self::Silent => None,
            Self::Running => Some(PlantState::Running),
            Self::Paused => Some(PlantState::Paused),
            Self::Stalled => Some(PlantState::Stalled),
            Self::Slow => Some(PlantState::Slow),
            Self::Jumped => Some(PlantState::Jumped),
            Self::Fast => Some(PlantState::Fast),
            Self::Replaying => Some(PlantState::Replaying),
            Self::Reloaded => Some(PlantState::Reloaded),
        }
    }

    /// The state with this number.
    pub(crate) const fn from_number(number: u8) -> Self {
        match number {
            1 => Self::Running,
            2 => Self::Paused,
            3 => Self::Stalled,
            4 => Self::Slow,
            5 => Self::Jumped,
            6 => Self::Fast,
            7 => Self::Replaying,
            8 => Self::Reloaded,
            _ => Self::Silent,
        }
    }
}

/// What one datagram reports about the simulator itself; fields may be missing.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct SimulatorReport {
    /// The flight's time, s.
    pub(crate) time_s: Option<f64>,
    pub(crate) paused: Option<bool>,
    pub(crate) replaying: Option<bool>,
    /// The time a frame takes, s of our time.
    pub(crate) frame_period_s: Option<f64>,
}

/// A time of the simulator and when it was received.
#[derive(Clone, Copy, Debug, Default)]
struct ClockSample {
    time_s: f64,
    seen: Time,
}

impl ClockSample {
    /// The simulator's seconds per second of ours since an earlier sample.
    fn pace_since(self, earlier: Self) -> f64 {
        (self.time_s - earlier.time_s) / self.seen.since(earlier.seen).as_secs_f64()
    }

    /// Whether its time is further from an earlier sample's than it can have run.
    fn is_ahead_of(self, earlier: Self) -> bool {
        let ours_s = self.seen.since(earlier.seen).as_secs_f64();
        !earlier.seen.is_never() && self.time_s - earlier.time_s - AHEAD_OF * ours_s > AHEAD_S
    }
}

/// Tracks the simulator's clock.
#[derive(Clone, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "separate properties, each set or not"
)]
pub(crate) struct SimulatorClock {
    silent_after: Duration,
    received: Time,
    latest: ClockSample,
    /// The latest before this tick: in one tick many may arrive that waited.
    before: ClockSample,
    /// When the first of the older times arrived that were taken for late ones
    /// since the latest; never if there was none.
    late_since: Time,
    /// A time that is earlier by [`LATE_S`] or more, until a newer one arrives.
    set_back: Option<ClockSample>,
    /// The latest before the last gap, and when that ended.
    before_gap: ClockSample,
    gap_ended: Time,
    /// When the clock last advanced, or had a reason not to.
    advanced: Time,
    paused: bool,
    replaying: bool,
    frame_period_s: f64,
    /// When the last freeze ended.
    froze: Time,
    /// The samples from which the pace is measured: the older one, until the
    /// younger is [`PACE_OVER`] old.
    marks: [ClockSample; 2],
    pace: Pace,
    jumped: bool,
    reloaded: bool,
}

/// How fast the simulator's time runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Pace {
    Slow,
    Even,
    Fast,
}

impl SimulatorClock {
    pub(crate) fn new(silent_after: Duration) -> Self {
        Self {
            silent_after,
            received: Time::NEVER,
            latest: ClockSample::default(),
            before: ClockSample::default(),
            late_since: Time::NEVER,
            set_back: None,
            before_gap: ClockSample::default(),
            gap_ended: Time::NEVER,
            advanced: Time::NEVER,
            paused: false,
            replaying: false,
            frame_period_s: 0.0,
            froze: Time::NEVER,
            marks: [ClockSample::default(); 2],
            pace: Pace::Even,
            jumped: false,
            reloaded: false,
        }
    }

    /// Begins a tick.
    pub(crate) fn begin(&mut self) {
        self.jumped = false;
        self.reloaded = false;
        self.before = self.latest;
    }

    /// The simulator cleared the overrides.
    pub(crate) const fn reload(&mut self) {
        self.reloaded = true;
    }

    /// Whether a datagram of this flight time was overtaken by a newer one and is to
    /// be dropped; not if the time is equal: the same frame, or time stands still.
    pub(crate) fn is_late(&mut self, now: Time, time_s: f64) -> bool {
        let back_s = self.latest.time_s - time_s;
        // A replay may go backwards.
        if self.replaying || self.latest.seen.is_never() || back_s <= 0.0 {
            return false;
        }
        if back_s >= LATE_S {
            return !self.is_set_back(ClockSample { time_s, seen: now });
        }
        if self.late_since.is_never() {
            self.late_since = now;
        }
        now.since(self.late_since) < LATE
    }

    /// Whether a much earlier time continues one of an earlier tick.
    fn is_set_back(&mut self, sample: ClockSample) -> bool {
        let follows = |at: &ClockSample| sample.time_s >= at.time_s && !sample.is_ahead_of(*at);
        let first = self.set_back.filter(follows);
        self.set_back = first.or(Some(sample));
        first.is_some_and(|first| sample.seen > first.seen)
    }

    /// Evaluates the report of an accepted datagram.
    pub(crate) fn receive(&mut self, now: Time, report: SimulatorReport) {
        let was_silent = self.is_silent(now);
        let was_replaying = self.replaying;
        self.received = now;
        if let Some(replaying) = report.replaying {
            self.replaying = replaying;
        }
        if let Some(paused) = report.paused {
            if self.paused && !paused {
                self.begin_pace(now);
            }
            self.paused = paused;
        }
        if let Some(period_s) = report.frame_period_s {
            self.frame_period_s = period_s;
        }
        if let Some(time_s) = report.time_s {
            if was_replaying || self.replaying {
                // The recorded time, or the first after it.
                self.latest = ClockSample { time_s, seen: now };
                self.before = self.latest;
                self.begin_pace(now);
            } else {
                self.read_clock(now, time_s, was_silent);
            }
        }
        self.update_pace(now);
    }

    fn read_clock(&mut self, now: Time, time_s: f64, was_silent: bool) {
        let (before, had_stopped) = (self.latest, self.has_stopped());
        self.latest = ClockSample { time_s, seen: now };
        self.late_since = Time::NEVER;
        self.set_back = None;
        if before.seen.is_never() {
            self.begin_pace(now);
            return;
        }
        let gained_s = time_s - before.time_s;
        if now.since(before.seen) >= HELD_BACK {
            (self.before_gap, self.gap_ended) = (before, now);
        }
        let gains = self.latest.is_ahead_of(self.before);
        let is_ahead = gains
            && (now.since(self.gap_ended) >= HELD_BACK || self.latest.is_ahead_of(self.before_gap));
        // Late datagrams were dropped, so a time that went back was set back.
        if gained_s < 0.0 || is_ahead {
            self.jumped = true;
            self.begin_pace(now);
        } else if was_silent || gains {
            self.begin_pace(now);
        } else if gained_s > 0.0 {
            let freezes = now.since(before.seen).as_secs_f64() - gained_s > FREEZE_S;
            // Frames that are far apart are slow, and no stop.
            if had_stopped {
                self.begin_pace(now);
            } else if freezes && now.since(self.froze) >= FREEZE_ALONE {
                self.marks = [self.latest; 2];
            }
            if freezes {
                self.froze = now;
            }
            self.advanced = now;
        }
    }

    /// Restarts the measurement of the pace.
    fn begin_pace(&mut self, now: Time) {
        self.advanced = now;
        self.marks = [self.latest; 2];
        self.pace = Pace::Even;
    }

    fn update_pace(&mut self, now: Time) {
        let [older, younger] = self.marks;
        if self.paused || self.latest.seen.is_never() {
            return;
        }
        if now.since(younger.seen) >= PACE_OVER {
            self.marks = [younger, self.latest];
        }
        let measured = self.latest.seen.since(older.seen) >= PACE_OVER;
        let pace = if measured {
            self.latest.pace_since(older)
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

    /// Whether nothing has arrived for the configured time.
    pub(crate) fn is_silent(&self, now: Time) -> bool {
        now.since(self.received) > self.silent_after
    }

    /// When something last arrived.
    pub(crate) const fn last_received(&self) -> Time {
        self.received
    }

    /// The simulator's time in s, once known.
    pub(crate) fn time_s(&self) -> Option<f64> {
        (!self.latest.seen.is_never()).then_some(self.latest.time_s)
    }

    /// Whether it sends, but its time does not advance: measured up to the last
    /// report of its time, so that a gap between reports is not taken for a
    /// stopped clock.
    fn has_stopped(&self) -> bool {
        !self.latest.seen.is_never() && self.latest.seen.since(self.advanced) > STALLED_AFTER
    }

    /// The simulator's state.
    pub(crate) fn state(&self, now: Time) -> SimulatorState {
        if self.is_silent(now) {
            SimulatorState::Silent
        } else if self.jumped {
            SimulatorState::Jumped
        } else if self.reloaded {
            SimulatorState::Reloaded
        } else if self.replaying {
            SimulatorState::Replaying
        } else if self.paused {
            SimulatorState::Paused
        } else if self.has_stopped() {
            SimulatorState::Stalled
        } else {
            match self.pace {
                Pace::Slow => SimulatorState::Slow,
                Pace::Even => SimulatorState::Running,
                Pace::Fast => SimulatorState::Fast,
            }
        }
    }
}

#[cfg(test)]
mod tests;

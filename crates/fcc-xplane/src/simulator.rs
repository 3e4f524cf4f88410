//! The simulator's state, from its clock compared with ours.
//!
//! X-Plane slows its time below about 20 frames a second, stops it when paused
//! or behind a dialog, and sets it back when a flight is loaded. Each is a
//! separate state here. Nothing in this file reads a clock: the time of the
//! tick and the contents of the datagrams are passed in.

mod late;
mod pace;
mod state;

use core::time::Duration;

use fcc_core::framework::Time;
use late::{Claim, LATE, LATE_S, LateFilter};
use pace::{Pace, PaceMeter};
pub use state::SimulatorState;

/// If the simulator's clock gains this much on twice ours between two ticks, it
/// was set forward: it may run twice as fast.
const AHEAD_S: f64 = 1.0;
const AHEAD_OF: f64 = 2.0;
/// What a network held back may arrive in several ticks: for this long after a
/// gap of this length the clock is compared with that before the gap, too.
const HELD_BACK: Duration = Duration::from_millis(500);
/// And for so long after one, what was held back may arrive beside what is new.
const BESIDE_FOR: Duration = Duration::from_secs(10);
/// Stalled if its clock has not advanced for this long: five frames at 20 a second.
const STALLED_AFTER: Duration = Duration::from_millis(250);
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
    late: LateFilter,
    /// When a datagram last arrived that was overtaken by a second or more.
    old_arrived: Time,
    /// Of a time that is far ahead.
    ahead: Claim,
    /// The latest before the last gap, and when that ended.
    before_gap: ClockSample,
    gap_ended: Time,
    /// When the clock last advanced, or had a reason not to.
    advanced: Time,
    paused: bool,
    replaying: bool,
    pace: PaceMeter,
    jumped: bool,
    reloaded: bool,
}

impl SimulatorClock {
    pub(crate) fn new(silent_after: Duration) -> Self {
        Self {
            silent_after,
            received: Time::NEVER,
            latest: ClockSample::default(),
            before: ClockSample::default(),
            late: LateFilter::default(),
            old_arrived: Time::NEVER,
            ahead: Claim::default(),
            before_gap: ClockSample::default(),
            gap_ended: Time::NEVER,
            advanced: Time::NEVER,
            paused: false,
            replaying: false,
            pace: PaceMeter::default(),
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

    /// Whether a datagram of this flight time is to be dropped: it was overtaken by
    /// a newer one, or it is the first one with a time far from the latest. Not if
    /// the time is equal: the same frame, or time stands still.
    /// A replay, which the datagram itself shows, goes back by right.
    pub(crate) fn is_late(&mut self, now: Time, time_s: f64, shows_replay: bool) -> bool {
        // A replay may go backwards.
        if self.replaying || self.latest.seen.is_never() {
            return false;
        }
        let sample = ClockSample { time_s, seen: now };
        if self.is_ahead(sample) {
            !self.ahead.is_continued_by(sample)
        } else {
            let gap_is_over = now.since(self.latest.seen) < HELD_BACK;
            let held_back = gap_is_over && !shows_replay && now.since(self.gap_ended) < BESIDE_FOR;
            let is_late = self.late.is_late(sample, self.latest, held_back);
            if is_late && self.latest.time_s - time_s >= LATE_S {
                self.old_arrived = now;
            }
            is_late
        }
    }

    /// Whether what has no time may be as old as what arrives with it.
    pub(crate) fn delivers_old(&self, now: Time) -> bool {
        !self.old_arrived.is_never() && now.since(self.old_arrived) < LATE
    }

    /// The latest time before the last gap, and when that ended, if this is the
    /// next time.
    fn last_gap(&self, now: Time) -> (ClockSample, Time) {
        if now.since(self.latest.seen) >= HELD_BACK {
            (self.latest, now)
        } else {
            (self.before_gap, self.gap_ended)
        }
    }

    /// Whether the clock cannot have run to this time: it was set forward.
    fn is_ahead(&self, sample: ClockSample) -> bool {
        let (before_gap, gap_ended) = self.last_gap(sample.seen);
        sample.is_ahead_of(self.before)
            && (sample.seen.since(gap_ended) >= HELD_BACK || sample.is_ahead_of(before_gap))
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
            self.pace.frame_period_s = period_s;
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
        if !self.paused && !self.latest.seen.is_never() {
            self.pace.update(now, self.latest);
        }
    }

    fn read_clock(&mut self, now: Time, time_s: f64, was_silent: bool) {
        let (before, had_stopped) = (self.latest, self.has_stopped());
        let sample = ClockSample { time_s, seen: now };
        let is_ahead = self.is_ahead(sample);
        let gap = self.last_gap(now);
        self.latest = sample;
        self.late = LateFilter::default();
        self.ahead = Claim::default();
        if before.seen.is_never() {
            self.begin_pace(now);
            return;
        }
        let gained_s = time_s - before.time_s;
        (self.before_gap, self.gap_ended) = gap;
        let gains = self.latest.is_ahead_of(self.before);
        // Late datagrams were dropped, so a time that went back was set back.
        if gained_s < 0.0 || is_ahead {
            self.jumped = true;
            self.old_arrived = Time::NEVER;
            self.begin_pace(now);
        } else if was_silent || gains {
            self.begin_pace(now);
        } else if gained_s > 0.0 {
            let behind_s = now.since(before.seen).as_secs_f64() - gained_s;
            // Frames that are far apart are slow, and no stop.
            if had_stopped {
                self.begin_pace(now);
            }
            self.pace.follow(self.latest, behind_s);
            self.advanced = now;
        }
    }

    /// Restarts the measurement of the pace.
    fn begin_pace(&mut self, now: Time) {
        self.advanced = now;
        self.pace.restart(self.latest);
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

    /// Whether it shows a recorded flight.
    pub(crate) const fn is_replaying(&self) -> bool {
        self.replaying
    }

    /// When its time was last read.
    pub(crate) const fn time_seen(&self) -> Time {
        self.latest.seen
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
            match self.pace.pace() {
                Pace::Slow => SimulatorState::Slow,
                Pace::Even => SimulatorState::Running,
                Pace::Fast => SimulatorState::Fast,
            }
        }
    }
}

#[cfg(test)]
mod tests;

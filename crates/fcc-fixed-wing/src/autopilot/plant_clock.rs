//! The plant's time that passes in a tick, and what a gap in it was.
//!
//! A simulator that loads scenery stops for some tenths of a second up to
//! several seconds and falls silent; a link that is cut looks the same while it
//! lasts. What tells them apart is the plant's own time when it is heard again:
//! it stood still, or it ran on. Until then its time is taken to stand still.

use core::time::Duration;

use super::reading_age::newest;
use fcc_core::flight::{Measurements, Plant, PlantState};
use fcc_core::framework::{Notice, Reading, Tick, Time};

/// The longest single step of the plant's time, s: after a gap the loops
/// continue from the present state, not from an extrapolation.
const MAX_STEP_S: f64 = 0.2;
/// A plant whose time does not advance for longer than this while it sends has
/// stopped: five frames at 20 a second.
const STOPPED_AFTER: Duration = Duration::from_millis(250);
/// A gap longer than this, longer than twice the usual one and than two periods
/// of the loop, is noticed, s: two frames at 20 a second, and less than the
/// shortest freeze that matters.
const NOTICED_S: f64 = 0.095;
/// The plant's time that arrives in so much less of ours was held back.
const HELD_BACK: f64 = 2.0;
/// Less is the rounding of a clock that stands still, s.
const LEAST_STEP_S: f64 = 1e-6;
/// Time that goes back by less is that of an overtaken report, s.
const SET_BACK_S: f64 = 1.0;
/// The usual gap is the shortest of as many: one freeze does not change it, and
/// a simulator that stays slow does.
const USUAL_OF: usize = 4;

/// The kinds of notices.
pub(super) const STOOD_STILL: u8 = 1;
pub(super) const LINK_LOST: u8 = 2;
pub(super) const CLOCK_MISSING: u8 = 5;

/// Why the plant's time is taken to stand still.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) enum Waiting {
    /// It is not: it passes, or the next report of it is due.
    #[default]
    No,
    /// Nothing arrives.
    Silent,
    /// It is paused.
    Paused,
    /// It sends, but its time has stopped.
    Stopped,
    /// It shows a recorded flight.
    Replaying,
}

/// What is known of a gap in the plant's time when it has ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// By how much readings have not aged: the plant's time stood still or was
    /// not heard.
    pub(super) excused: Duration,
    /// Whether the plant's time ran on.
    pub(super) ran_on: bool,
    /// Whether it ran on for so long that what was estimated before is no
    /// longer true.
    pub(super) settles_anew: bool,
}

/// Tracks a simulated plant's clock; a real plant's clock is that of the loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlantClock {
    time_s: Option<f64>,
    state: PlantState,
    /// The sensor from which that time came, and when it was taken.
    source: u8,
    told: Time,
    /// The ticks in which the plant's time last advanced, something last
    /// arrived, and its time was last not taken to stand still.
    advanced: Time,
    /// When the plant's time was taken that last advanced: what a network held
    /// back arrives late, and was sent without a gap.
    sent: Time,
    arrived: Time,
    judged: Time,
    /// The newest time of a reading.
    newest: Time,
    waiting: Waiting,
    /// The last gaps between two advances, s.
    gaps_s: [f64; USUAL_OF],
    /// Time of the present gap in which this loop itself did not run, up to the
    /// tick after it, s.
    missed_s: f64,
    is_ignored: bool,
    /// Whether readings arrive, but not its time, and since when they arrive.
    is_missing: bool,
    arrives_since: Time,
    step_s: f64,
    passed_s: f64,
    gap: Option<Gap>,
    notice: Option<Notice>,
}

impl Default for PlantClock {
    fn default() -> Self {
        Self {
            time_s: None,
            state: PlantState::Running,
            source: 0,
            told: Time::NEVER,
            advanced: Time::NEVER,
            sent: Time::NEVER,
            arrived: Time::NEVER,
            judged: Time::NEVER,
            newest: Time::NEVER,
            waiting: Waiting::No,
            gaps_s: [0.0; USUAL_OF],
            missed_s: 0.0,
            is_ignored: false,
            is_missing: false,
            arrives_since: Time::NEVER,
            step_s: 0.0,
            passed_s: 0.0,
            gap: None,
            notice: None,
        }
    }
}

impl PlantClock {
    /// Reads the plant's time at a tick.
    pub(super) fn step(&mut self, tick: &Tick, measured: &Measurements) {
        self.gap = None;
        self.notice = None;
        let plant = measured.plant;
        if plant.is_never() || !plant.value.time_s.is_finite() && self.time_s.is_none() {
            self.judged = tick.woke;
            self.pass(tick.dt_s.min(MAX_STEP_S));
            return;
        }
        self.pass(0.0);
        if tick.missed > 0 {
            // What waited meanwhile is old, and may not have been read.
            self.missed_s += tick.dt_s;
        }
        let newest = newest(measured);
        let arrives = newest > self.newest;
        if arrives {
            if tick.woke.since(self.arrived) > STOPPED_AFTER {
                self.arrives_since = tick.woke;
            }
            self.newest = newest;
            self.arrived = tick.woke;
            self.state = plant.value.state;
        }
        if self.misses_time(tick, &plant) {
            return;
        }
        self.follow_source(&plant);
        let was = self.waiting;
        self.waiting = match self.state {
            PlantState::Replaying => {
                // Its clock may show the recorded time.
                self.time_s = None;
                Waiting::Replaying
            }
            PlantState::Jumped | PlantState::Reloaded => {
                self.begin(tick, &plant);
                Waiting::No
            }
            state => {
                let gained_s = self
                    .time_s
                    .map_or(0.0, |time_s| plant.value.time_s - time_s);
                if gained_s < -SET_BACK_S {
                    self.state = PlantState::Jumped;
                    self.begin(tick, &plant);
                    Waiting::No
                } else if arrives && (gained_s > LEAST_STEP_S || self.time_s.is_none()) {
                    self.advance(tick, gained_s, was);
                    self.time_s = Some(plant.value.time_s);
                    Waiting::No
                } else if !arrives {
                    Waiting::Silent
                } else if state == PlantState::Paused {
                    Waiting::Paused
                } else if tick.woke.since(self.advanced) > STOPPED_AFTER {
                    Waiting::Stopped
                } else {
                    Waiting::No
                }
            }
        };
        if self.waiting == Waiting::Stopped && self.is_ignored {
            self.ignore(tick);
        }
        if self.waiting == Waiting::No {
            self.judged = tick.woke;
        }
    }

    /// Whether readings arrive, but not the plant's time: then ours is used
    /// instead. A clock that is read again is not compared with itself before.
    fn misses_time(&mut self, tick: &Tick, plant: &Reading<Plant>) -> bool {
        let is_finite = plant.value.time_s.is_finite();
        let told = if is_finite { plant.taken } else { self.told };
        let is_missing = self.state != PlantState::Replaying
            && tick.woke.since(self.arrived) <= STOPPED_AFTER
            && self.newest.since(told.max(self.arrives_since)) > STOPPED_AFTER;
        if is_missing {
            if !self.is_missing {
                self.notice = Some(Notice {
                    kind: CLOCK_MISSING,
                    ..Notice::default()
                });
            }
            self.is_missing = true;
            self.waiting = Waiting::No;
            self.judged = tick.woke;
            self.pass(tick.dt_s.min(MAX_STEP_S));
        } else if self.is_missing && self.newest.since(told) <= STOPPED_AFTER {
            self.begin(tick, plant);
        }
        is_missing || !is_finite && !self.told.is_never()
    }

    fn pass(&mut self, seconds: f64) {
        self.step_s = seconds;
        self.passed_s = seconds;
    }

    /// Clocks of two sensors cannot be compared. When the plant's time comes
    /// from another one, as much of it has passed as of ours since it last came.
    fn follow_source(&mut self, plant: &Reading<Plant>) {
        if plant.source != self.source {
            let passed = plant.taken.since(self.told);
            self.time_s = self
                .time_s
                .map(|_| plant.value.time_s - passed.as_secs_f64());
        }
        self.source = plant.source;
        self.told = plant.taken;
    }

    /// Begins anew with a clock that was set.
    fn begin(&mut self, tick: &Tick, plant: &Reading<Plant>) {
        *self = Self {
            state: self.state,
            source: self.source,
            told: plant.taken,
            newest: self.newest,
            arrived: self.arrived,
            arrives_since: self.arrives_since,
            time_s: Some(plant.value.time_s),
            advanced: tick.woke,
            sent: plant.taken,
            ..Self::default()
        };
    }

    /// The plant's time advanced, in this tick, for the first time after `was`.
    fn advance(&mut self, tick: &Tick, gained_s: f64, was: Waiting) {
        let ours = self.told.since(self.sent);
        let is_first = self.advanced.is_never();
        (self.advanced, self.sent) = (tick.woke, self.told);
        self.is_ignored = false;
        let missed_s = core::mem::take(&mut self.missed_s);
        if is_first {
            return;
        }
        let ours_s = ours.as_secs_f64();
        let usual_s = self.gaps_s.into_iter().fold(f64::INFINITY, f64::min);
        self.gaps_s.rotate_right(1);
        self.gaps_s[0] = ours_s;
        self.step_s = gained_s.min(MAX_STEP_S);
        self.passed_s = gained_s;

        let period_s = tick.dt_s / (tick.missed.saturating_add(1)) as f64;
        let limit_s = NOTICED_S.max(2.0 * usual_s.max(period_s));
        let was_long = ours_s > limit_s;
        // After a part of what a network held back the rest comes at once.
        let is_rest = gained_s > HELD_BACK * ours_s;
        let settles_anew = gained_s > MAX_STEP_S && (was_long || is_rest);
        // Half of the gap is far from both: a frame or two, and all of it.
        let ran_on = settles_anew || was_long && gained_s > 0.5 * ours_s;
        let stood_s = (ours_s - gained_s).max(0.0);
        let excused_s = if settles_anew {
            ours_s
        } else if stood_s > NOTICED_S {
            stood_s
        } else {
            0.0
        };
        if was_long || excused_s > 0.0 {
            self.gap = Some(Gap {
                excused: Duration::from_secs_f64(excused_s),
                ran_on,
                settles_anew,
            });
        }
        // A pause, and what this loop itself missed, are reported elsewhere.
        let is_reported = matches!(was, Waiting::Paused | Waiting::Replaying);
        let heard_s = ours_s - missed_s;
        if !is_reported && heard_s > limit_s {
            let (kind, lasted_s) = if ran_on {
                (LINK_LOST, ours_s)
            } else {
                (STOOD_STILL, stood_s)
            };
            self.notice = Some(Notice {
                kind,
                lasted_ns: (lasted_s.min(heard_s) * 1e9) as u64,
                ..Notice::default()
            });
        }
    }

    /// From now on the clock of a plant that moves although its time has
    /// stopped is ignored, until it advances.
    pub(super) fn ignore(&mut self, tick: &Tick) {
        self.is_ignored = true;
        self.waiting = Waiting::No;
        self.judged = tick.woke;
        self.pass(tick.dt_s.min(MAX_STEP_S));
    }

    /// Seconds of the plant since the previous tick, for the loops: limited,
    /// and 0 if its time did not advance.
    pub(super) const fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Seconds of the plant since the previous tick, with all of a gap in which
    /// it was not heard.
    pub(super) const fn passed_s(&self) -> f64 {
        self.passed_s
    }

    /// Whether the plant's clock is ignored because it has stopped.
    pub(super) const fn is_ignored(&self) -> bool {
        self.is_ignored
    }

    /// Whether the plant's time advanced in this tick.
    pub(super) fn advances(&self, now: Time) -> bool {
        self.advanced == now
    }

    /// Whether the plant's time has stopped although it sends and is not paused.
    pub(super) fn has_stopped(&self) -> bool {
        self.is_ignored || self.waiting == Waiting::Stopped
    }

    /// For how long the plant's time has stood still although it sends and is
    /// not paused.
    pub(super) fn stopped_for(&self, now: Time) -> Duration {
        if self.has_stopped() {
            now.since(self.advanced)
        } else {
            Duration::ZERO
        }
    }

    /// Why the plant's time is taken to stand still.
    pub(super) const fn waiting(&self) -> Waiting {
        self.waiting
    }

    /// The gap that ended in this tick.
    pub(super) const fn gap(&self) -> Option<Gap> {
        self.gap
    }

    /// What that gap was, if it is to be reported.
    pub(super) const fn notice(&self) -> Option<Notice> {
        self.notice
    }

    /// The state of a simulated plant; none of a real one.
    pub(super) fn state(&self) -> Option<PlantState> {
        (!self.arrived.is_never()).then_some(self.state)
    }

    /// For how long nothing has arrived.
    pub(super) fn silent_for(&self, now: Time) -> Duration {
        if self.arrived.is_never() {
            Duration::ZERO
        } else {
            now.since(self.arrived)
        }
    }

    /// The time by which the age of readings is judged: while the plant's time
    /// stands still, they do not grow older.
    pub(super) const fn judged(&self) -> Time {
        self.judged
    }
}

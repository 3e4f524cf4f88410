//! Whether ticks stay within their budget.
//!
//! Stage times are read from a clock, so a decision based on them is not a
//! function of the tick's inputs. They are in the record: a replay passes them back
//! ([`Machine::tick_again`](crate::Machine::tick_again)), and the same ticks
//! overrun.

use std::time::Duration;

use fcc_core::framework::{EventKind, Stage, StageTimes, Tick, Time};

use crate::telemetry_producer::Events;

/// How long a tick and its stages may take, and how often they may take longer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Budget {
    /// From the wake-up to the last actuator write; `None` for the timer's
    /// period.
    pub tick: Option<Duration>,
    /// Sampling the sensors; `None` for no budget of its own, as below.
    pub sensors: Option<Duration>,
    /// The controller's `estimate`.
    pub estimate: Option<Duration>,
    /// The controller's `guide`.
    pub guide: Option<Duration>,
    /// The controller's `control` or `failsafe`.
    pub control: Option<Duration>,
    /// Driving the actuators.
    pub actuators: Option<Duration>,
    /// This many ticks in a row that overrun or are missed lead to failsafe; 0
    /// for never. `None` for as many as fill half a second, at least
    /// [`FEWEST_FOR_FAILSAFE`](Self::FEWEST_FOR_FAILSAFE): a light aircraft
    /// trimmed for level flight hardly moves in that time, and a kernel without
    /// real-time patches is seldom late for longer.
    pub failsafe_after: Option<u32>,
}

impl Budget {
    /// The minimum, for long periods.
    pub const FEWEST_FOR_FAILSAFE: u32 = 4;
    const DEFAULT_FAILSAFE_AFTER: Duration = Duration::from_millis(500);

    const fn of(&self, stage: Stage) -> Option<Duration> {
        match stage {
            Stage::Timer => None,
            Stage::Sensors => self.sensors,
            Stage::Estimate => self.estimate,
            Stage::Guide => self.guide,
            Stage::Control => self.control,
            Stage::Actuators => self.actuators,
            Stage::Tick => self.tick,
        }
    }
}

/// After this long without one, further overruns are reported again.
const OVER_AFTER: Duration = Duration::from_secs(1);

/// A failsafe because of overruns is over after this long without a long row.
const CALM_AFTER: Duration = Duration::from_secs(2);
/// A row is long from this part of those on that lead to failsafe: a kernel without real-time
/// patches makes shorter ones all the time.
const LONG_PART: u64 = 4;
/// At most [`MOST_RECOVERIES`] such failsafes end by themselves within this time: a machine
/// that is too slow for its loop does not end and begin a failsafe again and again.
const RECOVERIES_WITHIN: Duration = Duration::from_secs(60);
const MOST_RECOVERIES: usize = 3;

/// Overruns with less than [`OVER_AFTER`] between them: reported as one.
struct Series {
    count: u64,
    first: u64,
    last: u64,
    last_at: Time,
}

/// Counts and reports overruns.
pub(crate) struct Overruns {
    budget: Budget,
    period_ns: u64,
    /// 0 for never.
    failsafe_after: u64,
    /// Ticks in a row, up to now, that overran or were missed.
    row: u64,
    total: u64,
    series: Option<Series>,
    /// The last tick with a long row.
    long_at: Time,
    /// When failsafes last ended by themselves, the earliest first.
    recoveries: [Time; MOST_RECOVERIES],
}

impl Overruns {
    pub(crate) fn new(budget: Budget, period: Duration) -> Self {
        let half_a_second = Budget::DEFAULT_FAILSAFE_AFTER
            .as_nanos()
            .div_ceil(period.as_nanos().max(1));
        let failsafe_after = budget.failsafe_after.map_or_else(
            || (half_a_second as u64).max(Budget::FEWEST_FOR_FAILSAFE.into()),
            u64::from,
        );
        let tick = Some(budget.tick.unwrap_or(period));
        Self {
            budget: Budget { tick, ..budget },
            period_ns: period.as_nanos() as u64,
            failsafe_after,
            row: 0,
            total: 0,
            series: None,
            long_at: Time::NEVER,
            recoveries: [Time::NEVER; MOST_RECOVERIES],
        }
    }

    /// Processes the start of a tick: periods may have passed unserved.
    pub(crate) fn begin<O>(&mut self, tick: &Tick, events: &mut Events<O>) {
        if tick.missed == 0 {
            return;
        }
        self.lengthen(tick.missed, tick);
        let overrun = EventKind::Overrun {
            of: Stage::Timer,
            took_ns: tick.lateness().as_nanos() as u64,
            budget_ns: self.period_ns,
            longest: Stage::Timer,
        };
        self.note(tick, tick.missed, overrun, events);
    }

    /// Processes the duration of a tick.
    pub(crate) fn end<O>(&mut self, tick: &Tick, stages: &StageTimes, events: &mut Events<O>) {
        let Some((of, budget_ns)) = self.overrun(stages) else {
            self.row = 0;
            self.perhaps_over(tick, events);
            return;
        };
        self.lengthen(1, tick);
        self.total += 1;
        let overrun = EventKind::Overrun {
            of,
            took_ns: stages.of(of),
            budget_ns,
            longest: stages.longest(),
        };
        self.note(tick, 1, overrun, events);
    }

    fn lengthen(&mut self, by: u64, tick: &Tick) {
        self.row = self.row.saturating_add(by);
        if self.is_long() {
            self.long_at = tick.scheduled;
        }
    }

    /// Which budget was exceeded and its length: a stage's before the whole
    /// tick's, because it is more specific.
    fn overrun(&self, stages: &StageTimes) -> Option<(Stage, u64)> {
        let all = Stage::TIMED.into_iter().chain([Stage::Tick]);
        all.filter_map(|stage| Some((stage, self.budget.of(stage)?.as_nanos() as u64)))
            .find(|(stage, budget_ns)| stages.of(*stage) > *budget_ns)
    }

    fn note<O>(&mut self, tick: &Tick, count: u64, overrun: EventKind<O>, events: &mut Events<O>) {
        self.perhaps_over(tick, events);
        match &mut self.series {
            Some(series) => {
                series.count = series.count.saturating_add(count);
                series.last = tick.number;
                series.last_at = tick.scheduled;
            }
            none => {
                *none = Some(Series {
                    count,
                    first: tick.number,
                    last: tick.number,
                    last_at: tick.scheduled,
                });
                events.push(tick, overrun);
            }
        }
    }

    fn perhaps_over<O>(&mut self, tick: &Tick, events: &mut Events<O>) {
        let over = |series: &mut Series| tick.scheduled.since(series.last_at) >= OVER_AFTER;
        if let Some(Series {
            count, first, last, ..
        }) = self.series.take_if(over)
        {
            events.push(tick, EventKind::OverrunsOver { count, first, last });
        }
    }

    /// Whether as many ticks in a row overran or were missed as lead to
    /// failsafe.
    pub(crate) const fn are_too_many(&self) -> bool {
        self.failsafe_after > 0 && self.row >= self.failsafe_after
    }

    /// Whether so many ticks in a row overran or were missed that those which led to failsafe
    /// go on.
    pub(crate) const fn is_long(&self) -> bool {
        self.failsafe_after > 0 && self.row.saturating_mul(LONG_PART) >= self.failsafe_after
    }

    /// Whether a failsafe because of them may end by itself.
    pub(crate) fn are_over(&self, tick: &Tick) -> bool {
        tick.scheduled.since(self.long_at) >= CALM_AFTER
            && tick.scheduled.since(self.recoveries[0]) >= RECOVERIES_WITHIN
    }

    /// Such a failsafe ends by itself.
    pub(crate) fn recover(&mut self, tick: &Tick) {
        self.recoveries.rotate_left(1);
        self.recoveries[MOST_RECOVERIES - 1] = tick.scheduled;
    }

    /// Ticks that overran since the start.
    pub(crate) const fn total(&self) -> u64 {
        self.total
    }
}

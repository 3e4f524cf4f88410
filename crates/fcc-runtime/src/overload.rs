//! Whether ticks leave their thread time to sleep, and what is done if not.
//!
//! A thread under `SCHED_FIFO` that never sleeps keeps all others off its CPU:
//! those that read its messages, release control from outside or receive a
//! signal. Decided by the timer's clock, so a replay does not repeat it: skipped
//! deadlines are missed ones, and a stop is an event.

use std::time::Duration;

use fcc_core::framework::{EventKind, Tick, Time};
use fcc_timer::{Expiry, Relief};

use crate::telemetry_producer::Events;

/// When a loop whose ticks leave no time to sleep makes room for other threads.
///
/// A tick leaves none if less than a twentieth of a period is left when it ends:
/// as much as Linux itself keeps from real-time threads by default.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Overload {
    /// After this long without sleep, deadlines are skipped ([`Relief::Skip`]);
    /// after half of it, counting the time that is spun, the timer no longer
    /// wakes early. Not before four ticks. `None` for never; 250 ms by default.
    pub skip_after: Option<Duration>,
    /// After this long without a tick that leaves time the loop releases control
    /// and stops. `None` for never; 10 s by default.
    pub stop_after: Option<Duration>,
}

impl Default for Overload {
    fn default() -> Self {
        Self {
            skip_after: Some(Duration::from_millis(250)),
            stop_after: Some(Duration::from_secs(10)),
        }
    }
}

/// Fewer ticks may be late by chance.
const FEWEST_TICKS: u64 = 4;
/// The part of a period that a tick has to leave.
const REST: u64 = 20;
/// A relief ends after this long without a tick that needs it.
const OVER_AFTER: Duration = Duration::from_secs(1);

/// Ticks that left too little time, with less than [`OVER_AFTER`] between them
/// once there is a relief, else without any between them.
#[derive(Clone, Copy)]
struct Row {
    count: u64,
    first: u64,
    last: u64,
    since: Time,
    last_at: Time,
    /// Since when each tick left too little.
    unbroken_since: Option<Time>,
}

impl Row {
    fn has_lasted(&self, at_least: Option<Duration>, tick: &Tick) -> bool {
        self.count >= FEWEST_TICKS
            && at_least.is_some_and(|after| tick.scheduled.since(self.since) >= after)
    }

    /// Continues a row by a tick; returns the one that ended with it.
    fn follow(row: &mut Option<Self>, tick: &Tick, needs: bool, relieved: bool) -> Option<Self> {
        let at = tick.scheduled;
        if needs {
            let row = row.get_or_insert(Self {
                count: 0,
                first: tick.number,
                last: tick.number,
                since: at,
                last_at: at,
                unbroken_since: None,
            });
            row.count += 1;
            (row.last, row.last_at) = (tick.number, at);
            row.unbroken_since.get_or_insert(at);
            return None;
        }
        if let Some(row) = row {
            row.unbroken_since = None;
        }
        row.take_if(|row| !relieved || at.since(row.last_at) >= OVER_AFTER)
    }
}

/// Counts ticks that leave no time to sleep.
pub(crate) struct Load {
    rules: Overload,
    period_ns: u64,
    /// The latest margin of early wake.
    margin_ns: u64,
    /// With the margin counted as used.
    tight: Option<Row>,
    /// Without it.
    busy: Option<Row>,
    relief: Relief,
    unslept: u64,
}

impl Load {
    pub(crate) const fn new(rules: Overload, period: Duration) -> Self {
        Self {
            rules,
            period_ns: period.as_nanos() as u64,
            margin_ns: 0,
            tight: None,
            busy: None,
            relief: Relief::None,
            unslept: 0,
        }
    }

    /// Processes a wake-up, which tells how much time the tick before it left.
    pub(crate) fn take<O>(&mut self, tick: &Tick, expiry: &Expiry, events: &mut Events<O>) {
        if expiry.early_wake_ns > 0 {
            self.margin_ns = expiry.early_wake_ns;
        }
        let used_ns = expiry.used_ns.saturating_add(self.period_ns / REST);
        let is_busy = used_ns > self.period_ns;
        self.unslept += u64::from(is_busy);
        let is_tight = used_ns.saturating_add(self.margin_ns) > self.period_ns;
        Row::follow(&mut self.tight, tick, is_tight, self.relief != Relief::None);
        let skips = self.relief == Relief::Skip;
        let over = Row::follow(&mut self.busy, tick, is_busy, skips);
        self.relief = self.next_relief(tick);
        match (skips, self.relief == Relief::Skip) {
            (false, true) => events.push(
                tick,
                EventKind::Overloaded {
                    used_ns: expiry.used_ns,
                    period_ns: self.period_ns,
                },
            ),
            (true, false) => {
                if let Some(Row {
                    count, first, last, ..
                }) = over
                {
                    events.push(tick, EventKind::OverloadOver { count, first, last });
                }
            }
            _ => {}
        }
    }

    fn next_relief(&self, tick: &Tick) -> Relief {
        let after = self.rules.skip_after;
        let lasts = |row: &Option<Row>, after| row.is_some_and(|row| row.has_lasted(after, tick));
        if lasts(&self.busy, after) {
            Relief::Skip
        } else if lasts(&self.tight, after.map(|after| after / 2)) {
            Relief::NoSpin
        } else {
            Relief::None
        }
    }

    /// What the timer has to do.
    pub(crate) const fn relief(&self) -> Relief {
        self.relief
    }

    /// Whether no tick has left time for longer than is permitted.
    pub(crate) fn is_too_long(&self, tick: &Tick) -> bool {
        let since = self.busy.and_then(|row| row.unbroken_since);
        let lasted = since.map(|since| tick.scheduled.since(since));
        lasted
            .zip(self.rules.stop_after)
            .is_some_and(|(lasted, most)| lasted >= most)
    }

    /// Ticks that left no time to sleep, since the start.
    pub(crate) const fn unslept(&self) -> u64 {
        self.unslept
    }
}

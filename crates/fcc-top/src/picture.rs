//! The state of a loop, as received.

use std::collections::VecDeque;

use fcc_core::framework::{RecordOf, StageTimes};
use fcc_live::{EVENT_HISTORY, Event, EventCode, Info, Status, WatchError, WatcherOf};

use fcc_telemetry::Telemetry;

/// The state of a loop, from its live telemetry.
pub struct Picture<C: Telemetry> {
    pub(super) info: Info,
    /// The newest.
    pub(super) record: Option<RecordOf<C>>,
    pub(super) status: Option<Status>,
    /// The oldest first.
    pub(super) events: VecDeque<Event>,
    /// The longest duration of each stage among the received records.
    pub(super) longest: StageTimes,
    /// When the present state began, on the loop's clock; `None` if before the
    /// first received record.
    pub(super) state_since_ns: Option<i64>,
    /// Whether the loop's program has ended.
    pub(super) ended: bool,
}

impl<C: Telemetry> Picture<C> {
    pub(super) fn new(watcher: &WatcherOf<C>) -> Self {
        Self::of(watcher.info())
    }

    /// Only the publisher's information.
    pub fn of(info: &Info) -> Self {
        Self {
            info: *info,
            record: None,
            status: None,
            events: VecDeque::with_capacity(EVENT_HISTORY),
            longest: StageTimes::default(),
            state_since_ns: None,
            ended: false,
        }
    }

    /// Takes all new messages; returns whether there were any.
    pub(super) fn update(&mut self, watcher: &mut WatcherOf<C>) -> Result<bool, WatchError> {
        let mut new = false;
        while let Some(record) = watcher.next_record()? {
            self.record(&record);
            new = true;
        }
        while let Some(event) = watcher.next_event()? {
            self.event(event);
            new = true;
        }
        if let Some(status) = watcher.latest_status()? {
            self.status = Some(status);
            new = true;
        }
        Ok(new)
    }

    /// Whether at least one of each regular message was received.
    pub(super) const fn is_whole(&self) -> bool {
        self.record.is_some() && self.status.is_some()
    }

    /// Seconds since the loop's first tick, as in its log and its recording.
    pub(super) fn seconds(&self, time_ns: i64) -> f64 {
        let first_ns = self.record.as_ref().map_or(self.info.started_ns, |record| {
            let periods = record.tick.number.saturating_sub(1) as f64;
            let since_ns = (periods * 1e9 / self.info.rate_hz) as i64;
            record.tick.scheduled.as_nanos().saturating_sub(since_ns)
        });
        time_ns.saturating_sub(first_ns) as f64 * 1e-9
    }

    /// Takes the newest record.
    pub fn record(&mut self, record: &RecordOf<C>) {
        let (longest, now) = (&mut self.longest, &record.stages);
        for (longest, now) in [
            (&mut longest.sensors_ns, now.sensors_ns),
            (&mut longest.estimate_ns, now.estimate_ns),
            (&mut longest.guide_ns, now.guide_ns),
            (&mut longest.control_ns, now.control_ns),
            (&mut longest.actuators_ns, now.actuators_ns),
            (&mut longest.total_ns, now.total_ns),
        ] {
            *longest = (*longest).max(now);
        }
        self.record = Some(*record);
    }

    /// Takes an event.
    pub fn event(&mut self, event: Event) {
        if event.code == EventCode::StateChanged as u32 {
            self.state_since_ns = Some(event.time_ns);
        }
        if self.events.len() == EVENT_HISTORY {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }
}

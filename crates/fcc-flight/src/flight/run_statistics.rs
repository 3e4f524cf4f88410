//! The statistics of a loop that cannot return its own.

use std::time::Duration;

use fcc_core::framework::{Cause, Controller, EventKind, Message, MessageOf, RecordOf, State};
use fcc_runtime::{Ending, LoopReport};
use fcc_telemetry::expiry_of;
use fcc_timer::{RealtimeGranted, TimerError, TimingStats};

use super::hang::Hung;

/// Collects, from the loop's messages, the statistics that the loop would
/// return at its end: for one that hangs.
pub(crate) struct RunStatistics<C: Controller> {
    timing: TimingStats,
    ticks: u64,
    failsafes: u64,
    last_failsafe: Option<Cause>,
    last: RecordOf<C>,
}

impl<C: Controller> RunStatistics<C> {
    /// Empty statistics.
    ///
    /// # Errors
    /// When no statistics can be kept for the period.
    pub(crate) fn new(period: Duration) -> Result<Self, TimerError> {
        Ok(Self {
            timing: TimingStats::new(period)?,
            ticks: 0,
            failsafes: 0,
            last_failsafe: None,
            last: RecordOf::<C>::default(),
        })
    }

    /// Processes a message of the loop.
    pub(crate) fn take(&mut self, message: &MessageOf<C>) {
        match message {
            Message::Tick(record) => {
                self.timing.record(&expiry_of(record));
                self.ticks += 1;
                self.last = *record;
            }
            Message::Event(event) => {
                if let EventKind::StateChanged {
                    to: State::Failsafe(cause),
                    ..
                } = event.kind
                {
                    self.failsafes += 1;
                    self.last_failsafe = Some(cause);
                }
            }
        }
    }

    /// The last record.
    pub(crate) const fn last(&self) -> &RecordOf<C> {
        &self.last
    }

    /// The report of a loop that hung.
    pub(crate) fn report(
        &self,
        hung: Hung,
        timer: &'static str,
        granted: RealtimeGranted,
    ) -> LoopReport {
        LoopReport {
            ending: Ending::Hung,
            ticks: self.ticks,
            timer,
            timing: self.timing.summary(),
            failsafes: self.failsafes,
            last_failsafe: self.last_failsafe,
            released: hung.released,
            sensor_faults: self.last.sensor_faults,
            actuator_faults: self.last.actuator_faults,
            overruns: self.last.overruns,
            unslept: 0,
            records_dropped: self.last.records_dropped,
            events_dropped: 0,
            cpu_time: Duration::ZERO,
            page_faults: Some(self.last.page_faults),
            granted: Some(granted),
        }
    }
}

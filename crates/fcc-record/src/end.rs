//! Statistics of a flight at the end of its recording.

use std::collections::BTreeMap;

use fcc_core::framework::{EventKind, Message, Record, State};

use super::about::{fields, number};

/// Statistics of a flight at the end of its recording, or of the part that a
/// file contains.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct End {
    /// Why it ended, as text.
    pub ending: String,
    /// Records in the file.
    pub ticks: u64,
    /// Events in the file.
    pub events: u64,
    /// Number of its first tick.
    pub first_tick: u64,
    /// Number of its last tick.
    pub last_tick: u64,
    /// Missed periods between the first and the last tick.
    pub missed: u64,
    /// Time from the first wake-up to the last, ns.
    pub duration_ns: u64,
    /// The greatest lateness of a wake-up for the first period it served, a
    /// missed one included, ns.
    pub worst_lateness_ns: u64,
    /// The loop's state at the last tick, as text.
    pub state: String,
    /// Records and events that reached the recorder and not the file.
    pub not_recorded: u64,
}

/// Name of the metadata record with these fields.
pub(super) const END: &str = "fcc.end";

impl End {
    pub(super) fn to_fields(&self) -> BTreeMap<String, String> {
        fields([
            ("ending", self.ending.clone()),
            ("ticks", self.ticks.to_string()),
            ("events", self.events.to_string()),
            ("first_tick", self.first_tick.to_string()),
            ("last_tick", self.last_tick.to_string()),
            ("missed", self.missed.to_string()),
            ("duration_ns", self.duration_ns.to_string()),
            ("worst_lateness_ns", self.worst_lateness_ns.to_string()),
            ("state", self.state.clone()),
            ("not_recorded", self.not_recorded.to_string()),
        ])
    }

    pub(super) fn from_fields(fields_read: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| fields_read.get(key).cloned().unwrap_or_default();
        Self {
            ending: text("ending"),
            ticks: number(fields_read, "ticks"),
            events: number(fields_read, "events"),
            first_tick: number(fields_read, "first_tick"),
            last_tick: number(fields_read, "last_tick"),
            missed: number(fields_read, "missed"),
            duration_ns: number(fields_read, "duration_ns"),
            worst_lateness_ns: number(fields_read, "worst_lateness_ns"),
            state: text("state"),
            not_recorded: number(fields_read, "not_recorded"),
        }
    }
}

/// Collects the statistics from the messages.
#[derive(Clone, Debug, Default)]
pub(super) struct RunStatistics {
    end: End,
    first_woke_ns: i64,
    last_state: Option<State>,
}

impl RunStatistics {
    pub(super) fn take<M, E, S, O, R>(&mut self, message: &Message<M, E, S, O, R>) {
        match message {
            Message::Tick(record) => self.count(record),
            Message::Event(event) => {
                self.end.events += 1;
                if let EventKind::NotRecorded { count, .. } = event.kind {
                    self.end.not_recorded = self.end.not_recorded.saturating_add(count);
                }
            }
        }
    }

    fn count<M, E, S, O>(&mut self, record: &Record<M, E, S, O>) {
        let tick = &record.tick;
        let woke_ns = tick.woke.as_nanos();
        let end = &mut self.end;
        if end.ticks == 0 {
            end.first_tick = tick.number;
            self.first_woke_ns = woke_ns;
        } else {
            end.missed = end.missed.saturating_add(tick.missed);
        }
        end.ticks += 1;
        end.last_tick = tick.number;
        end.duration_ns =
            u64::try_from(woke_ns.saturating_sub(self.first_woke_ns)).unwrap_or_default();
        let lateness_ns = u64::try_from(tick.lateness().as_nanos()).unwrap_or(u64::MAX);
        end.worst_lateness_ns = end.worst_lateness_ns.max(lateness_ns);
        self.last_state = Some(record.state.state());
    }

    pub(super) fn ticks(&self) -> u64 {
        self.end.ticks
    }

    /// The statistics so far.
    pub(super) fn end(&self, ending: &str) -> End {
        End {
            ending: ending.to_owned(),
            state: self
                .last_state
                .map_or_else(|| "unknown".to_owned(), |state| state.to_string()),
            ..self.end.clone()
        }
    }
}

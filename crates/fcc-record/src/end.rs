//! The account of a flight at the end of its recording.

use std::collections::BTreeMap;

use fcc_core::framework::{EventKind, Message, Record, State};

use super::about::{fields, number};

/// The account of a flight at the end of its recording, or of what a file
/// holds of it.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct End {
    /// Why it ended, in words.
    pub ending: String,
    /// Records in the file.
    pub ticks: u64,
    /// Number of its first tick.
    pub first_tick: u64,
    /// Number of its last tick.
    pub last_tick: u64,
    /// Ticks that passed unserved between the first and the last.
    pub missed: u64,
    /// Time from the first wake-up to the last, ns.
    pub duration_ns: u64,
    /// How late the loop woke at worst, ns.
    pub worst_lateness_ns: u64,
    /// The loop's state in words, at the last tick.
    pub state: String,
    /// Records and events that came to the recorder and not into the file.
    pub not_recorded: u64,
}

/// Name of the metadata record that says this.
pub(super) const END: &str = "fcc.end";

impl End {
    pub(super) fn to_fields(&self) -> BTreeMap<String, String> {
        fields([
            ("ending", self.ending.clone()),
            ("ticks", self.ticks.to_string()),
            ("first_tick", self.first_tick.to_string()),
            ("last_tick", self.last_tick.to_string()),
            ("missed", self.missed.to_string()),
            ("duration_ns", self.duration_ns.to_string()),
            ("worst_lateness_ns", self.worst_lateness_ns.to_string()),
            ("state", self.state.clone()),
            ("not_recorded", self.not_recorded.to_string()),
        ])
    }

    pub(super) fn from_fields(said: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| said.get(key).cloned().unwrap_or_default();
        Self {
            ending: text("ending"),
            ticks: number(said, "ticks"),
            first_tick: number(said, "first_tick"),
            last_tick: number(said, "last_tick"),
            missed: number(said, "missed"),
            duration_ns: number(said, "duration_ns"),
            worst_lateness_ns: number(said, "worst_lateness_ns"),
            state: text("state"),
            not_recorded: number(said, "not_recorded"),
        }
    }
}

/// Keeps the account while messages go by.
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
        let lateness_ns = u64::try_from(tick.woke - tick.scheduled).unwrap_or_default();
        end.worst_lateness_ns = end.worst_lateness_ns.max(lateness_ns);
        self.last_state = Some(record.state.state());
    }

    pub(super) fn ticks(&self) -> u64 {
        self.end.ticks
    }

    /// The account so far.
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

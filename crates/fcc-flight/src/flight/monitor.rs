//! The elapsed time of a flight, and whether it is over.

use fcc_core::framework::{EventKind, Message, State};

use super::observer::FlightTime;
use super::plan::Length;

/// Determines the flight's time from the loop's messages.
#[derive(Default)]
pub(super) struct Monitor {
    start_ns: Option<i64>,
    at: FlightTime,
    failed: bool,
    refused: bool,
}

impl Monitor {
    /// Processes a message of the loop; returns its time.
    pub(super) fn take<M, E, S, O, R>(&mut self, message: &Message<M, E, S, O, R>) -> FlightTime {
        match message {
            Message::Tick(record) => {
                let woke_ns = record.tick.woke.as_nanos();
                let time_s = self.seconds(record.tick.scheduled.as_nanos());
                let since = self.at.engaged_at_s.unwrap_or(time_s);
                self.at = FlightTime {
                    time_s,
                    tick: record.tick.number,
                    woke_ns,
                    engaged_at_s: (record.state == State::Engaged).then_some(since),
                };
                self.at
            }
            Message::Event(event) => {
                self.failed |= matches!(
                    event.kind,
                    EventKind::StateChanged {
                        to: State::Failsafe(_),
                        ..
                    }
                );
                self.refused |= matches!(event.kind, EventKind::EngageRefused { .. });
                FlightTime {
                    time_s: self.seconds(event.time.as_nanos()),
                    tick: event.tick,
                    woke_ns: event.time.as_nanos(),
                    ..self.at
                }
            }
        }
    }

    /// The time of the last tick.
    pub(super) const fn at(&self) -> FlightTime {
        self.at
    }

    /// Whether a flight of this length is over: its time has passed, or it
    /// cannot be flown.
    pub(super) fn is_over(&self, length: Length) -> bool {
        // Tolerance for the sum of ticks at a whole second.
        const ROUNDING_S: f64 = 1e-6;
        let time_s = self.at.time_s;
        let time_is_up = match length {
            Length::Open => return false,
            Length::Ticks(ticks) => return self.at.tick >= ticks,
            Length::Engaged(seconds) => self
                .at
                .engaged_at_s
                .is_some_and(|at_s| time_s - at_s >= seconds - ROUNDING_S),
            Length::Whole(seconds) => time_s >= seconds - ROUNDING_S,
        };
        time_is_up || self.failed || self.refused
    }

    /// Whether engaging was refused.
    pub(super) const fn was_refused(&self) -> bool {
        self.refused
    }

    /// Seconds since the loop's first message; an event before the first tick
    /// is at 0.
    fn seconds(&mut self, nanos: i64) -> f64 {
        if nanos == i64::MIN {
            return 0.0;
        }
        let start = *self.start_ns.get_or_insert(nanos);
        (nanos - start) as f64 * 1e-9
    }
}

//! The elapsed time of a flight, and whether it is over.

use fcc_core::framework::{EventKind, Message, State};

use super::observer::FlightTime;
use super::outcome::Over;
use super::plan::Length;

/// How a plan is flown, by the events.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PlanProgress {
    /// Whether its plan is flown to its end: it has landed, or circles there.
    pub(crate) is_flown: bool,
    /// Whether its take-off was given up, or it has glided without power, and it stands.
    pub(crate) gave_up: bool,
    /// Whether the wheels touched the ground outside of a take-off and a landing.
    pub(crate) touched: bool,
}

/// Determines the flight's time from the loop's messages.
#[derive(Default)]
pub(crate) struct Monitor {
    start_ns: Option<i64>,
    at: FlightTime,
    /// Of the first engagement, s.
    engaged_at_s: Option<f64>,
    failed: bool,
    refused: bool,
    pub(crate) plan: PlanProgress,
}

impl Monitor {
    /// Processes a message of the loop; returns its time.
    pub(crate) fn take<M, E, S, O, R>(&mut self, message: &Message<M, E, S, O, R>) -> FlightTime {
        match message {
            Message::Tick(record) => {
                let woke_ns = record.tick.woke.as_nanos();
                let time_s = self.seconds(record.tick.scheduled.as_nanos());
                let is_engaged = record.state == State::Engaged;
                let since = self.at.engaged_at_s.unwrap_or(time_s);
                self.at = FlightTime {
                    time_s,
                    tick: record.tick.number,
                    woke_ns,
                    engaged_at_s: is_engaged.then_some(since),
                };
                self.engaged_at_s = self.engaged_at_s.or(self.at.engaged_at_s);
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
                // A command that comes before the switch is on is no attempt of the flight.
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
    pub(crate) const fn at(&self) -> FlightTime {
        self.at
    }

    /// Why a flight of this length is over, if it is: its time has passed, or it
    /// cannot be flown.
    pub(crate) fn over(&self, length: Length) -> Option<Over> {
        // Tolerance for the sum of ticks at a whole second.
        const ROUNDING_S: f64 = 1e-6;
        let time_s = self.at.time_s;
        let time_is_up = match length {
            Length::Open => return None,
            Length::Ticks(ticks) => return (self.at.tick >= ticks).then_some(Over::Time),
            Length::Engaged(seconds) | Length::Flown(seconds) => self
                .engaged_at_s
                .is_some_and(|at_s| time_s - at_s >= seconds - ROUNDING_S),
            Length::Whole(seconds) => time_s >= seconds - ROUNDING_S,
        };
        if self.refused {
            Some(Over::Refused)
        } else if self.failed {
            Some(Over::Failsafe)
        } else if self.plan.touched {
            Some(Over::Ground)
        } else if self.plan.is_flown && matches!(length, Length::Flown(_)) {
            Some(Over::Flown)
        } else if self.plan.gave_up && matches!(length, Length::Flown(_)) {
            Some(Over::GivenUp)
        } else {
            time_is_up.then_some(Over::Time)
        }
    }

    /// Seconds since the loop's first message; an event before the first tick
    /// is at 0, and so is a tick that was due before that event.
    fn seconds(&mut self, nanos: i64) -> f64 {
        if nanos == i64::MIN {
            return 0.0;
        }
        let start = *self.start_ns.get_or_insert(nanos);
        (nanos - start).max(0) as f64 * 1e-9
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Record, Tick, Time};

    use super::*;

    /// -0.1 ms would be written as "-0.00 s".
    #[test]
    fn no_time_of_a_flight_is_negative() {
        let mut monitor = Monitor::default();
        let times = [1_000_000, 900_000, 26_000_000].map(|nanos| monitor.seconds(nanos));
        assert_eq!(
            times.map(|time_s| format!("{time_s:.3}")),
            ["0.000", "0.000", "0.025"]
        );
    }

    #[test]
    fn a_flight_is_over_its_length_after_the_first_engagement() {
        let mut monitor = Monitor::default();
        let mut over_at = None;
        for number in 0..10_u64 {
            let at = Time::from_nanos(number as i64 * 1_000_000_000);
            let tick = Tick {
                number,
                scheduled: at,
                woke: at,
                ..Tick::default()
            };
            // Engaged from 2 s to 4 s, then disengaged.
            let state = match number {
                2..4 => State::Engaged,
                _ => State::Standby,
            };
            let record: Record<f64, (), f64, f64> = Record::new(tick, state);
            monitor.take(&Message::<f64, (), f64, f64, f64>::Tick(record));
            if over_at.is_none() && monitor.over(Length::Engaged(5.0)).is_some() {
                over_at = Some(number);
            }
        }
        assert_eq!(over_at, Some(7));
    }
}

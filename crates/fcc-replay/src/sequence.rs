//! Assembles the inputs of the loop tick by tick, and detects missing ones.

use fcc_core::framework::{Event, EventKind, LoopCommand, Message, Tick};

/// Reason why a recording cannot be replayed from some tick on.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Cut {
    /// The recording begins after the loop did.
    #[error(
        "the recording begins in tick {tick}, after the start of the loop, and the state of the \
         loop at that time is not in it: give the recordings before it too, oldest first"
    )]
    BeginsLate {
        /// Its first tick.
        tick: u64,
    },
    /// Records or events are missing.
    #[error(
        "the recording of ticks {first} to {last} is incomplete, and every later tick \
         depends on it"
    )]
    Gap {
        /// The first incomplete tick.
        first: u64,
        /// The last incomplete tick.
        last: u64,
    },
    /// Time went back.
    #[error(
        "tick {tick} follows tick {after}: that is another run, or the recordings are not \
         given oldest first"
    )]
    AnotherRun {
        /// The tick that does not follow.
        tick: u64,
        /// The previous tick.
        after: u64,
    },
    /// Events are missing, and they may have been commands.
    #[error("events of ticks {first} to {last} are missing, and there may be commands among them")]
    EventsMissing {
        /// The tick of the first.
        first: u64,
        /// The tick of the last.
        last: u64,
    },
    /// A command is not with the record of its tick.
    #[error("a command of tick {tick} is not recorded directly before the record of its tick")]
    CommandOutOfPlace {
        /// The command's tick.
        tick: u64,
    },
    /// A part of the loop panicked; the progress of that tick is not known.
    #[error(
        "a part of the loop panicked in tick {tick}: the progress of that tick is not recorded"
    )]
    Panicked {
        /// The tick.
        tick: u64,
    },
    /// The loop stopped in the replay, but not in the recording.
    #[error("the loop stopped before tick {tick} in the replay, but continued in the recording")]
    StoppedEarly {
        /// The first tick that was not performed.
        tick: u64,
    },
}

/// More commands than a loop reads in a tick: only an invalid file has as many
/// before a record. It limits the memory.
const MOST_COMMANDS: usize = 1_024;

/// Assembles the inputs from outside for each tick.
#[derive(Debug)]
pub(super) struct Sequence<R> {
    last: Option<Tick>,
    /// The tick of the inputs that wait for its record.
    awaited: Option<u64>,
    commands: Vec<LoopCommand<R>>,
    stop_requested: bool,
    panicked: bool,
}

/// The inputs of one tick, other than measurements.
#[derive(Debug, PartialEq)]
pub(super) struct Inputs<R> {
    /// In the order in which they were read.
    pub(super) commands: Vec<LoopCommand<R>>,
    /// Whether the stop flag was set.
    pub(super) stop_requested: bool,
}

impl<R> Default for Sequence<R> {
    fn default() -> Self {
        Self {
            last: None,
            awaited: None,
            commands: Vec::new(),
            stop_requested: false,
            panicked: false,
        }
    }
}

impl<R: Copy> Sequence<R> {
    /// Takes the next message; for a record, returns the inputs of its tick.
    ///
    /// # Errors
    /// When the inputs from here on are not known.
    pub(super) fn take<M, E, S, O>(
        &mut self,
        message: &Message<M, E, S, O, R>,
    ) -> Result<Option<Inputs<R>>, Cut> {
        match message {
            Message::Event(event) => self.event(event).map(|()| None),
            Message::Tick(record) => self.tick(&record.tick).map(Some),
        }
    }

    fn event(&mut self, event: &Event<R>) -> Result<(), Cut> {
        match event.kind {
            EventKind::CommandReceived(command) => {
                self.await_record(event.tick)?;
                self.commands.push(command);
            }
            EventKind::StopRequested | EventKind::StoppedByOverload => {
                self.await_record(event.tick)?;
                self.stop_requested = true;
            }
            // An event without a record after it occurred between ticks.
            EventKind::Panicked => {
                self.panicked = self.last.is_none_or(|last| event.tick > last.number);
            }
            EventKind::EventsDropped { first, last, .. } => {
                return Err(Cut::EventsMissing { first, last });
            }
            // Even if every record is present, events may be missing.
            EventKind::NotRecorded { first, last, .. } => {
                return Err(Cut::Gap { first, last });
            }
            _ => {}
        }
        Ok(())
    }

    fn await_record(&mut self, tick: u64) -> Result<(), Cut> {
        let is_late = self.last.is_some_and(|last| tick <= last.number);
        if is_late || self.commands.len() >= MOST_COMMANDS {
            return Err(Cut::CommandOutOfPlace { tick });
        }
        match self.awaited.replace(tick) {
            Some(awaited) if awaited != tick => Err(Cut::CommandOutOfPlace { tick: awaited }),
            _ => Ok(()),
        }
    }

    fn tick(&mut self, tick: &Tick) -> Result<Inputs<R>, Cut> {
        self.follows(tick)?;
        if let Some(awaited) = self.awaited.take()
            && awaited != tick.number
        {
            return Err(Cut::CommandOutOfPlace { tick: awaited });
        }
        if self.panicked {
            return Err(Cut::Panicked { tick: tick.number });
        }
        self.last = Some(*tick);
        Ok(Inputs {
            commands: std::mem::take(&mut self.commands),
            stop_requested: std::mem::take(&mut self.stop_requested),
        })
    }

    /// Whether a tick directly follows the previous one, or is the loop's
    /// first: deadlines count from 1, and missed ones are recorded.
    fn follows(&self, tick: &Tick) -> Result<(), Cut> {
        let number = tick.number;
        // The first deadline after the previous tick, missed or not.
        let due = number.saturating_sub(tick.missed);
        let Some(last) = self.last else {
            return match due {
                1 => Ok(()),
                _ => Err(Cut::BeginsLate { tick: number }),
            };
        };
        let next = last.number.saturating_add(1);
        if number < next || due < next || tick.scheduled <= last.scheduled {
            return Err(Cut::AnotherRun {
                tick: number,
                after: last.number,
            });
        }
        if due > next {
            return Err(Cut::Gap {
                first: next,
                last: due - 1,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Record, State, Time};

    use super::*;

    type TestMessage = Message<(), (), (), (), f64>;

    const MS: i64 = 1_000_000;

    fn record(number: u64, missed: u64) -> TestMessage {
        let scheduled = Time::from_nanos(number as i64 * 25 * MS);
        let tick = Tick {
            number,
            scheduled,
            woke: scheduled,
            missed,
            dt_s: 0.025,
        };
        Message::Tick(Record::new(tick, State::Standby))
    }

    fn event(tick: u64, kind: EventKind<f64>) -> TestMessage {
        Message::Event(Event {
            tick,
            time: Time::NEVER,
            kind,
        })
    }

    const WANTED: LoopCommand<f64> = LoopCommand::Controller(1.0);

    /// The cut that ends a sequence of messages, if any.
    fn cut(messages: &[TestMessage]) -> Option<Cut> {
        let mut sequence = Sequence::default();
        messages
            .iter()
            .find_map(|message| sequence.take(message).err())
    }

    #[test]
    fn commands_and_the_stop_flag_go_with_their_tick() {
        let mut sequence = Sequence::default();
        let messages = [
            event(1, EventKind::CommandReceived(WANTED)),
            event(1, EventKind::CommandReceived(LoopCommand::Engage)),
            record(1, 0),
            record(2, 0),
            event(4, EventKind::StopRequested),
            record(4, 1),
        ];
        let told: Vec<_> = messages
            .iter()
            .filter_map(|message| sequence.take(message).unwrap())
            .map(|inputs| (inputs.commands, inputs.stop_requested))
            .collect();
        assert_eq!(
            told,
            [
                (vec![WANTED, LoopCommand::Engage], false),
                (vec![], false),
                (vec![], true)
            ]
        );
    }

    #[test]
    fn missed_ticks_are_no_gap_and_missing_records_are() {
        assert_eq!(cut(&[record(3, 2), record(4, 0), record(9, 4)]), None);
        let begins_late = Some(Cut::BeginsLate { tick: 3 });
        assert_eq!(cut(&[record(3, 1)]), begins_late);
        let gap = Some(Cut::Gap { first: 2, last: 4 });
        assert_eq!(cut(&[record(1, 0), record(7, 2)]), gap);
    }

    #[test]
    fn what_the_recorder_lost_is_a_gap_where_every_record_is_there_too() {
        let lost = EventKind::NotRecorded {
            count: 1,
            first: 2,
            last: 2,
        };
        let gap = Some(Cut::Gap { first: 2, last: 2 });
        assert_eq!(cut(&[record(1, 0), event(2, lost), record(2, 0)]), gap);
    }

    #[test]
    fn a_command_after_its_record_is_out_of_place() {
        let late = event(1, EventKind::CommandReceived(WANTED));
        let out_of_place = Some(Cut::CommandOutOfPlace { tick: 1 });
        assert_eq!(cut(&[record(1, 0), late]), out_of_place);
        let out_of_place = Some(Cut::CommandOutOfPlace { tick: 2 });
        let early = event(2, EventKind::CommandReceived(WANTED));
        assert_eq!(cut(&[early, record(1, 0)]), out_of_place);
        let next = event(3, EventKind::CommandReceived(WANTED));
        assert_eq!(cut(&[record(1, 0), early, next]), out_of_place);
    }

    #[test]
    fn commands_without_a_record_are_limited() {
        let mut commands = vec![event(1, EventKind::CommandReceived(WANTED)); MOST_COMMANDS];
        assert_eq!(cut(&commands), None);
        commands.push(event(1, EventKind::CommandReceived(WANTED)));
        assert_eq!(cut(&commands), Some(Cut::CommandOutOfPlace { tick: 1 }));
    }

    #[test]
    fn a_panic_in_a_tick_ends_it_and_one_after_the_last_does_not() {
        let panicked = Some(Cut::Panicked { tick: 2 });
        let panic = |tick| event(tick, EventKind::Panicked);
        assert_eq!(cut(&[record(1, 0), panic(2), record(2, 0)]), panicked);
        assert_eq!(cut(&[record(1, 0), panic(1)]), None);
    }
}

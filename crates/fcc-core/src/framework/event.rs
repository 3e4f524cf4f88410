//! What happened, when it happened.

use core::fmt;

use super::{
    ActuatorFault, Cause, Controller, Flags, LoopCommand, Readings, SensorFault, SourceChange,
    Stage, State, Time,
};
use crate::schema;

schema! {
    /// Something that happened once, unlike a record, of which there is one per
    /// tick; it comes before the record of its tick.
    ///
    /// `O` is a command to the controller.
    ///
    /// ```
    /// use fcc_core::framework::{Event, EventKind, Time};
    ///
    /// let event: Event<f64> = Event {
    ///     tick: 40,
    ///     time: Time::from_nanos(1_000_000_000),
    ///     kind: EventKind::StopRequested,
    /// };
    /// assert_eq!(event.kind, EventKind::StopRequested);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct Event<O> {
        /// The tick it happened in; before the first tick, 0.
        #[field(1)]
        pub tick: u64,
        /// That tick's wake-up, on the loop's clock.
        #[field(2)]
        pub time: Time,
        /// What happened.
        #[field(4)]
        pub kind: EventKind<O>,
    }
}

/// The event of a controller's loop.
///
/// ```
/// # use fcc_core::framework::{Controller, Flags, Tick};
/// # struct Heating;
/// # impl Controller for Heating {
/// #     type Measurements = f64;
/// #     type Estimate = ();
/// #     type Setpoints = f64;
/// #     type Outputs = f64;
/// #     type Command = f64;
/// #     fn estimate(&mut self, _: &Tick, _: &f64) {}
/// #     fn engage_inhibits(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn faults(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn flag_name(_: u32) -> &'static str { "the door is open" }
/// #     fn engage(&mut self, _: &Tick, _: &f64) {}
/// #     fn control(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn failsafe(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn setpoints(&self) -> f64 { 21.0 }
/// #     fn outputs_are_valid(&self, _: &f64) -> bool { true }
/// # }
/// use fcc_core::framework::{EventKind, EventOf, LoopCommand, Time};
///
/// let event: EventOf<Heating> = EventOf::<Heating> {
///     tick: 1,
///     time: Time::from_nanos(0),
///     // A thermostat's own commands are temperatures.
///     kind: EventKind::CommandReceived(LoopCommand::Controller(21.0)),
/// };
/// assert_eq!(event.tick, 1);
/// ```
pub type EventOf<C> = Event<<C as Controller>::Command>;

schema! {
    /// What can happen in a loop. Sensors and actuators are identified by their
    /// index in the loop, the first being 0.
    ///
    /// ```
    /// use fcc_core::framework::{EventKind, State};
    ///
    /// let taken_over: EventKind<f64> = EventKind::StateChanged {
    ///     from: State::Standby,
    ///     to: State::Engaged,
    /// };
    /// assert_ne!(taken_over, EventKind::StopRequested);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    #[non_exhaustive]
    pub enum EventKind<O> {
        /// The loop's state changed.
        #[field(10)]
        StateChanged {
            /// The state before.
            #[field(1)]
            from: State,
            /// The state now.
            #[field(2)]
            to: State,
        },
        /// A command was read, in the order of sending: from these and the
        /// measurements of its records a run can be replayed.
        #[field(11)]
        CommandReceived(command: LoopCommand<O>),
        /// The loop's stop flag was set, for example by a signal. This too
        /// comes from outside, and is needed to replay a run.
        #[field(23)]
        StopRequested,
        /// A request to engage was refused, and has to be repeated.
        #[field(12)]
        EngageRefused {
            /// The engage inhibits; empty if control was released in the same
            /// tick, or if as many consecutive ticks overran as lead to
            /// failsafe.
            #[field(1)]
            engage_inhibits: Flags,
        },
        /// A sensor has a fault, or another fault than before.
        #[field(13)]
        SensorFault {
            /// Which sensor.
            #[field(1)]
            index: u16,
            /// The fault.
            #[field(2)]
            fault: SensorFault,
        },
        /// A sensor has recovered from its fault.
        #[field(15)]
        SensorRecovered {
            /// Which sensor.
            #[field(1)]
            index: u16,
        },
        /// An actuator has a fault, or another fault than before.
        #[field(14)]
        ActuatorFault {
            /// Which actuator.
            #[field(1)]
            index: u16,
            /// The fault.
            #[field(2)]
            fault: ActuatorFault,
        },
        /// An actuator has recovered from its fault.
        #[field(16)]
        ActuatorRecovered {
            /// Which actuator.
            #[field(1)]
            index: u16,
        },
        /// Records were lost because the ring was full.
        #[field(17)]
        RecordsDropped {
            /// How many.
            #[field(1)]
            count: u64,
            /// The first lost tick.
            #[field(2)]
            first: u64,
            /// The last lost tick.
            #[field(3)]
            last: u64,
        },
        /// Events were lost because the ring was full.
        #[field(18)]
        EventsDropped {
            /// How many.
            #[field(1)]
            count: u64,
            /// The tick of the first.
            #[field(2)]
            first: u64,
            /// The tick of the last.
            #[field(3)]
            last: u64,
        },
        /// Messages that reached the recorder were not written to its file: the
        /// disk was too slow, or full.
        #[field(19)]
        NotRecorded {
            /// How many.
            #[field(1)]
            count: u64,
            /// The first lost tick.
            #[field(2)]
            first: u64,
            /// The last lost tick.
            #[field(3)]
            last: u64,
        },
        /// The actuators were released.
        #[field(20)]
        Released {
            /// Whether all of them succeeded. If not, the loop repeats the
            /// release.
            #[field(1)]
            ok: bool,
        },
        /// A component panicked; its message is in the loop's report.
        #[field(21)]
        Panicked,
        /// The timer failed; the reason is in the loop's report.
        #[field(22)]
        TimerFailed,
        /// Ticks begin to overrun. Reported once, however many follow:
        /// `OverrunsOver` gives their number.
        #[field(24)]
        Overrun {
            /// Whose budget was overrun; the timer's is one period.
            #[field(1)]
            of: Stage,
            /// How long it took, or how late the timer woke, ns.
            #[field(2)]
            took_ns: u64,
            /// The budget, ns.
            #[field(3)]
            budget_ns: u64,
            /// The stage that took longest in that tick.
            #[field(4)]
            longest: Stage,
        },
        /// No tick has overrun for a second.
        #[field(25)]
        OverrunsOver {
            /// How many ticks overran or were missed.
            #[field(1)]
            count: u64,
            /// The first of them.
            #[field(2)]
            first: u64,
            /// The last of them.
            #[field(3)]
            last: u64,
        },
        /// The loop hung, and its watchdog ended it: reported by the watchdog,
        /// after the last tick.
        #[field(26)]
        Hung {
            /// How long the loop had made no progress, ns.
            #[field(1)]
            silent_ns: u64,
        },
        /// Readings are taken from another sensor than before: the previous
        /// one's became too old, or a preferred one returned.
        #[field(27)]
        SourceChanged(change: SourceChange),
    }
}

impl<O: Copy> EventKind<O> {
    /// The event as text for users, with its conditions and commands named by
    /// the controller.
    pub const fn description<C: Controller<Command = O>>(&self) -> EventDescription<C> {
        EventDescription { kind: *self }
    }
}

/// An event as text for users; see [`EventKind::description`].
///
/// ```
/// # use fcc_core::framework::{Controller, Flags, Tick};
/// # struct Heating;
/// # impl Controller for Heating {
/// #     type Measurements = f64;
/// #     type Estimate = ();
/// #     type Setpoints = f64;
/// #     type Outputs = f64;
/// #     type Command = f64;
/// #     fn estimate(&mut self, _: &Tick, _: &f64) {}
/// #     fn engage_inhibits(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn faults(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn flag_name(_: u32) -> &'static str { "the door is open" }
/// #     fn engage(&mut self, _: &Tick, _: &f64) {}
/// #     fn control(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn failsafe(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn setpoints(&self) -> f64 { 21.0 }
/// #     fn outputs_are_valid(&self, _: &f64) -> bool { true }
/// # }
/// use fcc_core::framework::EventKind;
///
/// let refused: EventKind<f64> = EventKind::EngageRefused { engage_inhibits: Flags::bit(0) };
/// assert!(refused.description::<Heating>().to_string().ends_with("the door is open"));
/// ```
pub struct EventDescription<C: Controller> {
    kind: EventKind<C::Command>,
}

impl<C: Controller> fmt::Display for EventDescription<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            EventKind::StateChanged { from, to } => state_change::<C>(f, from, to),
            EventKind::CommandReceived(LoopCommand::Engage) => f.write_str("command: engage"),
            EventKind::CommandReceived(LoopCommand::Disengage) => f.write_str("command: disengage"),
            EventKind::CommandReceived(LoopCommand::Stop) => f.write_str("command: stop"),
            EventKind::CommandReceived(LoopCommand::Controller(command)) => {
                f.write_str("command: ")?;
                C::write_command(&command, f)
            }
            EventKind::StopRequested => f.write_str("stop requested"),
            EventKind::EngageRefused { engage_inhibits } if engage_inhibits.is_empty() => {
                f.write_str("not engaged: control was released at the same time, or ticks overrun")
            }
            EventKind::EngageRefused { engage_inhibits } => {
                f.write_str("not engaged: ")?;
                name_flags::<C>(f, engage_inhibits)
            }
            EventKind::SensorFault { index, fault } => write!(f, "sensor {index}: {fault}"),
            EventKind::SensorRecovered { index } => write!(f, "sensor {index} works again"),
            EventKind::ActuatorFault { index, fault } => write!(f, "actuator {index}: {fault}"),
            EventKind::ActuatorRecovered { index } => write!(f, "actuator {index} works again"),
            EventKind::RecordsDropped { count, first, last } => {
                write!(
                    f,
                    "{count} records lost, ticks {first} to {last}: they were not read in time"
                )
            }
            EventKind::EventsDropped { count, first, last } => {
                write!(
                    f,
                    "{count} events lost, ticks {first} to {last}: they were not read in time"
                )
            }
            EventKind::NotRecorded { count, first, last } => {
                write!(
                    f,
                    "{count} messages not recorded, ticks {first} to {last}: \
                     the disk was too slow or full"
                )
            }
            EventKind::Released { ok: true } => f.write_str("actuators released"),
            EventKind::Released { ok: false } => {
                f.write_str("an actuator did not release: control may still be held")
            }
            EventKind::Panicked => f.write_str("a part of the loop panicked"),
            EventKind::TimerFailed => f.write_str("the timer failed"),
            EventKind::Overrun {
                of: Stage::Timer,
                took_ns,
                budget_ns,
                ..
            } => write!(
                f,
                "the timer woke {:.1} ms late: periods of {:.1} ms were missed",
                ms(took_ns),
                ms(budget_ns)
            ),
            EventKind::Overrun {
                of,
                took_ns,
                budget_ns,
                longest,
            } => {
                write!(
                    f,
                    "{of} overran its budget: {:.3} ms of {:.3} ms",
                    ms(took_ns),
                    ms(budget_ns)
                )?;
                if of == Stage::Tick {
                    write!(f, ", most of it in {longest}")?;
                }
                Ok(())
            }
            EventKind::OverrunsOver { count, first, last } => write!(
                f,
                "{count} ticks overran or were missed, between {first} and {last}; none for a second"
            ),
            EventKind::Hung { silent_ns } => write!(
                f,
                "the loop hung: no progress for {:.1} s",
                ms(silent_ns) * 1e-3
            ),
            EventKind::SourceChanged(SourceChange { readings, from, to }) => {
                for (n, bit) in readings.iter().enumerate() {
                    let separator = if n > 0 { ", " } else { "" };
                    let name = C::Measurements::NAMES.get(bit as usize);
                    write!(f, "{separator}{}", name.unwrap_or(&"a reading"))?;
                }
                write!(f, ": from sensor {to} instead of {from}")
            }
        }
    }
}

/// A change of state with the cause of a failsafe.
fn state_change<C: Controller>(f: &mut fmt::Formatter<'_>, from: State, to: State) -> fmt::Result {
    write!(f, "{from} -> {to}")?;
    match to {
        State::Failsafe(Cause::Faults(flags)) => {
            f.write_str(": ")?;
            name_flags::<C>(f, flags)
        }
        State::Failsafe(Cause::InvalidOutput) => f.write_str(": invalid output"),
        State::Failsafe(Cause::Overrun) => {
            f.write_str(": too many ticks in a row overran their budget")
        }
        _ => Ok(()),
    }
}

fn ms(ns: u64) -> f64 {
    ns as f64 * 1e-6
}

fn name_flags<C: Controller>(f: &mut fmt::Formatter<'_>, flags: Flags) -> fmt::Result {
    for (n, bit) in flags.iter().enumerate() {
        if n > 0 {
            f.write_str(", ")?;
        }
        f.write_str(C::flag_name(bit))?;
    }
    Ok(())
}

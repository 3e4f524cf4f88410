//! Events of a loop.

use super::{
    ActuatorFault, Controller, Flags, LoopCommand, Notice, SensorFault, SourceChange, Stage, State,
    Time,
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
/// # mod heating {
/// #     include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/heating.rs"));
/// # }
/// # use heating::Heating;
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
        /// The controller's mode changed: [`Controller::mode_name`] names them.
        #[field(28)]
        ModeChanged {
            /// The mode before.
            #[field(1)]
            from: u8,
            /// The mode now.
            #[field(2)]
            to: u8,
        },
        /// The controller noticed something:
        /// [`Controller::write_notice`] describes it.
        #[field(29)]
        Noticed(notice: Notice),
        /// Control is given back at once, without a failsafe.
        #[field(30)]
        ReleasedAtOnce {
            /// Why: [`Controller::must_release`] or
            /// [`Controller::is_taken_over`].
            #[field(1)]
            conditions: Flags,
        },
        /// [`Controller::conditions`] began or ended while control is held:
        /// [`Controller::flag_name`] names them.
        #[field(31)]
        ConditionsChanged {
            /// Those that began.
            #[field(1)]
            began: Flags,
            /// Those that ended.
            #[field(2)]
            ended: Flags,
        },
        /// The engage switch was switched on while none of its readings
        /// arrived, and control is not taken: it must go off and on again.
        #[field(32)]
        SwitchedOnUnseen,
        /// A command to engage was refused, because the engage switch is off.
        #[field(33)]
        EngageRefusedBySwitch,
        /// Ticks leave no time to sleep: from here on deadlines are skipped.
        #[field(34)]
        Overloaded {
            /// The time that a tick used, from its deadline to the next wait, ns.
            #[field(1)]
            used_ns: u64,
            /// A period, ns.
            #[field(2)]
            period_ns: u64,
        },
        /// For a second ticks have left time to sleep: no deadlines are skipped
        /// any more.
        #[field(35)]
        OverloadOver {
            /// How many ticks left none.
            #[field(1)]
            count: u64,
            /// The first of them.
            #[field(2)]
            first: u64,
            /// The last of them.
            #[field(3)]
            last: u64,
        },
        /// The loop stops because no tick has left time to sleep for too long. A
        /// replay stops by it.
        #[field(36)]
        StoppedByOverload,
    }
}

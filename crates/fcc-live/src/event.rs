//! Events in shared memory, as numbers and as text.

use fcc_core::framework::{self, EventKind, LoopCommand, StateCode};
use fcc_core::schema;
use serde::{Deserialize, Serialize};

use super::Text;

/// An event, as numbers for programs and as text for users.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[repr(C)]
pub struct Event {
    /// The tick it happened in.
    pub tick: u64,
    /// That tick's wake-up, ns on the loop's clock; the smallest number before
    /// the first tick.
    pub time_ns: i64,
    /// The kind of event: see [`EventCode`].
    pub code: u32,
    /// The index of the sensor or actuator, from 0.
    pub index: u32,
    /// Their meaning depends on the code.
    pub values: [u64; 3],
    /// As text; what is longer is cut off.
    pub text: Text<976>,
}

schema! {
    /// The kind of event; in brackets the meaning of [`Event::values`].
    pub enum EventCode {
        /// Not an event of the loop.
        Remark = 0,
        /// The loop's state changed (phase before, phase now, faults that led to
        /// failsafe). Phases: 0 standby, 1 engaged, 2 failsafe, 3 stopped.
        StateChanged = 1,
        /// A command was read (0 engage, 1 disengage, 2 stop, 3 for the controller).
        CommandReceived = 2,
        /// Engaging was refused (the engage inhibits).
        EngageRefused = 3,
        /// A sensor failed.
        SensorFault = 4,
        /// A sensor works again.
        SensorRecovered = 5,
        /// An actuator failed.
        ActuatorFault = 6,
        /// An actuator works again.
        ActuatorRecovered = 7,
        /// Records were lost because they were not fetched in time (count, first
        /// and last tick).
        RecordsDropped = 8,
        /// Events were lost because they were not fetched in time (count, first and
        /// last tick).
        EventsDropped = 9,
        /// Records are not in the recording (count, first and last tick).
        NotRecorded = 10,
        /// The actuators were released (1 if all succeeded).
        Released = 11,
        /// A part of the loop panicked.
        Panicked = 12,
        /// The timer failed.
        TimerFailed = 13,
        /// Ticks begin to overrun (duration, budget, the stage that took longest);
        /// the index is the stage whose budget was exceeded. Stages: 0 the timer, 1
        /// sensors, 2 estimate, 3 guide, 4 control, 5 actuators, 6 the whole tick.
        Overrun = 14,
        /// No tick has overrun for a second (count, first and last tick).
        OverrunsOver = 15,
        /// The loop hung (time without progress).
        Hung = 16,
        /// Readings are taken from another sensor than before (which, one bit each;
        /// the sensor before); the index is the sensor now.
        SourceChanged = 17,
        /// The controller's mode changed (mode before, mode now, as the column
        /// `desired_guidance_mode` numbers them).
        ModeChanged = 18,
        /// Conditions that the controller reports while control is held changed
        /// (those that began, those that ended).
        ConditionsChanged = 19,
        /// The controller noticed something (how long it lasted, ns; how large it was,
        /// in thousandths; which one of several); the index is which.
        Noticed = 20,
        /// Control is given back at once (why, one bit each, as in the flags of a
        /// state).
        ReleasedAtOnce = 21,
        /// The engage switch was switched on while none of its readings arrived,
        /// and control is not taken.
        SwitchedOnUnseen = 22,
        /// A command to engage was refused, because the engage switch is off.
        EngageRefusedBySwitch = 23,
        /// Ticks leave no time to sleep, and deadlines are skipped (time used by a
        /// tick, period).
        Overloaded = 24,
        /// For a second ticks have left time (how many did not, first and last tick).
        OverloadOver = 25,
        /// The loop stops, overloaded for too long.
        StoppedByOverload = 26,
    }
}

impl Event {
    /// From an event of the loop and its text.
    pub fn new<O: Copy>(event: &framework::Event<O>, text: &str) -> Self {
        let (code, index, values) = numbers(event);
        Self {
            tick: event.tick,
            time_ns: event.time.as_nanos(),
            code: code as u32,
            index,
            values,
            text: Text::new(text),
        }
    }

    /// A remark at one of the loop's ticks: not an event of the loop.
    pub fn remark(tick: u64, time_ns: i64, text: &str) -> Self {
        Self {
            tick,
            time_ns,
            text: Text::new(text),
            ..Self::default()
        }
    }
}

fn numbers<O: Copy>(event: &framework::Event<O>) -> (EventCode, u32, [u64; 3]) {
    const NONE: [u64; 3] = [0; 3];
    match event.kind {
        EventKind::StateChanged { from, to } => {
            let (from, to) = (StateCode::from(from), StateCode::from(to));
            let values = [from.phase().into(), to.phase().into(), to.flags().bits()];
            (EventCode::StateChanged, 0, values)
        }
        EventKind::CommandReceived(command) => {
            let which = match command {
                LoopCommand::Engage => 0,
                LoopCommand::Disengage => 1,
                LoopCommand::Stop => 2,
                LoopCommand::Controller(_) => 3,
            };
            (EventCode::CommandReceived, 0, [which, 0, 0])
        }
        EventKind::EngageRefused { engage_inhibits } => {
            (EventCode::EngageRefused, 0, [engage_inhibits.bits(), 0, 0])
        }
        EventKind::SensorFault { index, .. } => (EventCode::SensorFault, index.into(), NONE),
        EventKind::SensorRecovered { index } => (EventCode::SensorRecovered, index.into(), NONE),
        EventKind::ActuatorFault { index, .. } => (EventCode::ActuatorFault, index.into(), NONE),
        EventKind::ActuatorRecovered { index } => {
            (EventCode::ActuatorRecovered, index.into(), NONE)
        }
        EventKind::RecordsDropped { count, first, last } => {
            (EventCode::RecordsDropped, 0, [count, first, last])
        }
        EventKind::EventsDropped { count, first, last } => {
            (EventCode::EventsDropped, 0, [count, first, last])
        }
        EventKind::NotRecorded { count, first, last } => {
            (EventCode::NotRecorded, 0, [count, first, last])
        }
        EventKind::Released { ok } => (EventCode::Released, 0, [ok.into(), 0, 0]),
        EventKind::Panicked => (EventCode::Panicked, 0, NONE),
        EventKind::TimerFailed => (EventCode::TimerFailed, 0, NONE),
        EventKind::Overrun {
            of,
            took_ns,
            budget_ns,
            longest,
        } => {
            let values = [took_ns, budget_ns, longest as u64];
            (EventCode::Overrun, of as u32, values)
        }
        EventKind::OverrunsOver { count, first, last } => {
            (EventCode::OverrunsOver, 0, [count, first, last])
        }
        EventKind::Hung { silent_ns } => (EventCode::Hung, 0, [silent_ns, 0, 0]),
        EventKind::SourceChanged(change) => {
            let values = [change.readings.bits(), change.from.into(), 0];
            (EventCode::SourceChanged, change.to.into(), values)
        }
        EventKind::ModeChanged { from, to } => {
            (EventCode::ModeChanged, 0, [from.into(), to.into(), 0])
        }
        EventKind::ConditionsChanged { began, ended } => {
            let values = [began.bits(), ended.bits(), 0];
            (EventCode::ConditionsChanged, 0, values)
        }
        EventKind::Noticed(notice) => (
            EventCode::Noticed,
            notice.kind.into(),
            [
                notice.lasted_ns,
                notice.amount_permille.into(),
                notice.item.into(),
            ],
        ),
        EventKind::ReleasedAtOnce { conditions } => {
            (EventCode::ReleasedAtOnce, 0, [conditions.bits(), 0, 0])
        }
        EventKind::SwitchedOnUnseen => (EventCode::SwitchedOnUnseen, 0, NONE),
        EventKind::Overloaded { used_ns, period_ns } => {
            (EventCode::Overloaded, 0, [used_ns, period_ns, 0])
        }
        EventKind::OverloadOver { count, first, last } => {
            (EventCode::OverloadOver, 0, [count, first, last])
        }
        EventKind::StoppedByOverload => (EventCode::StoppedByOverload, 0, NONE),
        EventKind::EngageRefusedBySwitch => (EventCode::EngageRefusedBySwitch, 0, NONE),
        // An event without a number in this version still has its text.
        _ => (EventCode::Remark, 0, NONE),
    }
}

//! What happened, when it happened.

use std::fmt;
use std::marker::PhantomData;

use fcc_core::framework::{ActuatorFault, Cause, Controller, Flags, SensorFault, State, Time};

/// Something that happened once, unlike a [`Record`](crate::Record), of which
/// there is one per tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Event {
    /// The tick it happened in; before the first tick, 0.
    pub tick: u64,
    /// That tick's wake-up, on the loop's clock.
    pub time: Time,
    /// What it was.
    pub kind: EventKind,
}

/// What can happen in a loop. Sensors and actuators go by their place in
/// [`Parts`](crate::Parts), the first being 0.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum EventKind {
    /// The loop's state changed.
    StateChanged {
        /// The state before.
        from: State,
        /// The state now.
        to: State,
    },
    /// Somebody wanted to engage, and must ask again.
    EngageRefused {
        /// Why; empty if control was let go in the same tick.
        blockers: Flags,
    },
    /// A sensor went wrong, or goes wrong in another way than before.
    SensorFault {
        /// Which sensor.
        index: u16,
        /// What goes wrong.
        fault: SensorFault,
    },
    /// A sensor that went wrong works again.
    SensorRecovered {
        /// Which sensor.
        index: u16,
    },
    /// An actuator went wrong, or goes wrong in another way than before.
    ActuatorFault {
        /// Which actuator.
        index: u16,
        /// What goes wrong.
        fault: ActuatorFault,
    },
    /// An actuator that went wrong works again.
    ActuatorRecovered {
        /// Which actuator.
        index: u16,
    },
    /// Records that found no room in the ring are lost.
    RecordsDropped {
        /// How many.
        count: u64,
        /// The first lost tick.
        first: u64,
        /// The last lost tick.
        last: u64,
    },
    /// Events that found no room are lost.
    EventsDropped {
        /// How many.
        count: u64,
        /// The tick of the first.
        first: u64,
        /// The tick of the last.
        last: u64,
    },
    /// The actuators were told to give control back.
    Released {
        /// Whether all of them did. If not, the loop asks again.
        ok: bool,
    },
    /// A part panicked; its words are in the loop's report.
    Panicked,
    /// The timer failed; why is in the loop's report.
    TimerFailed,
}

impl EventKind {
    /// The event in words for people, its conditions named by the controller.
    pub fn words<C: Controller>(&self) -> EventWords<C> {
        EventWords {
            kind: *self,
            controller: PhantomData,
        }
    }
}

/// An event in words for people; see [`EventKind::words`].
pub struct EventWords<C> {
    kind: EventKind,
    controller: PhantomData<fn() -> C>,
}

impl<C: Controller> fmt::Display for EventWords<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            EventKind::StateChanged { from, to } => {
                write!(f, "{from} -> {to}")?;
                match to {
                    State::Failsafe(Cause::Faults(flags)) => {
                        f.write_str(": ")?;
                        name_flags::<C>(f, flags)
                    }
                    State::Failsafe(Cause::InvalidOutput) => f.write_str(": invalid output"),
                    _ => Ok(()),
                }
            }
            EventKind::EngageRefused { blockers } if blockers.is_empty() => {
                f.write_str("not engaged: control was let go at the same time")
            }
            EventKind::EngageRefused { blockers } => {
                f.write_str("not engaged: ")?;
                name_flags::<C>(f, blockers)
            }
            EventKind::SensorFault { index, fault } => write!(f, "sensor {index}: {fault}"),
            EventKind::SensorRecovered { index } => write!(f, "sensor {index} works again"),
            EventKind::ActuatorFault { index, fault } => write!(f, "actuator {index}: {fault}"),
            EventKind::ActuatorRecovered { index } => write!(f, "actuator {index} works again"),
            EventKind::RecordsDropped { count, first, last } => {
                write!(
                    f,
                    "{count} records lost, ticks {first} to {last}: nobody fetched them in time"
                )
            }
            EventKind::EventsDropped { count, first, last } => {
                write!(
                    f,
                    "{count} events lost, ticks {first} to {last}: nobody fetched them in time"
                )
            }
            EventKind::Released { ok: true } => f.write_str("actuators released"),
            EventKind::Released { ok: false } => {
                f.write_str("an actuator did not release: control may still be held")
            }
            EventKind::Panicked => f.write_str("a part of the loop panicked"),
            EventKind::TimerFailed => f.write_str("the timer failed"),
        }
    }
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

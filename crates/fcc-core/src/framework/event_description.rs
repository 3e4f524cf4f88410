//! Events as text for users.

use core::fmt;

use super::{
    Cause, Controller, EventKind, Flags, LoopCommand, Readings, SourceChange, Stage, State,
};

/// Without a condition of the controller.
const NOT_ENGAGED: &str = "not engaged: control was released at the same time, ticks overrun, or \
                           an actuator is not ready";

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
/// # mod heating {
/// #     include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/heating.rs"));
/// # }
/// # use heating::Heating;
/// use fcc_core::framework::{EventKind, Flags};
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
                f.write_str(NOT_ENGAGED)
            }
            EventKind::EngageRefused { engage_inhibits } => {
                f.write_str("not engaged: ")?;
                name_flags::<C>(f, engage_inhibits)
            }
            EventKind::SensorFault { index, fault } => write!(f, "sensor {index}: {fault}"),
            EventKind::SensorRecovered { index } => write!(f, "sensor {index} works again"),
            EventKind::ActuatorFault { index, fault } => write!(f, "actuator {index}: {fault}"),
            EventKind::ActuatorRecovered { index } => write!(f, "actuator {index} works again"),
            EventKind::RecordsDropped { count, first, last } => write!(
                f,
                "{count} records lost, ticks {first} to {last}: they were not read in time"
            ),
            EventKind::EventsDropped { count, first, last } => write!(
                f,
                "{count} events lost, ticks {first} to {last}: they were not read in time"
            ),
            EventKind::NotRecorded { count, first, last } => write!(
                f,
                "{count} messages not recorded, ticks {first} to {last}: the disk was too slow \
                 or full, or the recording was damaged"
            ),
            EventKind::Released { ok: true } => f.write_str("release sent to the actuators"),
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
            } => late_timer(f, took_ns, budget_ns),
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
            EventKind::OverrunsOver { count, last, .. } => overruns_over(f, count, last),
            EventKind::Hung { silent_ns } => write!(
                f,
                "the loop hung: no progress for {:.1} s",
                ms(silent_ns) * 1e-3
            ),
            EventKind::ModeChanged { from, to } => {
                write!(f, "mode: {}, was {}", C::mode_name(to), C::mode_name(from))
            }
            EventKind::Noticed(notice) => C::write_notice(&notice, f),
            EventKind::ReleasedAtOnce { conditions } => {
                f.write_str("control is given back at once: ")?;
                name_flags::<C>(f, conditions)
            }
            EventKind::SwitchedOnUnseen => f.write_str(
                "not engaged: the engage switch was switched on while nothing arrived from it; \
                 switch it off and on again",
            ),
            EventKind::Overloaded { used_ns, period_ns } => overload(f, used_ns, period_ns),
            EventKind::OverloadOver { count, last, .. } => write!(
                f,
                "overload over: {count} ticks left no time to sleep, the last was {last}"
            ),
            EventKind::StoppedByOverload => f.write_str("overloaded for too long: the loop stops"),
            EventKind::EngageRefusedBySwitch => f.write_str(REFUSED_BY_SWITCH),
            EventKind::ConditionsChanged { began, ended } => condition_change::<C>(f, began, ended),
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

const REFUSED_BY_SWITCH: &str = "not engaged by the command: the engage switch is off; switch \
                                 it on, or configure command_needs_switch = false";

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

/// The periods missed from the first deadline that was, to the tick after it.
fn overload(f: &mut fmt::Formatter<'_>, used_ns: u64, period_ns: u64) -> fmt::Result {
    write!(
        f,
        "overload: a tick took {:.3} ms of {:.3} ms, and none leaves time to sleep: deadlines \
         are skipped",
        ms(used_ns),
        ms(period_ns)
    )
}

fn late_timer(f: &mut fmt::Formatter<'_>, late_ns: u64, period_ns: u64) -> fmt::Result {
    let missed = late_ns.checked_div(period_ns).unwrap_or_default();
    let (periods, were) = if missed == 1 {
        ("period", "was")
    } else {
        ("periods", "were")
    };
    write!(
        f,
        "the timer woke {:.1} ms late: {missed} {periods} of {:.1} ms {were} missed",
        ms(late_ns),
        ms(period_ns)
    )
}

fn overruns_over(f: &mut fmt::Formatter<'_>, count: u64, last: u64) -> fmt::Result {
    let ticks = if count == 1 {
        "tick overran or was"
    } else {
        "ticks overran or were"
    };
    write!(
        f,
        "{count} {ticks} missed up to tick {last}; none for a second"
    )
}

/// The conditions that began, then those that ended.
fn condition_change<C: Controller>(
    f: &mut fmt::Formatter<'_>,
    began: Flags,
    ended: Flags,
) -> fmt::Result {
    let mut separator = "";
    for (word, flags) in [("now", began), ("no longer", ended)] {
        if !flags.is_empty() {
            write!(f, "{separator}{word}: ")?;
            name_flags::<C>(f, flags)?;
            separator = "; ";
        }
    }
    Ok(())
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

//! The log of a recording, as Foxglove displays it.

use fcc_core::framework::{Event, EventKind, State};
use prost_types::Timestamp;

use super::utc::SECOND_NS;
use super::wire::{Log, log};

pub(super) fn timestamp(unix_ns: u64) -> Timestamp {
    Timestamp {
        seconds: (unix_ns / SECOND_NS) as i64,
        nanos: (unix_ns % SECOND_NS) as i32,
    }
}

/// The source of a log line about an event of the loop.
pub(super) const EVENT: &str = "fccd";
/// The source of any other log line.
pub(super) const REMARK: &str = "fccd.remark";

/// A line of the log.
pub(super) fn line(name: &str, text: String, level: log::Level, unix_ns: u64) -> Log {
    Log {
        timestamp: Some(timestamp(unix_ns)),
        level: level.into(),
        message: text,
        name: name.to_owned(),
    }
}

/// The severity of an event.
pub(super) fn level<O>(event: &Event<O>) -> log::Level {
    match event.kind {
        EventKind::StateChanged {
            to: State::Failsafe(_),
            ..
        }
        | EventKind::Released { ok: false }
        | EventKind::TimerFailed
        | EventKind::StoppedByOverload => log::Level::Error,
        EventKind::Panicked | EventKind::Hung { .. } => log::Level::Fatal,
        EventKind::EngageRefused { .. }
        | EventKind::EngageRefusedBySwitch
        | EventKind::SensorFault { .. }
        | EventKind::ActuatorFault { .. }
        | EventKind::RecordsDropped { .. }
        | EventKind::EventsDropped { .. }
        | EventKind::NotRecorded { .. }
        | EventKind::Overrun { .. }
        | EventKind::Overloaded { .. } => log::Level::Warning,
        _ => log::Level::Info,
    }
}

//! Events.

use fcc_core::framework::{Controller, Event, EventKind, EventOf, Time};
use fcc_telemetry::describe_event;
use pyo3::prelude::*;

/// An event: the number of its tick, the time of that tick in s and in ns on
/// the loop's clock (0 and None before the first tick), its kind, and a
/// description.
#[pyclass(name = "Event", module = "fcc", frozen, get_all)]
#[derive(Clone)]
pub struct PyEvent {
    pub(crate) tick: u64,
    pub(crate) time_s: f64,
    pub(crate) time_ns: Option<i64>,
    pub(crate) kind: &'static str,
    pub(crate) text: String,
}

#[pymethods]
impl PyEvent {
    fn __repr__(&self) -> String {
        format!(
            "Event(tick={}, kind={:?}, text={:?})",
            self.tick, self.kind, self.text
        )
    }

    fn __str__(&self) -> &str {
        &self.text
    }
}

impl PyEvent {
    /// An event, described with the names of its sensors and actuators.
    pub(crate) fn of<C: Controller>(
        event: &EventOf<C>,
        sensors: &[String],
        actuators: &[String],
    ) -> Self {
        Self::described(event, describe_event::<C>(event, sensors, actuators))
    }

    /// An event with its description.
    pub(crate) fn described<O>(event: &Event<O>, text: String) -> Self {
        Self {
            tick: event.tick,
            time_s: seconds(event.time),
            time_ns: (!event.time.is_never()).then(|| event.time.as_nanos()),
            kind: kind_of(&event.kind),
            text,
        }
    }
}

/// A time in s on the loop's clock; 0 for never.
pub fn seconds(time: Time) -> f64 {
    time.as_nanos().max(0) as f64 * 1e-9
}

fn kind_of<T>(kind: &EventKind<T>) -> &'static str {
    match kind {
        EventKind::StateChanged { .. } => "state-changed",
        EventKind::CommandReceived(_) => "command-received",
        EventKind::StopRequested => "stop-requested",
        EventKind::EngageRefused { .. } => "engage-refused",
        EventKind::SensorFault { .. } => "sensor-fault",
        EventKind::SensorRecovered { .. } => "sensor-recovered",
        EventKind::ActuatorFault { .. } => "actuator-fault",
        EventKind::ActuatorRecovered { .. } => "actuator-recovered",
        EventKind::RecordsDropped { .. } => "records-dropped",
        EventKind::EventsDropped { .. } => "events-dropped",
        EventKind::NotRecorded { .. } => "not-recorded",
        EventKind::Released { .. } => "released",
        EventKind::Panicked => "panicked",
        EventKind::TimerFailed => "timer-failed",
        EventKind::Overrun { .. } => "overrun",
        EventKind::OverrunsOver { .. } => "overruns-over",
        EventKind::Hung { .. } => "hung",
        EventKind::SourceChanged(_) => "source-changed",
        EventKind::ModeChanged { .. } => "mode-changed",
        EventKind::Noticed(_) => "noticed",
        EventKind::ReleasedAtOnce { .. } => "released-at-once",
        EventKind::SwitchedOnUnseen => "switched-on-unseen",
        EventKind::EngageRefusedBySwitch => "engage-refused-by-switch",
        EventKind::ConditionsChanged { .. } => "conditions-changed",
        EventKind::Overloaded { .. } => "overloaded",
        EventKind::OverloadOver { .. } => "overload-over",
        EventKind::StoppedByOverload => "stopped-by-overload",
        _ => "other",
    }
}

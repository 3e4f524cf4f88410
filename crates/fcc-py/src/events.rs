//! Events.

use std::fmt::Debug;

use fcc_core::framework::{Controller, Event, EventOf, Time};
use fcc_telemetry::describe_event;
use pyo3::prelude::*;

use crate::values::code;

/// An event: the number of its tick, the time of that tick in s and in ns on
/// the loop's clock (0 and None before the first tick), its kind, and a
/// description.
///
/// >>> fcc.fly(seconds=1.0).events[0].text
/// 'standby -> engaged'
#[pyclass(name = "Event", module = "fcc", frozen, get_all)]
#[derive(Clone)]
pub struct PyEvent {
    pub(crate) tick: u64,
    pub(crate) time_s: f64,
    pub(crate) time_ns: Option<i64>,
    pub(crate) kind: String,
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
    pub(crate) fn described<O: Debug>(event: &Event<O>, text: String) -> Self {
        Self {
            tick: event.tick,
            time_s: seconds(event.time),
            time_ns: (!event.time.is_never()).then(|| event.time.as_nanos()),
            kind: kind_name(&event.kind),
            text,
        }
    }
}

/// A time in s on the loop's clock; 0 for never.
pub fn seconds(time: Time) -> f64 {
    time.as_nanos().max(0) as f64 * 1e-9
}

/// The name of a kind of event: `StateChanged { .. }` as `state-changed`.
pub(crate) fn kind_name(kind: &impl Debug) -> String {
    let shown = format!("{kind:?}");
    let variant = shown.split(|letter: char| !letter.is_alphanumeric()).next();
    code(variant.unwrap_or_default())
}

//! The conformance suites for the sensors and the actuator of loops whose plant
//! or callback is in Python. A test runner of Rust has no interpreter: `pytest`
//! runs them, in a module that is built with the feature `conformance`.
#![expect(
    clippy::unwrap_used,
    reason = "for tests only: a bench that cannot be made is a failed test"
)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_conformance::{
    ActuatorBench, SensorBench, VanishingSource, actuator_conformance, flight_times,
    sensor_conformance,
};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Time};
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyTuple};
use rtrb::Producer;

use crate::callbacks::{CallbackSensor, Raised};
use crate::machine::{HeldFlag, QueuedSensor};
use crate::values::{PyMeasurements, Values as _, from_row};

/// Requirements that a callback in Python cannot meet: it makes objects of
/// Python, and waits for the interpreter's lock. `fly` warns that a flight with
/// one is not real time.
const NOT_BY_CALLBACKS: [&str; 3] = [
    "sampling_never_waits",
    "sampling_allocates_nothing",
    "sampling_what_vanished_never_waits_nor_allocates",
];

/// The requirements by their names: each a function that raises an exception if
/// it is not met.
#[pyfunction]
#[pyo3(name = "_conformance")]
pub(crate) fn conformance(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let callback = sensor_conformance!(list: PlantInPython<true>, vanishes);
    let queued = sensor_conformance!(list: PlantInPython<false>, vanishes);
    let held = actuator_conformance!(list: Held);
    let callback = callback
        .iter()
        .filter(|(name, _)| !NOT_BY_CALLBACKS.contains(name))
        .map(|requirement| ("CallbackSensor", requirement));
    let queued = queued.iter().map(|of| ("QueuedSensor", of));
    let held = held.iter().map(|of| ("HeldFlag", of));
    let all = PyDict::new(py);
    for (of, &(name, requirement)) in callback.chain(queued).chain(held) {
        let run = move |given: &Bound<'_, PyTuple>, _: Option<&Bound<'_, PyDict>>| {
            // It takes the lock itself, in whichever thread it samples.
            given.py().detach(requirement);
        };
        let run = PyCFunction::new_closure(py, None, None, run)?;
        all.set_item(format!("{of}::{name}"), run)?;
    }
    Ok(all)
}

/// A plant in Python, which gives one sample for a tick; with a callback between.
struct PlantInPython<const CALLBACK: bool> {
    samples: Producer<Measurements>,
    sensor: Box<dyn Sensor<Measurements>>,
    is_there: bool,
    number: u32,
}

impl<const CALLBACK: bool> SensorBench for PlantInPython<CALLBACK> {
    type Measurements = Measurements;

    fn new() -> Self {
        let (samples, sensor) = QueuedSensor::new();
        let mut sensor: Box<dyn Sensor<Measurements>> = Box::new(sensor);
        if CALLBACK {
            let call = Python::attach(|py| {
                let call = py.eval(c"lambda time_s, measured: measured", None, None);
                call.map(Bound::unbind)
            });
            sensor = CallbackSensor::boxed(sensor, call.unwrap(), &Raised::default());
        }
        Self {
            samples,
            sensor,
            is_there: true,
            number: 0,
        }
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut *self.sensor
    }

    fn provide(&mut self) {
        if self.is_there {
            self.number += 1;
            // More numbers than there are.
            let measured: PyMeasurements = from_row(&[f64::from(self.number); 64]);
            // There is no room while the last one was not sampled.
            let _ = self.samples.push(measured.sample(|_| false));
        }
    }

    /// Without readback, engage switch and plant.
    fn taken(measured: &Measurements) -> Vec<Time> {
        flight_times(measured).into_iter().take(9).collect()
    }
}

impl<const CALLBACK: bool> VanishingSource for PlantInPython<CALLBACK> {
    fn vanish(&mut self) {
        self.is_there = false;
    }

    fn come_back(&mut self) {
        self.is_there = true;
    }
}

/// The actuator of a plant in Python, which takes its outputs from the record.
struct Held {
    flag: Arc<AtomicBool>,
    actuator: HeldFlag,
}

impl ActuatorBench for Held {
    type Outputs = Surfaces;

    fn new() -> Self {
        let (flag, actuator) = HeldFlag::new();
        Self { flag, actuator }
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        &mut self.actuator
    }

    fn outputs(number: u32) -> Surfaces {
        Surfaces {
            throttle: f64::from(number % 10 + 1) * 0.1,
            ..Surfaces::default()
        }
    }

    fn is_held(&mut self) -> bool {
        self.flag.load(Ordering::Relaxed)
    }

    fn follows(&mut self, _: &Surfaces) -> bool {
        self.is_held()
    }
}

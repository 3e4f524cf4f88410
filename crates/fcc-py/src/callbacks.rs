//! A sensor or a controller written in Python, as a guest in the loop: for
//! experiments, never in real time.

use std::sync::{Arc, Mutex, PoisonError};

use fcc_core::flight::navigation::Estimate;
use fcc_core::flight::{Autopilot, AutopilotCommand, Measurements, Setpoints, Surfaces};
use fcc_core::framework::{Controller, Flags, Reading, Sensor, SensorFault, Switch, Tick};
use pyo3::prelude::*;

use crate::values::{PyMeasurements, PySetpoints, PySurfaces, Values as _};

/// The first exception that a guest raised.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn keep(&self, error: PyErr) {
        self.lock().get_or_insert(error);
    }

    /// The exception, if there was one.
    pub(crate) fn take(&self) -> Option<PyErr> {
        self.lock().take()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<PyErr>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A sensor whose measurements go through Python: a callback is called with the
/// plant's time and what was measured, and gives other measurements or None.
pub(crate) struct CallbackSensor {
    pub(crate) sensor: Box<dyn Sensor<Measurements>>,
    pub(crate) call: Py<PyAny>,
    pub(crate) raised: Raised,
}

impl Sensor<Measurements> for CallbackSensor {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        self.sensor.sample(tick, into)?;
        let measured = PyMeasurements::from_core(into);
        let said = Python::attach(|py| -> PyResult<Option<PyMeasurements>> {
            let said = self
                .call
                .bind(py)
                .call1((into.plant.value.time_s, measured))?;
            if said.is_none() {
                return Ok(None);
            }
            Ok(Some(*said.cast::<PyMeasurements>()?.borrow()))
        });
        match said {
            Ok(None) => Ok(()),
            Ok(Some(measured)) => {
                measured.write_over(into);
                Ok(())
            }
            Err(error) => {
                self.raised.keep(error);
                Err(SensorFault::Malformed)
            }
        }
    }

    fn name(&self) -> &'static str {
        self.sensor.name()
    }
}

/// A controller in Python beside the autopilot: navigation, guidance, states
/// and failsafe are the autopilot's, and its surfaces are a proposal.
pub(crate) struct CallbackController {
    pub(crate) autopilot: Autopilot,
    pub(crate) call: Py<PyAny>,
    pub(crate) raised: Raised,
}

/// What is no output: the loop never sends it.
const NO_OUTPUT: Surfaces = Surfaces {
    throttle: f64::NAN,
    elevator: f64::NAN,
    aileron: f64::NAN,
    rudder: f64::NAN,
};

impl Controller for CallbackController {
    type Measurements = Measurements;
    type Estimate = Estimate;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Command = AutopilotCommand;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.estimate(tick, measurements);
    }

    fn engage_inhibits(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.engage_inhibits(tick, measurements)
    }

    fn faults(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.faults(tick, measurements)
    }

    fn flag_name(bit: u32) -> &'static str {
        Autopilot::flag_name(bit)
    }

    fn write_command(
        command: &AutopilotCommand,
        f: &mut std::fmt::Formatter<'_>,
    ) -> std::fmt::Result {
        Autopilot::write_command(command, f)
    }

    fn engage(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.engage(tick, measurements);
    }

    fn guide(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.guide(tick, measurements);
    }

    fn control(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        let proposed = self.autopilot.control(tick, measurements);
        let said = Python::attach(|py| -> PyResult<Surfaces> {
            let said = self.call.bind(py).call1((
                measurements.plant.value.time_s,
                PyMeasurements::from_core(measurements),
                PySetpoints::from(self.autopilot.setpoints()),
                PySurfaces::from(proposed),
            ))?;
            Ok((*said.cast::<PySurfaces>()?.get()).into())
        });
        said.unwrap_or_else(|error| {
            self.raised.keep(error);
            NO_OUTPUT
        })
    }

    fn failsafe(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        self.autopilot.failsafe(tick, measurements)
    }

    fn disengage(&mut self) {
        self.autopilot.disengage();
    }

    fn command(&mut self, command: &AutopilotCommand) {
        self.autopilot.command(command);
    }

    fn estimated(&self) -> Estimate {
        self.autopilot.estimated()
    }

    fn setpoints(&self) -> Setpoints {
        self.autopilot.setpoints()
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        outputs.is_valid()
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        self.autopilot.switch(measurements)
    }
}

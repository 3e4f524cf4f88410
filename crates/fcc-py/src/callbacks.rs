//! A sensor or a controller written in Python: for experiments, never in real
//! time.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Controller as _, Sensor, SensorFault, Tick};
use fcc_fixed_wing::Autopilot;
use fcc_flight::flight::ControlOverride;
use pyo3::prelude::*;

use crate::values::{PyMeasurements, PySetpoints, PySurfaces, Values as _};

/// The first exception that a callback raised.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn keep(&self, error: PyErr) {
        self.lock().get_or_insert(error);
    }

    /// Whether there is one.
    pub(crate) fn is_some(&self) -> bool {
        self.lock().is_some()
    }

    /// Keeps an interruption from the keyboard, if there was one.
    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method itself is for one lifetime, and not for any"
    )]
    pub(crate) fn keep_signals(&self) {
        if let Err(error) = Python::attach(|py| py.check_signals()) {
            self.keep(error);
        }
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
/// plant's time and what was measured, and returns other measurements or None.
pub(crate) struct CallbackSensor {
    sensor: Box<dyn Sensor<Measurements>>,
    call: Py<PyAny>,
    raised: Raised,
}

impl CallbackSensor {
    pub(crate) fn boxed(
        sensor: Box<dyn Sensor<Measurements>>,
        call: Py<PyAny>,
        raised: &Raised,
    ) -> Box<dyn Sensor<Measurements>> {
        let raised = raised.clone();
        Box::new(Self {
            sensor,
            call,
            raised,
        })
    }
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl Sensor<Measurements> for CallbackSensor {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        self.sensor.sample(tick, into)?;
        let measured = PyMeasurements::from_core(into);
        let returned = Python::attach(|py| -> PyResult<Option<PyMeasurements>> {
            let returned = self
                .call
                .bind(py)
                .call1((into.plant.value.time_s, measured))?;
            if returned.is_none() {
                return Ok(None);
            }
            Ok(Some(*returned.cast::<PyMeasurements>()?.borrow()))
        });
        match returned {
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

    fn fallback_after(&self) -> Duration {
        self.sensor.fallback_after()
    }

    fn warm_up(&self, tick: &Tick) {
        self.sensor.warm_up(tick);
    }

    fn name(&self) -> &str {
        self.sensor.name()
    }
}

/// A controller in Python in place of the autopilot's: navigation, guidance,
/// states and failsafe are the autopilot's, and its surfaces are a proposal.
pub(crate) struct CallbackController {
    pub(crate) call: Py<PyAny>,
    pub(crate) raised: Raised,
}

/// An invalid output: the loop never sends it.
const INVALID: Surfaces = Surfaces {
    throttle: f64::NAN,
    elevator: f64::NAN,
    aileron: f64::NAN,
    rudder: f64::NAN,
    ..Surfaces::IDLE
};

impl ControlOverride for CallbackController {
    fn control(
        &mut self,
        autopilot: &Autopilot,
        _: &Tick,
        measurements: &Measurements,
        surfaces: Surfaces,
    ) -> Surfaces {
        let returned = Python::attach(|py| -> PyResult<Surfaces> {
            let returned = self.call.bind(py).call1((
                measurements.plant.value.time_s,
                PyMeasurements::from_core(measurements),
                PySetpoints::from(autopilot.setpoints()),
                PySurfaces::from(surfaces),
            ))?;
            Ok((*returned.cast::<PySurfaces>()?.get()).into())
        });
        returned.unwrap_or_else(|error| {
            self.raised.keep(error);
            INVALID
        })
    }
}

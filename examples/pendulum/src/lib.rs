//! The Python module `pendulum`: an inverted pendulum under the loop that flies
//! an aircraft, with no aircraft in it. The plant is Python: one call per tick.
//!
//! ```python
//! import pendulum
//!
//! loop = pendulum.Machine(0.01)
//! loop.engage()
//! motor = loop.step(pendulum.Measured(angle_rad=0.1, rate_radps=0.0))
//! ```

mod controller;

use std::sync::Mutex;
use std::time::Duration;

use fcc::events::PyEvent;
use fcc::machine::Lockstep;
use fcc::values::{Values as _, from_keywords, register};
use fcc::{errors, live, recordings};
use fcc_core::framework::LoopCommand;
use fcc_record::About;
use fcc_runtime::LoopConfig;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use controller::{Balance, Measured, Motor, Wanted};

fcc::values_class! {
    /// What the sensors measure at one instant; NaN is what is not measured.
    #[pyclass(name = "Measured", module = "pendulum")]
    struct PyMeasured(Measured), settable;

    #[new]
    #[pyo3(signature = (**values))]
    fn new(values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        from_keywords(values)
    }
}

fcc::values_class! {
    /// What the motor does.
    #[pyclass(name = "Motor", module = "pendulum", frozen)]
    struct PyMotor(Motor),;
}

fcc::values_class! {
    /// The set point.
    #[pyclass(name = "Wanted", module = "pendulum", frozen)]
    struct PyWanted(Wanted),;
}

fcc::machine_class! {
    /// The loop around a pendulum, one call per tick.
    #[pyclass(name = "Machine", module = "pendulum")]
    struct PyMachine(Balance) {}
    setpoints PyWanted;

    #[new]
    fn new(period_s: f64) -> PyResult<Self> {
        let period = Duration::try_from_secs_f64(period_s)
            .map_err(|error| PyValueError::new_err(format!("period_s is {period_s}: {error}")))?;
        let about = About {
            software: concat!("pendulum ", env!("CARGO_PKG_VERSION")).to_owned(),
            config: format!("period_s = {period_s:?}\n"),
            ..About::default()
        };
        let config = LoopConfig::default();
        let lockstep = Lockstep::new(Balance::default(), period, &config, about)?;
        Ok(Self {
            lockstep: Mutex::new(lockstep),
        })
    }

    /// One tick: what the motor is to do, or None while the loop does not hold it.
    #[pyo3(signature = (measured = None))]
    fn step(&self, measured: Option<&PyMeasured>) -> Option<PyMotor> {
        let sample = measured.map(|measured| measured.sample(|_| false));
        self.lockstep().step(sample).map(PyMotor::from)
    }

    /// Commands another angle, rad.
    fn command(&self, angle_rad: f64) -> PyResult<()> {
        self.lockstep().send(LoopCommand::Controller(angle_rad))
    }
}

/// Replays a recording, and compares every value of every tick. `paths` is a
/// file, or the parts of a recording, oldest first.
#[pyfunction]
fn replay<'py>(paths: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    recordings::replay(paths, true, |chain| {
        recordings::loop_of(chain, Balance::default(), &LoopConfig::default())
    })
}

/// An inverted pendulum under the loop that flies an aircraft.
#[pymodule]
fn pendulum(module: &Bound<'_, PyModule>) -> PyResult<()> {
    register::<PyMeasured>(module)?;
    register::<PyMotor>(module)?;
    register::<PyWanted>(module)?;
    module.add_class::<PyEvent>()?;
    module.add_class::<PyMachine>()?;
    errors::register(module)?;
    recordings::register(module)?;
    module.add_function(wrap_pyfunction!(replay, module)?)?;
    live::register(module)
}

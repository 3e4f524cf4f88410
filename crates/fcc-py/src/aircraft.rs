//! The built-in aircraft, one call per tick.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use fcc_calibration::Calibration;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Reading, Sensor, Switch, Tick, Time};
use fcc_flight::config::Aircraft;
use fcc_sim::Simulation;
use pyo3::prelude::*;

use crate::arguments::step_s;
use crate::config::configuration;
use crate::errors;
use crate::values::{PyMeasurements, PySurfaces, PyTruth, Values as _, checked};

/// The built-in aircraft, in lockstep: a light single with six degrees of
/// freedom, by the section `[built-in]` of the configuration, with its
/// wind, gusts, noise and delay. The same seed flies the same flight, to the
/// last bit.
///
/// >>> aircraft = fcc.BuiltInAircraft()
/// >>> round(aircraft.step(None).altitude_m)  # measured with noise
/// 914
#[pyclass(name = "BuiltInAircraft", module = "fcc")]
pub(crate) struct PyAircraft {
    inner: Mutex<Inner>,
}

struct Inner {
    simulation: Simulation,
    calibration: Option<Calibration>,
    measured: Measurements,
    tick: Tick,
    time_s: f64,
}

impl PyAircraft {
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyAircraft {
    #[new]
    #[pyo3(signature = (config = None))]
    fn new(config: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let config = configuration(config)?;
        let Some(Aircraft::BuiltIn(section)) = config.aircraft() else {
            return Err(
                errors::FLIGHT.with("the configuration has [x-plane]: give one with [built-in]")
            );
        };
        let simulation = Simulation::new(&section.simulation(config.navigation.method))
            .map_err(|error| errors::FLIGHT.with(format_args!("the built-in aircraft: {error}")))?;
        Ok(Self {
            inner: Mutex::new(Inner {
                simulation,
                calibration: section.calibration.to_core(),
                measured: Measurements::default(),
                tick: Tick::default(),
                time_s: 0.0,
            }),
        })
    }

    /// Simulates the next `dt` s with these controls, and measures. None releases
    /// the controls: they are at the trim.
    #[pyo3(signature = (surfaces, dt = 0.025))]
    fn step(&self, surfaces: Option<&PySurfaces>, dt: f64) -> PyResult<PyMeasurements> {
        let dt_s = step_s(dt)?;
        let commands = surfaces
            .map(|surfaces| checked((*surfaces).into()))
            .transpose()?;
        let mut inner = self.inner();
        let Inner {
            simulation,
            calibration,
            measured,
            tick,
            time_s,
        } = &mut *inner;
        let moved = match commands {
            Some(commands) => simulation.actuator.apply(tick, &commands),
            None => simulation.actuator.release(),
        };
        moved.map_err(|fault| errors::FLIGHT.with(fault))?;
        *time_s += dt_s;
        let now = Time::from_nanos(Duration::from_secs_f64(*time_s).as_nanos() as i64);
        *tick = Tick {
            number: tick.number + 1,
            scheduled: now,
            woke: now,
            missed: 0,
            dt_s,
        };
        // A range finder that sees no ground gives nothing, and not its last range anew.
        measured.range_m = Reading::default();
        simulation.sensor.sample(tick, measured).map_err(|_| {
            errors::FLIGHT.with("the aircraft is out of bounds: its state is not finite any more")
        })?;
        Ok(match calibration {
            Some(calibration) => PyMeasurements::from_core(&calibration.applied(measured)),
            None => PyMeasurements::from_core(measured),
        })
    }

    /// Its true state.
    #[getter]
    fn truth(&self) -> PyTruth {
        self.inner().simulation.truth.get().into()
    }

    /// Its true state when it hit the ground, which is then held; None while it
    /// flies.
    #[getter]
    fn impact(&self) -> Option<PyTruth> {
        self.inner().simulation.truth.impact().map(PyTruth::from)
    }

    /// The position of its engage switch, as configured.
    #[getter]
    fn switch(&self) -> bool {
        self.inner().measured.engage_switch.value == Switch::On
    }

    /// The positions of its controls: the last commanded ones, or the trim.
    #[getter]
    fn controls(&self) -> PySurfaces {
        let inner = self.inner();
        if inner.measured.surfaces.is_never() {
            let throttle = inner.simulation.trim.throttle;
            return PySurfaces::from(Surfaces {
                throttle,
                ..Surfaces::default()
            });
        }
        inner.measured.surfaces.value.into()
    }
}

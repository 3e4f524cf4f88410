//! Commands to a running daemon.

use std::sync::{Mutex, PoisonError};

use fcc_live::{CommandError, Commander, FlightCommand, NewSetpoints};
use fcc_telemetry::Instance;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::instance;
use crate::errors;

/// Sends commands to a daemon on this machine, by its instance's name. Each call
/// waits until the command is carried out, with the GIL released, and returns the
/// tick that did it.
///
/// Raises `CommandError` with the daemon's reason if it refuses, and
/// `TelemetryError` if it cannot be reached.
#[pyclass(name = "Commander", module = "fcc")]
pub(crate) struct PyCommander {
    commander: Mutex<Commander>,
    instance: Instance,
}

fn refused(error: &CommandError) -> PyErr {
    match error {
        CommandError::Unreachable(_) | CommandError::NotAccepted { .. } => {
            errors::TELEMETRY.with(error)
        }
        _ => errors::COMMAND.with(error),
    }
}

#[pymethods]
impl PyCommander {
    #[new]
    #[pyo3(signature = (instance = "fccd"))]
    fn new(py: Python<'_>, instance: &str) -> PyResult<Self> {
        let instance = self::instance(instance)?;
        let commander = py
            .detach(|| Commander::open(&instance))
            .map_err(|error| refused(&error))?;
        Ok(Self {
            commander: Mutex::new(commander),
            instance,
        })
    }

    /// Engages: the present state becomes the set points.
    fn engage(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, FlightCommand::Engage)
    }

    /// Disengages: releases the controls.
    fn disengage(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, FlightCommand::Disengage)
    }

    /// Releases the controls and ends the daemon.
    fn stop(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, FlightCommand::Stop)
    }

    /// Commands other set points; those not given keep their value: indicated
    /// airspeed (m/s, within the envelope), magnetic heading (rad, -2π to 2π),
    /// altitude (m, -500 to 20,000): above sea level by the altimeter setting, or a
    /// pressure altitude, or a height above the configured field. Ends a pattern. An
    /// altimeter setting (Pa, 94,000 to 106,000) alone ends none, and is also set in
    /// standby.
    #[pyo3(signature = (*, airspeed_mps = None, heading_rad = None, altitude_m = None,
                        pressure_altitude_m = None, height_m = None,
                        altimeter_setting_pa = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn set(
        &self,
        py: Python<'_>,
        airspeed_mps: Option<f64>,
        heading_rad: Option<f64>,
        altitude_m: Option<f64>,
        pressure_altitude_m: Option<f64>,
        height_m: Option<f64>,
        altimeter_setting_pa: Option<f64>,
    ) -> PyResult<u64> {
        let command = FlightCommand::Set(NewSetpoints {
            airspeed_mps,
            heading_rad,
            altitude_m,
            pressure_altitude_m,
            height_m,
            altimeter_setting_pa,
        });
        command
            .check()
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        self.command(py, command)
    }

    fn __repr__(&self) -> String {
        format!("Commander({:?})", self.instance.to_string())
    }
}

impl PyCommander {
    fn command(&self, py: Python<'_>, command: FlightCommand) -> PyResult<u64> {
        py.detach(|| {
            let mut commander = self
                .commander
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            commander.command(command)
        })
        .map_err(|error| refused(&error))
    }
}

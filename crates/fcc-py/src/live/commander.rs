//! Commands to a running loop.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use fcc_live::{Command, CommandError, Commander};
use fcc_telemetry::Instance;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::instance;
use crate::errors;

/// Sends commands to a daemon, or to the loop of any other plant, on this machine,
/// by its instance's name. Each call
/// waits until the command is carried out and returns the tick that did; the GIL
/// is released meanwhile.
///
/// Raises `CommandError` with the daemon's reason if it refuses, and
/// `TelemetryError` if it cannot be reached.
///
/// >>> fcc.Commander("lab").set(airspeed_mps=50.0) > 0
/// True
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
        let sender = format!("a Python program, process {}", std::process::id());
        let commander = py
            .detach(|| Commander::open(&instance, &sender))
            .map_err(|error| refused(&error))?;
        Ok(Self {
            commander: Mutex::new(commander),
            instance,
        })
    }

    /// Engages: the present state becomes the set points.
    fn engage(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, &Command::Engage)
    }

    /// Disengages: releases the controls.
    fn disengage(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, &Command::Disengage)
    }

    /// Releases the controls and ends the program.
    fn stop(&self, py: Python<'_>) -> PyResult<u64> {
        self.command(py, &Command::Stop)
    }

    /// Commands other set points, by their names; those not given keep their
    /// value. Of a flight: indicated airspeed (`airspeed_mps`, within the envelope),
    /// magnetic heading (`heading_rad`, -2π to 2π), and, -500 to 20,000, `altitude_m`
    /// (above sea level by the altimeter setting), `pressure_altitude_m` or `height_m`
    /// (above the configured field). Ends a pattern. `altimeter_setting_pa` (94,000 to
    /// 106,000) alone ends none, and is also set in standby.
    #[pyo3(signature = (**setpoints))]
    fn set(&self, py: Python<'_>, setpoints: Option<&Bound<'_, PyDict>>) -> PyResult<u64> {
        let mut given = Vec::new();
        for (name, value) in setpoints.into_iter().flatten() {
            given.push((name.extract()?, value.extract()?));
        }
        self.command(py, &Command::Set(given))
    }

    /// Flies another plan, from an item on (1 to 1,000). The daemon reads the file, checks
    /// it and replaces the plan in one piece; refused with all problems, and low over a
    /// runway or in a landing.
    #[pyo3(signature = (file, item = 1))]
    fn replace_plan(&self, py: Python<'_>, file: PathBuf, item: u16) -> PyResult<u64> {
        if !(1..=1_000).contains(&item) {
            let message = format!("item is {item}: give 1 to 1000");
            return Err(PyValueError::new_err(message));
        }
        let file = std::path::absolute(file)?;
        let file = file.to_str().ok_or_else(|| {
            PyValueError::new_err(format!("{}: the name is not UTF-8", file.display()))
        })?;
        let file = file.to_owned();
        self.command(py, &Command::ReplacePlan { file, item })
    }

    fn __repr__(&self) -> String {
        format!("Commander({:?})", self.instance.to_string())
    }
}

impl PyCommander {
    fn command(&self, py: Python<'_>, command: &Command) -> PyResult<u64> {
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

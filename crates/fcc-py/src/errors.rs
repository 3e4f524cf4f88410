//! Exceptions: one base, and a subclass for each part, with the daemon's
//! messages.
//!
//! Some are also subclasses of a built-in exception: a bad configuration is a
//! `ValueError`, an autopilot that is not engaged a `RuntimeError`.

use std::fmt::Display;
use std::io;
use std::path::Path;

use fcc_telemetry::printable;
use pyo3::exceptions::{PyException, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};

/// An `OSError` of the subclass that belongs to the error's number, with the file's name.
pub(crate) fn of_file(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    match error.raw_os_error() {
        Some(number) => {
            let text = text.split(" (os error").next().unwrap_or_default();
            PyOSError::new_err((number, text.to_owned(), path.as_os_str().to_owned()))
        }
        None => PyOSError::new_err(format!("{}: {text}", path.display())),
    }
}

/// One exception of the module: made once, by `type(name, bases, ...)`, because
/// there is no other way to a class with two bases.
pub(crate) struct Exception {
    name: &'static str,
    doc: &'static str,
    base: Option<&'static Self>,
    also: Also,
    class: PyOnceLock<Py<PyType>>,
}

/// The built-in exception of which it is also a subclass.
enum Also {
    Exception,
    ValueError,
    RuntimeError,
}

impl Exception {
    const fn new(
        name: &'static str,
        base: Option<&'static Self>,
        also: Also,
        doc: &'static str,
    ) -> Self {
        Self {
            name,
            doc,
            base,
            also,
            class: PyOnceLock::new(),
        }
    }

    fn class<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyType>> {
        let class = self.class.get_or_try_init(py, || self.make(py))?;
        Ok(class.bind(py).clone())
    }

    fn make(&self, py: Python<'_>) -> PyResult<Py<PyType>> {
        let builtin = match self.also {
            Also::Exception => None,
            Also::ValueError => Some(py.get_type::<PyValueError>()),
            Also::RuntimeError => Some(py.get_type::<PyRuntimeError>()),
        };
        let own = match self.base {
            Some(base) => base.class(py)?,
            None => py.get_type::<PyException>(),
        };
        let bases = PyTuple::new(py, std::iter::once(own).chain(builtin).collect::<Vec<_>>())?;
        let names = PyDict::new(py);
        names.set_item("__doc__", self.doc)?;
        names.set_item("__module__", "fcc")?;
        let class = py.get_type::<PyType>().call1((self.name, bases, names))?;
        Ok(class.cast_into::<PyType>()?.unbind())
    }

    /// An exception with this message, which Python prints on a terminal as it is.
    pub(crate) fn with(&self, message: impl Display) -> PyErr {
        Python::attach(|py| match self.class(py) {
            Ok(class) => PyErr::from_type(class, printable(&message.to_string())),
            Err(error) => error,
        })
    }
}

/// Any error that is not a wrong argument.
static ERROR: Exception = Exception::new(
    "Error",
    None,
    Also::Exception,
    "Any error that is not a wrong argument.",
);

/// A configuration that cannot be flown.
pub(crate) static CONFIG: Exception = Exception::new(
    "ConfigError",
    Some(&ERROR),
    Also::ValueError,
    "A configuration that cannot be read or flown: every problem with its line and key.",
);

/// A flight plan that cannot be read or written.
pub(crate) static PLAN: Exception = Exception::new(
    "PlanError",
    Some(&ERROR),
    Also::ValueError,
    "A flight plan that cannot be read, or written in a format: every problem with its item.",
);

/// Not engaged.
pub(crate) static ENGAGE: Exception = Exception::new(
    "EngageError",
    Some(&ERROR),
    Also::RuntimeError,
    "The autopilot is not engaged, or may not engage: the engage inhibits.",
);

/// An aircraft or a flight that is not possible.
pub(crate) static FLIGHT: Exception = Exception::new(
    "FlightError",
    Some(&ERROR),
    Also::Exception,
    "There is no such aircraft, or the flight did not begin.",
);

/// A file that is no recording.
pub(crate) static RECORDING: Exception = Exception::new(
    "RecordingError",
    Some(&ERROR),
    Also::Exception,
    "A recording that cannot be read, recovered, reported on or replayed.",
);

/// A daemon that cannot be watched.
pub(crate) static TELEMETRY: Exception = Exception::new(
    "TelemetryError",
    Some(&ERROR),
    Also::Exception,
    "A daemon that cannot be watched: it does not run, is of another version or has ended.",
);

/// A command that was not carried out.
pub(crate) static COMMAND: Exception = Exception::new(
    "CommandError",
    Some(&ERROR),
    Also::Exception,
    "A command that a daemon refused, with its reason, or did not answer.",
);

/// A timer that fails.
pub(crate) static TIMER: Exception = Exception::new(
    "TimerError",
    Some(&ERROR),
    Also::Exception,
    "A timer that cannot be made, started or waited for.",
);

/// Adds the exceptions to a module.
///
/// # Errors
/// Those of Python.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    for exception in [
        &ERROR, &CONFIG, &PLAN, &ENGAGE, &FLIGHT, &RECORDING, &TELEMETRY, &COMMAND, &TIMER,
    ] {
        module.add(exception.name, exception.class(module.py())?)?;
    }
    Ok(())
}

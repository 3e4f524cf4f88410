//! Configuration: files, texts, values by their keys, with the daemon's messages.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use fcc_fixed_wing::AutopilotConfig;
use fcc_flight::config::{Config, ConfigError, keyed};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use toml::Value;

use crate::errors;

/// The name of a text in messages.
const NAME: &str = "config";

/// A configuration as `fccd` reads it, with the default of every key not given.
/// It cannot be changed: `replace` gives another one.
///
/// `Config()` is the default, `Config(text)` reads TOML; where a text has
/// neither `[x-plane]` nor `[built-in]`, the aircraft is the built-in one.
/// Raises `ConfigError` with every problem, its line and its key.
///
/// >>> config = fcc.Config("[loop]\nrate_hz = 50.0")
/// >>> config.replace({"loop.rate_hz": 100.0})["loop.rate_hz"]
/// 100.0
#[pyclass(name = "Config", module = "fcc", frozen)]
#[derive(Clone)]
pub(crate) struct PyConfig {
    pub(crate) config: Config,
    /// As it was given: without its plan and what follows from that.
    given: Config,
}

impl PyConfig {
    /// With its plan, which a recorded one contains.
    pub(crate) fn of(given: Config, name: &str) -> Result<Self, ConfigError> {
        let config = match given.plan.plan() {
            Some(_) => given.clone(),
            None => given.clone().with_plan(name)?,
        };
        Ok(Self { config, given })
    }
}

pub(crate) fn refused(error: &ConfigError) -> PyErr {
    errors::CONFIG.with(error)
}

#[pymethods]
impl PyConfig {
    #[new]
    #[pyo3(signature = (text = ""))]
    fn new(text: &str) -> PyResult<Self> {
        if names_a_file(text, &["toml"]) {
            return Err(errors::CONFIG.with(format!(
                "{NAME}: '{text}' is the name of a file: read it by Config.load(path)"
            )));
        }
        Config::parse_without_aircraft(text, NAME)
            .and_then(|given| Self::of(given, NAME))
            .map_err(|error| refused(&error))
    }

    /// Reads and checks a file, as `fccd check` does.
    #[staticmethod]
    #[expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]
    fn load(path: PathBuf) -> PyResult<Self> {
        Config::load(&path)
            .and_then(|given| Self::of(given, &path.display().to_string()))
            .map_err(|error| refused(&error))
    }

    /// The value of a key with its sections, such as
    /// `"autopilot.envelope.max_bank_deg"`; of a section, a dict.
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.config.value(key).map_err(|error| refused(&error))?;
        to_python(py, &value)
    }

    fn __contains__(&self, key: &str) -> bool {
        self.config.value(key).is_ok()
    }

    /// Every key with its sections, in the order of a file.
    fn keys(&self) -> PyResult<Vec<String>> {
        let values = self.config.values().map_err(|error| refused(&error))?;
        let keys = keyed(&values).into_iter();
        let values = keys.filter(|(_, value)| !value.is_table());
        Ok(values.map(|(key, _)| key).collect())
    }

    /// Another configuration, with other values for some keys:
    /// `config.replace({"autopilot.heading.roll_gain_per_s": 2.0})`. A dict
    /// replaces a whole section, and another `guidance.mode` drops the keys of the mode before.
    /// It is what a text with these values is: all is checked, and the plan is read.
    fn replace(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut changes = Vec::new();
        for (key, value) in values {
            let key: String = key
                .extract()
                .map_err(|_| PyTypeError::new_err(format!("the key {key} is not a text")))?;
            let value = from_python(&key, &value)?;
            changes.push((key, value));
        }
        let changes = changes
            .iter()
            .map(|(key, value)| (key.as_str(), value.clone()));
        self.given
            .with_values(changes)
            .and_then(|given| Self::of(given, NAME))
            .map_err(|error| refused(&error))
    }

    /// The whole configuration, defaults included, as TOML.
    fn to_toml(&self) -> PyResult<String> {
        self.config.to_toml().map_err(|error| refused(&error))
    }

    /// The whole configuration, defaults included, as dicts in a dict.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = self.config.values().map_err(|error| refused(&error))?;
        to_python(py, &values)
    }

    fn __eq__(&self, other: &Self) -> PyResult<bool> {
        Ok(self.to_toml()? == other.to_toml()?)
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("Config({:?})", self.to_toml()?))
    }
}

/// Whether what is given for the text of a file is the name of one.
pub(crate) fn names_a_file(text: &str, endings: &[&str]) -> bool {
    let ending = Path::new(text).extension().and_then(OsStr::to_str);
    !text.contains('\n') && ending.is_some_and(|ending| endings.contains(&ending))
}

/// A configuration given as a `Config`, as a text or not at all.
pub(crate) fn configuration(given: Option<&Bound<'_, PyAny>>) -> PyResult<Config> {
    let Some(given) = given.filter(|given| !given.is_none()) else {
        return PyConfig::new("").map(|config| config.config);
    };
    if let Ok(config) = given.cast::<PyConfig>() {
        return Ok(config.get().config.clone());
    }
    match given.cast::<PyString>() {
        Ok(text) => PyConfig::new(text.to_str()?).map(|config| config.config),
        Err(_) => Err(PyTypeError::new_err(format!(
            "config is of type {}: give a Config or the text of a configuration",
            given.get_type().name()?
        ))),
    }
}

/// The autopilot's part of it.
pub(crate) fn autopilot_config(given: Option<&Bound<'_, PyAny>>) -> PyResult<AutopilotConfig> {
    configuration(given).map(|config| config.autopilot_config())
}

fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Integer(whole) => whole.into_pyobject(py)?.into_any(),
        Value::Float(number) => number.into_pyobject(py)?.into_any(),
        Value::Boolean(truth) => truth.into_pyobject(py)?.to_owned().into_any(),
        Value::Datetime(time) => time.to_string().into_pyobject(py)?.into_any(),
        Value::Array(values) => {
            let values = values
                .iter()
                .map(|value| to_python(py, value))
                .collect::<PyResult<Vec<_>>>()?;
            values.into_pyobject(py)?.into_any()
        }
        Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, to_python(py, value)?)?;
            }
            dict.into_any()
        }
    })
}

fn from_python(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    // A bool is an int in Python, so it comes first.
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(truth.is_true()));
    }
    if let Ok(whole) = value.cast::<PyInt>() {
        return whole.extract().map(Value::Integer).map_err(|_| {
            PyValueError::new_err(format!(
                "{key} is {whole}: the largest number of a configuration is 2^63 - 1"
            ))
        });
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(Value::Float(number.extract()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    if let Ok(section) = value.cast::<PyDict>() {
        let mut table = toml::Table::new();
        for (name, value) in section {
            let name: String = name.extract()?;
            let value = from_python(&format!("{key}.{name}"), &value)?;
            table.insert(name, value);
        }
        return Ok(Value::Table(table));
    }
    // Numbers of numpy and others.
    if let Ok(number) = value.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    if let Ok(list) = value.try_iter() {
        let entries = list.map(|entry| from_python(key, &entry?));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    Err(PyTypeError::new_err(format!(
        "{key} is of type {}: give a number, a text, True or False, a list, or a dict for a section",
        value.get_type().name()?
    )))
}

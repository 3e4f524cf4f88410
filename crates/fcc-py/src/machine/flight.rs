//! The loop of the autopilot.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_core::flight::Surfaces;
use fcc_core::framework::{LoopCommand, Switch};
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{AirframeSection, Config};
use fcc_flight::flight::about;
use fcc_plan::FileError;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

use super::Lockstep;
use crate::arguments::within;
use crate::commanded::{Given, commands};
use crate::config::{configuration, refused};
use crate::errors;
use crate::values::{
    PyEstimate, PyMeasurements, PySetpoints, PySurfaces, Values, checked, with_plant,
};

/// No reading that is older is of use.
const OLDEST_S: f64 = 10.0;

machine_class! {
    /// The loop that `fccd` runs, one call per tick, on a clock that advances only
    /// in calls.
    ///
    /// `config` is a `Config`, or the text of a configuration file as `fccd` reads
    /// it. Its aircraft is not used: the plant is in Python.
    ///
    /// >>> machine, aircraft = fcc.Machine(), fcc.BuiltInAircraft()
    /// >>> surfaces = None
    /// >>> for _ in range(400):
    /// ...     measured = aircraft.step(surfaces)
    /// ...     surfaces = machine.step(measured, switch=machine.time_s > 5.0)
    /// >>> machine.state, len(machine.records())
    /// ('engaged', 400)
    #[pyclass(name = "Machine", module = "fcc")]
    struct PyMachine(Autopilot) {
        /// What is flown.
        config: Config,
    }
    setpoints PySetpoints, estimate PyEstimate;

    #[new]
    #[pyo3(signature = (config = None))]
    fn new(config: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let parsed = configuration(config)?;
        let autopilot = parsed.autopilot_config();
        let period = parsed.tick.period();
        let about = about(&parsed, Some(as_given(config)?));
        Ok(Self {
            config: parsed.clone(),
            lockstep: Mutex::new(Lockstep::new(
                Autopilot::new(autopilot),
                period,
                &parsed.loop_config(),
                about,
            )?),
        })
    }

    /// One tick; returns the surfaces, or `None` if the loop sends none because
    /// it does not hold the controls.
    ///
    /// `measurements` are those of the sensors; `None` if nothing arrives.
    /// `missing` names the readings that do not arrive in this tick: attitude,
    /// heading, `body_rates`, `specific_force`, airspeed, altitude,
    /// `raw_specific_force`, `raw_body_rates`, `magnetic_field`, `static_pressure`,
    /// `differential_pressure`, gnss and others, which the error for any other name
    /// lists. `ages_s` says of readings, by their names, how long before this tick
    /// they were taken (0 to 10 s); those that are not named are taken in it. `readback`
    /// contains the readback of the controls: throttle 0..1, elevator, aileron and
    /// rudder -1..1, as `Surfaces` or as four numbers, without the elevator's
    /// trim; `None` if the aircraft has none. `switch` is the engage switch; `None` if there is none.
    #[pyo3(signature = (measurements = None, *, missing = None, readback = None,
                        switch = None, ages_s = HashMap::new()))]
    #[allow(
        clippy::needless_pass_by_value,
        reason = "arguments of Python are given by value"
    )]
    fn step(
        &self,
        measurements: Option<&PyMeasurements>,
        missing: Option<&Bound<'_, PyAny>>,
        readback: Option<&Bound<'_, PyAny>>,
        switch: Option<bool>,
        ages_s: HashMap<String, f64>,
    ) -> PyResult<Option<PySurfaces>> {
        let missing = missing.map_or_else(|| Ok(Vec::new()), names)?;
        known_readings("missing", missing.iter())?;
        known_readings("ages_s", ages_s.keys())?;
        for (name, age_s) in &ages_s {
            within(&format!("ages_s[{name:?}]"), *age_s, 0.0, OLDEST_S)?;
        }
        let readback = readback.map(surfaces).transpose()?;
        let switch = switch.map(|on| if on { Switch::On } else { Switch::Off });
        let mut lockstep = self.lockstep();
        let sample = measurements.map(|measurements| {
            let is_missing = |name: &str| missing.iter().any(|missing| missing == name);
            let mut sample = measurements.sample(is_missing);
            let age_ns = |name: &str| ages_s.get(name).map(|age_s| (age_s * 1e9) as i64);
            PyMeasurements::attributes().shape.set_ages(&mut sample, age_ns);
            with_plant(&sample, lockstep.next_s(), readback, switch)
        });
        Ok(lockstep.step(sample).map(PySurfaces::from))
    }

    /// What was learned of the aircraft, as the keys of `[autopilot.airframe]` by their
    /// names; `None` before a minute with an airspeed sensor that is believed and a
    /// throttle that is read back.
    #[getter]
    fn learned_airframe(&self) -> Option<HashMap<&'static str, f64>> {
        let learned = self.lockstep().controller().learned_airframe()?;
        let section = AirframeSection::from(learned);
        Some(HashMap::from([
            ("axial_offset", section.axial_offset),
            ("full_thrust_ratio", section.full_thrust_ratio),
            ("zero_lift_angle_deg", section.zero_lift_angle_deg),
            ("one_g_angle_deg", section.one_g_angle_deg),
        ]))
    }

    /// Flies another plan from the next tick on, from an item on (from 1). Raises
    /// `PlanError` with all problems; refused with the reason, which is an event, if it is
    /// not engaged, low over a runway or in a landing.
    #[pyo3(signature = (file, item = 1))]
    #[expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]
    fn replace_plan(&self, file: PathBuf, item: u16) -> PyResult<()> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let uploaded_s = now.map_or(0, |since| since.as_secs());
        let plan = match self.config.prepare_plan(&file, item, uploaded_s) {
            Ok(plan) => plan,
            Err(FileError::Unreadable { source, .. }) => {
                return Err(errors::of_file(&file, &source));
            }
            Err(error) => return Err(errors::PLAN.with(error)),
        };
        let mut lockstep = self.lockstep();
        lockstep.keep(plan.document());
        lockstep.send(LoopCommand::Controller(plan.command()))
    }

    /// Commands another airspeed (m/s), heading (rad) or altitude (m): above sea
    /// level by the altimeter setting, or a pressure altitude, or a height above
    /// the configured field; ends a pattern or a plan. An altimeter setting (Pa) and a
    /// heartbeat (s) end none. Of a plan: `plan_item` (0: where it was left), `pause` and
    /// `return_home` (1), and the three of `go_to_latitude_rad`.
    #[pyo3(signature = (**setpoints))]
    fn command(&self, setpoints: Option<Given>) -> PyResult<()> {
        let config = *self.lockstep().controller().config();
        for command in commands(setpoints, &config)? {
            self.lockstep().send(LoopCommand::Controller(command))?;
        }
        Ok(())
    }
}

/// Names of readings: one alone would be taken for its letters.
fn names(missing: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    missing.extract().map_err(|_| {
        let given = missing
            .repr()
            .map_or_else(|_| String::new(), |text| text.to_string());
        PyTypeError::new_err(format!(
            "missing is {given}: give a list of readings, such as ['airspeed']"
        ))
    })
}

/// Refuses names that no reading has.
fn known_readings<'a>(argument: &str, mut names: impl Iterator<Item = &'a String>) -> PyResult<()> {
    let without = PyMeasurements::WITHOUT;
    let readings = PyMeasurements::attributes().shape.readings.iter();
    let known: Vec<_> = readings
        .filter(|name| !without.contains(name))
        .copied()
        .collect();
    match names.find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(PyValueError::new_err(format!(
            "{argument}: there is no reading '{name}': choose of {}",
            known.join(", ")
        ))),
    }
}

/// The readback of the controls, as `Surfaces` or as four numbers.
fn surfaces(readback: &Bound<'_, PyAny>) -> PyResult<Surfaces> {
    if let Ok(surfaces) = readback.cast::<PySurfaces>() {
        return Ok((*surfaces.get()).into());
    }
    let (throttle, elevator, aileron, rudder) = readback.extract()?;
    checked(Surfaces {
        throttle,
        elevator,
        aileron,
        rudder,
        ..Surfaces::IDLE
    })
}

/// The text of a configuration, as a recording keeps it.
fn as_given(config: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
    match config.map(|config| config.cast::<PyString>()) {
        Some(Ok(text)) => Ok(text.to_str()?.to_owned()),
        _ => configuration(config)?
            .to_toml()
            .map_err(|error| refused(&error)),
    }
}

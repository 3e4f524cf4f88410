//! The values of a flight.

use fcc_core::flight::{Measurements, Plant, PlantState, Surfaces};
use fcc_core::framework::{Reading, Switch, Time};
use fcc_fixed_wing::Setpoints;
use fcc_navigation::Estimate;
use fcc_sim::{RawTruth, Truth};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Values as _, checked, from_array, from_keywords, to_array};

values_class! {
    /// What the sensors measure at one instant: angles in rad, rates in rad/s,
    /// specific force along the body axes in m/s² (z is -9.81 in level flight),
    /// indicated airspeed in m/s, barometric altitude in m.
    ///
    /// NaN means not measured: the last value is kept and becomes older. A value
    /// that no aircraft of this kind can reach is treated in the same way. The raw
    /// readings, from `raw_specific_force_x_mps2` on, are flown by if the
    /// configuration's `[navigation]` says so.
    ///
    /// >>> fcc.Measurements(airspeed_mps=50.0).altitude_m
    /// nan
    #[pyclass(name = "Measurements", module = "fcc")]
    struct PyMeasurements(Measurements)
        without ["surfaces", "engage_switch", "plant", "other_control"],
        settable;

    #[new]
    #[pyo3(signature = (**values))]
    fn new(values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        from_keywords(values)
    }

    /// From a row of numbers, in the order of `fcc.MEASUREMENTS`.
    #[staticmethod]
    #[pyo3(name = "from_array")]
    fn of_array(row: &Bound<'_, PyAny>) -> PyResult<Self> {
        from_array(row)
    }

    /// As a row of numbers, in the order of `fcc.MEASUREMENTS`.
    #[pyo3(name = "to_array")]
    fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_array(py, *self)
    }
}

values_class! {
    /// Throttle 0..1 and surfaces -1..1: +elevator raises the nose, +aileron
    /// rolls right, +rudder yaws right; 0 if not given.
    ///
    /// >>> fcc.Surfaces(throttle=0.5).to_array()[:4]
    /// array([0.5, 0. , 0. , 0. ])
    #[pyclass(name = "Surfaces", module = "fcc", frozen)]
    struct PySurfaces(Surfaces),;

    #[new]
    #[pyo3(signature = (**values))]
    fn new(values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        checked(from_keywords::<Self>(values)?.0).map(Self)
    }

    /// As a row of numbers, in the order of `fcc.SURFACES`.
    #[pyo3(name = "to_array")]
    fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_array(py, *self)
    }
}

values_class! {
    /// The set points of the autopilot, and the mode and progress of guidance.
    ///
    /// >>> aircraft, machine = fcc.BuiltInAircraft(), fcc.Machine()
    /// >>> for _ in range(200):
    /// ...     _ = machine.step(aircraft.step(None), switch=machine.time_s > 4.0)
    /// >>> abs(machine.setpoints.altitude_m - aircraft.truth.altitude_m) < 10.0
    /// True
    #[pyclass(name = "Setpoints", module = "fcc", frozen)]
    struct PySetpoints(Setpoints),;
}

values_class! {
    /// Navigation's estimate.
    ///
    /// >>> aircraft, autopilot = fcc.BuiltInAircraft(), fcc.Autopilot()
    /// >>> for _ in range(200):
    /// ...     autopilot.observe(aircraft.step(None))
    /// >>> abs(autopilot.estimate.altitude_m - aircraft.truth.altitude_m) < 3.0
    /// True
    #[pyclass(name = "Estimate", module = "fcc", frozen)]
    struct PyEstimate(Estimate),;
}

values_class! {
    /// The true state of the built-in aircraft, without sensor errors: for
    /// scoring, never for flying.
    ///
    /// >>> round(fcc.BuiltInAircraft().truth.altitude_m)  # 3,000 ft
    /// 914
    #[pyclass(name = "Truth", module = "fcc", frozen)]
    struct PyTruth(Truth),;
}

values_class! {
    /// The truth that raw sensors measure, at one moment; 0 if not given.
    ///
    /// >>> fcc.RawTruth(specific_force_z_mps2=-9.81).time_s
    /// 0.0
    #[pyclass(name = "RawTruth", module = "fcc", frozen)]
    struct PyRawTruth(RawTruth),;

    #[new]
    #[pyo3(signature = (**values))]
    fn new(values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        checked(from_keywords::<Self>(values)?.0).map(Self)
    }
}

impl PyMeasurements {
    /// Replaces the values of the core's measurements; their times stay.
    pub(crate) fn write_over(&self, core: &mut Measurements) {
        Self::attributes().shape.copy(&self.0, core, None);
    }
}

/// Adds to a sample what the plant reports beside its measurements.
pub(crate) fn with_plant(
    sample: &Measurements,
    plant_time_s: f64,
    readback: Option<Surfaces>,
    switch: Option<Switch>,
) -> Measurements {
    fn taken<T: Default>(value: Option<T>) -> Reading<T> {
        let now = value.map(|value| Reading::new(value, Time::from_nanos(0)));
        now.unwrap_or_default()
    }
    Measurements {
        plant: taken(Some(Plant {
            time_s: plant_time_s,
            state: PlantState::Running,
        })),
        surfaces: taken(readback),
        engage_switch: taken(switch),
        ..*sample
    }
}

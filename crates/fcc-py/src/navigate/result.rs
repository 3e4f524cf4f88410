//! Estimates as a dict of arrays.

use fcc_core::flight::orientation::euler_from_quaternion;
use fcc_navigation::inertial::{Innovation, ObservationKind, Solution};
use numpy::{PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::sources::Sources;

/// A value and its standard deviation: the name, the number of columns, what
/// they are.
type Column = (
    &'static str,
    fn(&Solution) -> Vec<f64>,
    fn(&Solution) -> Vec<f64>,
);

const COLUMNS: [Column; 12] = [
    (
        "roll_rad",
        |s| vec![euler_from_quaternion(s.quaternion).roll_rad],
        |s| vec![s.sigma.roll_rad],
    ),
    (
        "pitch_rad",
        |s| vec![euler_from_quaternion(s.quaternion).pitch_rad],
        |s| vec![s.sigma.pitch_rad],
    ),
    (
        "heading_rad",
        |s| vec![euler_from_quaternion(s.quaternion).heading_rad],
        |s| vec![s.sigma.heading_rad],
    ),
    (
        "velocity_mps",
        |s| s.velocity_mps.to_vec(),
        |s| s.sigma.velocity_mps.to_vec(),
    ),
    (
        "position_m",
        |s| s.displacement_m.to_vec(),
        |s| s.sigma.position_m.to_vec(),
    ),
    (
        "wind_mps",
        |s| s.wind_mps.to_vec(),
        |s| s.sigma.wind_mps.to_vec(),
    ),
    (
        "gyroscope_bias_radps",
        |s| s.gyroscope_bias_radps.to_vec(),
        |s| s.sigma.gyroscope_bias_radps.to_vec(),
    ),
    (
        "accelerometer_bias_mps2",
        |s| s.accelerometer_bias_mps2.to_vec(),
        |s| s.sigma.accelerometer_bias_mps2.to_vec(),
    ),
    (
        "barometer_bias_m",
        |s| vec![s.barometer_bias_m],
        |s| vec![s.sigma.barometer_bias_m],
    ),
    (
        "earth_field_ut",
        |s| s.earth_field_ut.to_vec(),
        |s| s.sigma.earth_field_ut.to_vec(),
    ),
    (
        "body_field_ut",
        |s| s.body_field_ut.to_vec(),
        |s| s.sigma.body_field_ut.to_vec(),
    ),
    (
        "gnss_late_s",
        |s| vec![s.fixes_late_s],
        |s| vec![s.sigma.fixes_late_s],
    ),
];

/// The same without standard deviations of their own.
type Plain = (&'static str, fn(&Solution) -> Vec<f64>);

const PLAIN: [Plain; 4] = [
    ("quaternion", |s| s.quaternion.to_vec()),
    ("latitude_rad", |s| vec![s.position.latitude_rad]),
    ("longitude_rad", |s| vec![s.position.longitude_rad]),
    ("altitude_m", |s| vec![s.position.altitude_m]),
];

/// The sources that are compared with what is expected of them, with their columns.
const SENSORS: [(ObservationKind, &str, usize); 6] = [
    (ObservationKind::MagneticField, "magnetometer", 3),
    (ObservationKind::StaticPressure, "static_pressure", 1),
    (
        ObservationKind::DifferentialPressure,
        "differential_pressure",
        1,
    ),
    (ObservationKind::Airspeed, "airspeed", 1),
    (ObservationKind::Position, "gnss_position", 3),
    (ObservationKind::Velocity, "gnss_velocity", 3),
];

pub(super) fn dict<'py>(
    py: Python<'py>,
    sources: &Sources,
    solutions: &[Solution],
    innovations: &[Innovation],
    reference: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let seconds = |nanos: i64| sources.begin_s + nanos as f64 * 1e-9;
    let times: Vec<f64> = solutions
        .iter()
        .map(|s| seconds(s.time.as_nanos()))
        .collect();
    result.set_item("t_s", times.to_pyarray(py))?;
    result.set_item("heading_reference", reference)?;
    for (name, value, sigma) in COLUMNS {
        let sigma_name = format!("{name}_sigma");
        set(&result, name, solutions.iter().map(value))?;
        set(&result, &sigma_name, solutions.iter().map(sigma))?;
    }
    for (name, value) in PLAIN {
        set(&result, name, solutions.iter().map(value))?;
    }
    let (by_sensor, normalised) = (PyDict::new(py), PyDict::new(py));
    for (kind, name, width) in SENSORS {
        let of: Vec<&Innovation> = innovations.iter().filter(|i| i.kind == kind).collect();
        if of.is_empty() {
            continue;
        }
        let one = PyDict::new(py);
        let times: Vec<f64> = of.iter().map(|i| seconds(i.time.as_nanos())).collect();
        one.set_item("t_s", times.to_pyarray(py))?;
        let parts = |of: [f64; 3]| of.into_iter().take(width).collect();
        set(&one, "difference", of.iter().map(|i| parts(i.difference)))?;
        set(&one, "sigma", of.iter().map(|i| parts(i.sigma)))?;
        let accepted: Vec<bool> = of.iter().map(|i| i.accepted).collect();
        one.set_item("accepted", accepted.to_pyarray(py))?;
        by_sensor.set_item(name, one)?;
        let rms = PyDict::new(py);
        let n = of.len() as f64;
        let axes = (0..width).map(|axis| mean_square(&of, axis).sqrt());
        match width {
            1 => rms.set_item("rms", axes.sum::<f64>())?,
            _ => rms.set_item("rms", axes.collect::<Vec<_>>())?,
        }
        let accepted = of.iter().filter(|i| i.accepted).count() as f64;
        rms.set_item("accepted", accepted / n)?;
        normalised.set_item(name, rms)?;
    }
    result.set_item("innovations", by_sensor)?;
    result.set_item("normalised_innovations", normalised)?;
    Ok(result)
}

/// Of an axis' innovations, each divided by its standard deviation.
fn mean_square(of: &[&Innovation], axis: usize) -> f64 {
    let normalised = of.iter().map(|one| {
        let pair = one.difference.get(axis).zip(one.sigma.get(axis));
        pair.map_or(0.0, |(difference, sigma)| difference / sigma)
    });
    normalised.map(|one| one * one).sum::<f64>() / of.len() as f64
}

/// An array of a row for each; of numbers if a row has one.
fn set(
    to: &Bound<'_, PyDict>,
    name: &str,
    rows: impl ExactSizeIterator<Item = Vec<f64>>,
) -> PyResult<()> {
    let n = rows.len();
    let values: Vec<f64> = rows.flatten().collect();
    let array = values.to_pyarray(to.py());
    if values.len() > n {
        to.set_item(name, array.reshape([n, values.len() / n])?)
    } else {
        to.set_item(name, array)
    }
}

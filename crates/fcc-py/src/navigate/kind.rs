//! The kinds of sources, and how the arrays of one are read.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arguments::{numbers, shape_words};

/// One source: its name, the number of its values, what it is at most (a larger
/// one is not possible), and in what.
pub(super) struct Kind {
    pub(super) name: &'static str,
    width: usize,
    range: (f64, f64),
    pub(super) unit: &'static str,
}

const fn kind(name: &'static str, width: usize, range: (f64, f64), unit: &'static str) -> Kind {
    Kind {
        name,
        width,
        range,
        unit,
    }
}

pub(super) const KINDS: [Kind; 8] = [
    kind("gyroscope", 3, (-150.0, 150.0), "rad/s"),
    kind("accelerometer", 3, (-2_000.0, 2_000.0), "m/s²"),
    kind("magnetometer", 3, (-5_000.0, 5_000.0), "µT"),
    // At 20 km it is 5,500 Pa, and at sea level 1,013 hPa.
    kind("static_pressure", 1, (2_000.0, 120_000.0), "Pa"),
    kind("differential_pressure", 1, (-20_000.0, 20_000.0), "Pa"),
    kind("airspeed", 1, (-50.0, 200.0), "m/s"),
    kind("gnss_position", 3, (-100_000.0, 100_000.0), "rad, rad, m"),
    kind("gnss_velocity", 3, (-1_000.0, 1_000.0), "m/s"),
];

/// The samples of a source. What is masked of them is not a number.
pub(super) struct Series {
    pub(super) times_s: Vec<f64>,
    pub(super) rows: Vec<[f64; 3]>,
    pub(super) masked: usize,
}

impl Kind {
    /// Whether a satellite receiver gives it.
    pub(super) fn is_of_receiver(&self) -> bool {
        self.name.starts_with("gnss")
    }

    /// The tuple of times and values.
    pub(super) fn read(&self, source: &Bound<'_, PyAny>) -> PyResult<Series> {
        let name = self.name;
        let parts: Vec<Bound<'_, PyAny>> = source
            .try_iter()
            .and_then(Iterator::collect)
            .map_err(|_| PyTypeError::new_err(self.wanted("it is no tuple")))?;
        let Some((times, values)) = parts.split_first() else {
            return Err(PyValueError::new_err(self.wanted("it is empty")));
        };
        if values.len() != 1 && values.len() != self.width {
            let has = format!("it has {} arrays", parts.len());
            return Err(PyValueError::new_err(self.wanted(&has)));
        }
        let (shape, times_s) = numbers(&format!("{name}: t_s"), times)?;
        if shape.len() != 1 || times_s.is_empty() {
            let has = format!("its times are of shape {}", shape_words(&shape));
            return Err(PyValueError::new_err(self.wanted(&has)));
        }
        let n = times_s.len();
        let mut rows = vec![[0.0; 3]; n];
        let mut masked = vec![false; n];
        for (column, values) in values.iter().enumerate() {
            let (shape, numbers) = numbers(&format!("{name}: values"), values)?;
            let is_fitting = match shape.as_slice() {
                [rows] => *rows == n && (parts.len() - 1 == self.width),
                [rows, width] => *rows == n && *width == self.width && parts.len() == 2,
                _ => false,
            };
            if !is_fitting {
                let mut has = format!(
                    "it has {n} times, and values of shape {}",
                    shape_words(&shape)
                );
                if shape == [self.width, n] {
                    has += " (are they transposed? values.T turns them)";
                }
                return Err(PyValueError::new_err(self.wanted(&has)));
            }
            let width = numbers.len() / n;
            for (row, given) in rows.iter_mut().zip(numbers.chunks_exact(width)) {
                for (place, value) in row.iter_mut().skip(column).zip(given) {
                    *place = *value;
                }
            }
            mask(values, &mut masked)?;
        }
        for (row, _) in rows.iter_mut().zip(&masked).filter(|(_, masked)| **masked) {
            row.fill(f64::NAN);
        }
        // A sample whose time is masked was never taken.
        let mut untimed = vec![false; n];
        mask(times, &mut untimed)?;
        let mut series = Series {
            times_s: Vec::new(),
            rows: Vec::new(),
            masked: 0,
        };
        for (at, (time_s, row)) in times_s.iter().zip(rows).enumerate() {
            if untimed.get(at) == Some(&false) {
                series.times_s.push(*time_s);
                series.rows.push(row);
                series.masked += usize::from(masked.get(at) == Some(&true));
            }
        }
        if series.masked == series.rows.len() {
            return Err(PyValueError::new_err(
                self.wanted("all its samples are masked"),
            ));
        }
        check_times(name, &series.times_s)?;
        Ok(series)
    }

    fn wanted(&self, has: &str) -> String {
        let values = match (self.name, self.width) {
            ("gnss_position", _) => "latitude_rad, longitude_rad, altitude_m",
            (_, 1) => "values of shape (n,)",
            _ => "values of shape (n, 3)",
        };
        format!(
            "{}: {has}: give a tuple (t_s, {values}) in {}",
            self.name, self.unit
        )
    }

    pub(super) fn is_possible(&self, row: &[f64; 3]) -> bool {
        let (least, most) = self.range;
        let in_range = row
            .iter()
            .take(self.width)
            .all(|v| (least..=most).contains(v));
        let [latitude, longitude, _] = row;
        in_range
            && (self.name != "gnss_position"
                || (latitude.abs() <= std::f64::consts::FRAC_PI_2
                    && longitude.abs() <= std::f64::consts::TAU))
    }

    pub(super) fn bounds(&self) -> String {
        if self.name == "gnss_position" {
            return ", latitudes between -π/2 and π/2".to_owned();
        }
        format!(", between {} and {}", self.range.0, self.range.1)
    }
}

/// Marks the rows of which a masked array hides a value.
fn mask(array: &Bound<'_, PyAny>, rows: &mut [bool]) -> PyResult<()> {
    let masks = array.py().import("numpy.ma")?;
    if !masks.call_method1("isMaskedArray", (array,))?.extract()? {
        return Ok(());
    }
    let mask = masks.call_method1("getmaskarray", (array,))?;
    let (_, hidden) = numbers("mask", &mask.call_method1("astype", ("int8",))?)?;
    let width = hidden.len() / rows.len().max(1);
    for (row, hidden) in rows.iter_mut().zip(hidden.chunks(width.max(1))) {
        *row |= hidden.iter().any(|value| *value != 0.0);
    }
    Ok(())
}

fn check_times(name: &str, times_s: &[f64]) -> PyResult<()> {
    let mut before = f64::NEG_INFINITY;
    for (at, time_s) in times_s.iter().enumerate() {
        if !time_s.is_finite() {
            return Err(PyValueError::new_err(format!(
                "{name}: t_s[{at}] is {time_s}: times must be finite"
            )));
        }
        if *time_s < before {
            return Err(PyValueError::new_err(format!(
                "{name}: t_s[{at}] is {time_s}, after {before}: times must not decrease; sort them"
            )));
        }
        before = *time_s;
    }
    Ok(())
}

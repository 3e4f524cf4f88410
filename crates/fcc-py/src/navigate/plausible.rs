//! Whether the times of the sources are of one clock.

use std::ffi::CString;

use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;

use super::kind::{KINDS, Kind, Series};

/// The filter connects no samples of an inertial unit further apart than this, s, and keeps
/// none for longer than that.
const CONNECTED_S: f64 = 0.2;
const KEPT_S: f64 = 0.5;
/// By how much a source may begin and end beside the inertial samples, s.
const BESIDE_S: f64 = 1.0;

/// Refuses what nothing can be computed from, and warns of what is unlikely.
pub(super) fn check(py: Python<'_>, series: &[Option<Series>]) -> PyResult<()> {
    let given: Vec<(&Kind, &Series)> = KINDS
        .iter()
        .zip(series)
        .filter_map(|(kind, series)| Some((kind, series.as_ref()?)))
        .collect();
    // A gyroscope, or else an accelerometer.
    let Some((driving, others)) = given.split_first() else {
        return Ok(());
    };
    let mut unlikely = Vec::new();
    unlikely.extend(period(driving)?);
    for other in others {
        unlikely.extend(clock(driving, other)?);
    }
    for words in unlikely {
        PyErr::warn(
            py,
            &py.get_type::<PyUserWarning>(),
            &CString::new(words)?,
            1,
        )?;
    }
    Ok(())
}

fn period((kind, series): &(&Kind, &Series)) -> PyResult<Option<String>> {
    let mut periods_s: Vec<f64> = series
        .times_s
        .iter()
        .zip(series.times_s.iter().skip(1))
        .map(|(before, after)| after - before)
        .collect();
    periods_s.sort_by(f64::total_cmp);
    let middle_s = periods_s.get(periods_s.len() / 2).copied().unwrap_or(0.0);
    if middle_s <= 0.0 && !periods_s.is_empty() {
        return Err(PyValueError::new_err(format!(
            "{}: most of its times are equal: give them as float64 (float32 has seven digits)",
            kind.name
        )));
    }
    if middle_s <= CONNECTED_S {
        return Ok(None);
    }
    let words = format!(
        "{}: its samples are {middle_s} s apart (median), and not connected beyond {CONNECTED_S} \
         s: times are in s",
        kind.name
    );
    if middle_s >= KEPT_S {
        return Err(PyValueError::new_err(words));
    }
    Ok(Some(words))
}

fn clock(
    (driving, inertial): &(&Kind, &Series),
    (kind, series): &(&Kind, &Series),
) -> PyResult<Option<String>> {
    let span = |of: &Series| of.times_s.first().copied().zip(of.times_s.last().copied());
    let (Some((begin_s, end_s)), Some((first_s, last_s))) = (span(inertial), span(series)) else {
        return Ok(None);
    };
    let within = begin_s - BESIDE_S..=end_s + BESIDE_S;
    let n = series.times_s.len();
    let inside = series.times_s.iter().filter(|t| within.contains(t)).count();
    let words = format!(
        "{}: {inside} of its {n} samples are within the time of the {}: it covers {first_s} to \
         {last_s} s, the {} {begin_s} to {end_s} s; give times of one clock, in s",
        kind.name, driving.name, driving.name
    );
    match inside {
        0 => Err(PyValueError::new_err(words)),
        _ if 2 * inside < n => Ok(Some(words)),
        _ => Ok(None),
    }
}

//! Of which clock, unit and axes samples seem to be: each may be possible, and all together
//! not.

use std::ffi::CString;

use fcc_navigation::inertial::{Innovation, Solution};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;

use super::kind::{KINDS, Kind, Series};
use super::mounting::Mounting;
use super::result::SENSORS;
use super::units::{backward, field, upside_down, weight};

/// The filter connects no samples of an inertial unit further apart than this, s, and keeps
/// none for longer than that.
const CONNECTED_S: f64 = 0.2;
const KEPT_S: f64 = 0.5;
/// The end of the range of most gyroscopes: 2,000 °/s. One sample of so many may be beyond.
const LARGEST_RATE: f64 = 35.0;
const RARELY: usize = 1_000;
/// By how much a source may begin and end beside the inertial samples, s.
const BESIDE_S: f64 = 1.0;

/// The zero-rate output of an MPU-6050 is within 20 °/s (product specification, revision 3.4,
/// section 6.1), and its zero-g output within 80 mg (section 6.2), rad/s, m/s²: an accelerometer
/// with twice as much is turned, or another one.
const LARGEST_RATE_BIAS: f64 = 0.349;
const LARGEST_FORCE_BIAS: f64 = 1.6;
/// Fewer samples of a source say nothing of it.
const LEAST_JUDGED: usize = 20;

/// Refuses what nothing can be computed from, and warns of what is unlikely.
pub(super) fn check(
    py: Python<'_>,
    series: &[Option<Series>],
    mounting: &Mounting,
) -> PyResult<()> {
    let given: Vec<(&Kind, &Series)> = KINDS
        .iter()
        .zip(series)
        .filter_map(|(kind, series)| Some((kind, series.as_ref()?)))
        .collect();
    // A gyroscope, or else an accelerometer.
    let Some((driving, others)) = given.split_first() else {
        return Ok(());
    };
    let of = |name: &str| given.iter().find(|(kind, _)| kind.name == name);
    let mut unlikely = Vec::new();
    unlikely.extend(period(driving)?);
    for other in others {
        unlikely.extend(clock(driving, other)?);
    }
    let (gyroscope, magnetometer) = (of("gyroscope"), of("magnetometer"));
    unlikely.extend(gyroscope.and_then(|(_, gyroscope)| rates(gyroscope)));
    unlikely.extend(magnetometer.and_then(|(_, magnetometer)| field(magnetometer)));
    let accelerometer = of("accelerometer");
    let heavy = accelerometer.and_then(|source| weight(*source));
    let turned = || accelerometer.and_then(|source| upside_down(*source, mounting));
    unlikely.extend(heavy.or_else(turned));
    unlikely.extend(given.iter().filter_map(|source| backward(*source)));
    warn(py, unlikely)
}

pub(super) fn warn(py: Python<'_>, unlikely: impl IntoIterator<Item = String>) -> PyResult<()> {
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

/// Warns of a bias that no sensor has: another source contradicts it.
pub(super) fn biases(py: Python<'_>, solutions: &[Solution]) -> PyResult<()> {
    let largest = |of: fn(&Solution) -> [f64; 3]| {
        let all = solutions.iter().flat_map(of).filter(|one| one.is_finite());
        all.fold(0.0, |most: f64, one| most.max(one.abs()))
    };
    let rate = largest(|solution| solution.gyroscope_bias_radps);
    let force = largest(|solution| solution.accelerometer_bias_mps2);
    let of_rate = (rate > LARGEST_RATE_BIAS).then(|| {
        format!(
            "gyroscope: a bias of {:.0} °/s is found, and most have less than {:.0}",
            rate.to_degrees(),
            LARGEST_RATE_BIAS.to_degrees()
        )
    });
    let of_force = (force > LARGEST_FORCE_BIAS).then(|| {
        format!(
            "accelerometer: a bias of {force:.1} m/s² is found, and most have less than \
             {LARGEST_FORCE_BIAS}"
        )
    });
    let question = "are units, signs, axes and times right, of it and of the other sources?";
    let found = of_rate.into_iter().chain(of_force);
    warn(py, found.map(|found| format!("{found}: {question}")))
}

/// Warns of a source most of whose samples are refused.
pub(super) fn agree(py: Python<'_>, innovations: &[Innovation]) -> PyResult<()> {
    warn(
        py,
        SENSORS.iter().filter_map(|(kind, name, _)| {
            let of = || innovations.iter().filter(|one| one.kind == *kind);
            let (all, accepted) = (of().count(), of().filter(|one| one.accepted).count());
            (all >= LEAST_JUDGED && 2 * accepted < all).then(|| {
                format!(
                    "{name}: {accepted} of the {all} samples that were judged agree with the other \
                     sources: are units, signs, axes and times right, of it and of the others?"
                )
            })
        }),
    )
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
         s: times are in s; are they in milliseconds?",
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

fn rates(gyroscope: &Series) -> Option<String> {
    let strength = |row: &[f64; 3]| row.iter().map(|along| along * along).sum::<f64>().sqrt();
    let beyond = gyroscope
        .rows
        .iter()
        .filter(|row| strength(row) > LARGEST_RATE)
        .count();
    (beyond * RARELY > gyroscope.rows.len()).then(|| {
        format!(
            "gyroscope: {beyond} of {} samples are beyond {LARGEST_RATE} rad/s (2,000 °/s), which \
             most gyroscopes cannot show: rates are in rad/s; are they in °/s?",
            gyroscope.rows.len()
        )
    })
}

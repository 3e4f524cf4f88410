//! Of which clock, unit and axes samples seem to be: each may be possible, and all together
//! not.

use std::ffi::CString;

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::inertial::{Innovation, Solution, metres_per_radian};
use fcc_core::units::FOOT_M;
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;

use super::clocks::{Heading, late};
use super::kind::{KINDS, Kind, Series};
use super::mounting::Mounting;
use super::pressures::{airspeed, in_feet};
use super::repeats::repeats;
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
/// Displacements are compared over at least this time, s, if their root mean square is more
/// than some errors of a receiver: horizontal and vertical, m.
pub(super) const WINDOW_S: f64 = 5.0;
const FAR_M: f64 = 10.0;
const HIGH_M: f64 = 2.0;
/// Other axes explain them if so much of the squares is left by those that were given, as a
/// multiple of what they leave.
pub(super) const CLEARLY: f64 = 4.0;

/// The zero-rate output of an MPU-6050 is within 20 °/s (product specification, revision 3.4,
/// section 6.1), and its zero-g output within 80 mg (section 6.2), rad/s, m/s²: an accelerometer
/// with twice as much is turned, or another one.
const LARGEST_RATE_BIAS: f64 = 0.349;
const LARGEST_FORCE_BIAS: f64 = 1.6;
/// Fewer samples of a source say nothing of it.
const LEAST_JUDGED: usize = 20;
/// Other units of velocity, m/s.
const OTHER_SPEEDS: [(&str, f64); 4] = [
    ("km/h", 1.0 / 3.6),
    ("kt", 1852.0 / 3600.0),
    ("ft/s", 0.3048),
    ("cm/s", 0.01),
];

/// Refuses what nothing can be computed from, and warns of what is unlikely.
pub(super) fn check(
    py: Python<'_>,
    series: &[Option<Series>],
    delays_s: &[f64],
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
    let (position, velocity) = (of("gnss_position"), of("gnss_velocity"));
    if let (Some(position), Some(velocity)) = (position, velocity) {
        unlikely.extend(axes(*position, *velocity));
    }
    let samples = |name| of(name).map(|(_, series)| *series);
    let barometer = samples("static_pressure");
    let shown = position.zip(barometer);
    unlikely.extend(shown.and_then(|(position, barometer)| in_feet(*position, barometer)));
    if let Some((_, velocity)) = velocity {
        let of_air = |source: &(&Kind, &Series)| airspeed(*source, velocity, barometer);
        unlikely.extend(given.iter().filter_map(of_air));
    }
    let (turning, shaken) = (samples("gyroscope"), samples("accelerometer"));
    let repeated = |source: &(&Kind, &Series)| repeats(*source, turning, shaken);
    unlikely.extend(given.iter().filter_map(repeated));
    let heading = gyroscope
        .zip(accelerometer)
        .and_then(|(rates, forces)| Heading::of(*rates, *forces, mounting));
    if let Some(heading) = heading {
        let all = KINDS.iter().zip(series).zip(delays_s);
        let receivers = all.filter(|((kind, _), _)| kind.is_of_receiver());
        unlikely.extend(receivers.filter_map(|((kind, series), delay_s)| {
            late((kind, series.as_ref()?), *delay_s, &heading)
        }));
    }
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

/// Whether how the position moves is the velocity with other axes, or in another unit.
fn axes((kind, position): (&Kind, &Series), velocity: (&Kind, &Series)) -> Option<String> {
    let path = path(velocity);
    let mut begin: Option<(f64, [f64; 3], [f64; 3])> = None;
    let (mut windows, mut far, mut high) = (0.0, 0.0, 0.0);
    let (mut given, mut swapped, mut down, mut up) = (0.0, 0.0, 0.0, 0.0);
    let (mut moved, mut both, mut in_ft) = (0.0, 0.0, 0.0);
    let square = |value: f64| value * value;
    for (time_s, place) in position.times_s.iter().zip(&position.rows) {
        let Some(there) = kind
            .is_possible(place)
            .then(|| along(&path, *time_s))
            .flatten()
        else {
            continue;
        };
        let Some((since_s, from, here)) = begin else {
            begin = Some((*time_s, *place, there));
            continue;
        };
        if time_s - since_s < WINDOW_S {
            continue;
        }
        begin = Some((*time_s, *place, there));
        // Across a gap the velocity is not known.
        if time_s - since_s > 2.0 * WINDOW_S {
            continue;
        }
        let (per_latitude, per_longitude) = metres_per_radian(from[0], from[2]);
        let moved_north = (place[0] - from[0]) * per_latitude;
        let moved_east = wrap_pi(place[1] - from[1]) * per_longitude;
        let moved_down = from[2] - place[2];
        let [north, east, sunk] = plus(there, -1.0, here);
        windows += 1.0;
        far += square(north) + square(east);
        high += square(sunk);
        moved += square(moved_north) + square(moved_east);
        both += moved_north * north + moved_east * east;
        given += square(moved_north - north) + square(moved_east - east);
        swapped += square(moved_north - east) + square(moved_east - north);
        down += square(moved_down - sunk);
        up += square(moved_down + sunk);
        in_ft += square(FOOT_M * moved_down - sunk);
    }
    let unit = OTHER_SPEEDS.iter().find(|(_, mps)| {
        let scaled = moved - 2.0 * mps * both + square(*mps) * far;
        far.min(moved) > windows * square(FAR_M) && given > CLEARLY * CLEARLY * scaled
    });
    if let Some((unit, _)) = unit {
        return Some(format!(
            "gnss_velocity: it agrees with how gnss_position moves if it is in {unit}: velocities \
             are in m/s"
        ));
    }
    if high > windows * square(HIGH_M) && down > CLEARLY * CLEARLY * in_ft {
        return Some(
            "gnss_position: altitudes move as gnss_velocity says if they are in ft: they are in m"
                .to_owned(),
        );
    }
    let is_swapped = far > windows * square(FAR_M) && given > CLEARLY * swapped;
    let is_upward = high > windows * square(HIGH_M) && down > CLEARLY * up;
    let as_what = match (is_swapped, is_upward) {
        (true, true) => "as east, north, up",
        (true, false) => "with north and east swapped",
        (false, true) => "with down for up",
        (false, false) => return None,
    };
    Some(format!(
        "gnss_velocity: it agrees with how gnss_position moves {as_what}: give north, east, down, \
         and latitude before longitude"
    ))
}

/// The integral of the velocity, m, at the times of its samples.
fn path((kind, velocity): (&Kind, &Series)) -> Vec<(f64, [f64; 3])> {
    let mut path: Vec<(f64, [f64; 3])> = Vec::new();
    let mut before = [0.0; 3];
    for (time_s, now) in velocity.times_s.iter().zip(&velocity.rows) {
        if !kind.is_possible(now) {
            continue;
        }
        let (last_s, at) = path.last().copied().unwrap_or((*time_s, [0.0; 3]));
        let half_s = 0.5 * (time_s - last_s);
        path.push((*time_s, plus(at, half_s, plus(before, 1.0, *now))));
        before = *now;
    }
    path
}

/// Where it is at a time, if that is between its ends.
fn along(path: &[(f64, [f64; 3])], time_s: f64) -> Option<[f64; 3]> {
    let next = path.partition_point(|(then_s, _)| *then_s < time_s);
    let (after_s, after) = path.get(next)?;
    let (before_s, before) = path.get(next.checked_sub(1)?)?;
    let share = (time_s - before_s) / (after_s - before_s);
    Some(plus(*before, share, plus(*after, -1.0, *before)))
}

fn plus([a, b, c]: [f64; 3], share: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + share * x, b + share * y, c + share * z]
}

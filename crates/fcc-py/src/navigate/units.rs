//! Whether samples seem to be in another unit, or of the other sign.

use std::ops::RangeInclusive;

use super::kind::{Kind, Series};
use super::mounting::Mounting;

/// The earth's field has this strength, µT (World Magnetic Model 2025), and a sensor that is
/// not calibrated shows so many times as much or as little.
const FIELD_UT: (f64, f64) = (22.0, 67.0);
const UNCALIBRATED: f64 = 2.0;
const OTHER_UNITS_UT: [(&str, f64); 4] = [
    ("tesla", 1e6),
    ("millitesla", 1e3),
    ("gauss", 100.0),
    ("milligauss", 0.1),
];
/// Wind from behind before a take-off is less than this, m/s, and its pressure, Pa; one of so
/// many samples may be beyond.
const BACKWARD_MPS: f64 = -5.0;
const BACKWARD_PA: f64 = -15.0;
const SELDOM: usize = 10;
/// What is not upside down shows specific force upwards: its middle one downwards by more
/// than this, m/s², is of another sign, or of an aircraft on its back.
const DOWNWARD_MPS2: f64 = 5.0;
/// The middle strength of a force, m/s²: half of gravity to that of a turn at 60° of bank.
const WEIGHT_MPS2: RangeInclusive<f64> = 5.0..=20.0;

/// The middle one of the strengths.
pub(super) fn middle_strength(rows: &[[f64; 3]]) -> Option<f64> {
    let mut strengths: Vec<f64> = rows
        .iter()
        .map(|row| dot(*row, *row).sqrt())
        .filter(|strength| strength.is_finite())
        .collect();
    strengths.sort_by(f64::total_cmp);
    strengths.get(strengths.len() / 2).copied()
}

/// Why a field is not that of the earth.
pub(super) fn field(magnetometer: &Series) -> Option<String> {
    let (weakest, strongest) = FIELD_UT;
    let middle = middle_strength(&magnetometer.rows)?;
    if (weakest / UNCALIBRATED..=strongest * UNCALIBRATED).contains(&middle) {
        return None;
    }
    let is_earths = |ut: f64| (weakest..=strongest).contains(&ut);
    let unit = OTHER_UNITS_UT.iter().find(|(_, ut)| is_earths(middle * ut));
    let question = unit.map_or_else(
        || "is it calibrated?".to_owned(),
        |(unit, _)| format!("is it in {unit}?"),
    );
    let middle = if middle < 0.1 {
        format!("{middle:.1e}")
    } else {
        format!("{middle:.1}")
    };
    Some(format!(
        "magnetometer: the strength of its middle sample is {middle}, and the earth's field has \
         {weakest} to {strongest} µT, so it is left out: {question}"
    ))
}

/// Whether a force is that of gravity in another unit, or without it.
pub(super) fn weight((kind, accelerometer): (&Kind, &Series)) -> Option<String> {
    let rows: Vec<[f64; 3]> = accelerometer
        .rows
        .iter()
        .filter(|row| kind.is_possible(row))
        .copied()
        .collect();
    let middle = middle_strength(&rows)?;
    (!WEIGHT_MPS2.contains(&middle)).then(|| {
        format!(
            "accelerometer: the strength of its middle sample is {middle:.1}: it is in m/s², 9.8 \
             at rest and in level flight; is it in another unit, or without gravity?"
        )
    })
}

/// Whether the force of the accelerometer points the wrong way.
pub(super) fn upside_down(
    (kind, accelerometer): (&Kind, &Series),
    mounting: &Mounting,
) -> Option<String> {
    let mut downward: Vec<f64> = accelerometer
        .rows
        .iter()
        .filter(|row| kind.is_possible(row))
        .map(|row| mounting.body(kind.name, *row)[2])
        .collect();
    downward.sort_by(f64::total_cmp);
    let middle = *downward.get(downward.len() / 2)?;
    (middle > DOWNWARD_MPS2).then(|| {
        format!(
            "accelerometer: its middle sample is {middle:.1} m/s² downwards, as upside down: \
             level and at rest it shows (0, 0, -9.8); is the sign wrong, or the mounting?"
        )
    })
}

/// Whether an airspeed, or its pressure, is negative.
pub(super) fn backward((kind, series): (&Kind, &Series)) -> Option<String> {
    let least = match kind.name {
        "airspeed" => BACKWARD_MPS,
        "differential_pressure" => BACKWARD_PA,
        _ => return None,
    };
    let n = series.rows.len();
    let below = series.rows.iter().filter(|[v, ..]| *v < least).count();
    (below * SELDOM > n).then(|| {
        format!(
            "{}: {below} of {n} samples are below {least} {}: in flight it is positive; is the \
             sign wrong, or are the tubes exchanged?",
            kind.name, kind.unit
        )
    })
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

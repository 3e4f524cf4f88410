//! Whether samples seem to be in another unit, or of the other sign.

use super::kind::{Kind, Series};
use super::mounting::Mounting;
use super::plausible::{CLEARLY, WINDOW_S, plus};

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
/// Turns of the field are compared in at least so many windows.
const LEAST_WINDOWS: usize = 3;

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

/// Whether the field turns by the rates if these are in °/s, and neither by them as they are
/// nor not at all.
pub(super) fn turns(
    (rates_kind, gyroscope): (&Kind, &Series),
    (field_kind, magnetometer): (&Kind, &Series),
    mounting: &Mounting,
) -> Option<String> {
    let mut rates = possible(rates_kind, gyroscope, mounting).peekable();
    let mut window: Option<Window> = None;
    let (mut windows, mut given, mut degrees, mut still) = (0, 0.0, 0.0, 0.0);
    for (time_s, field) in possible(field_kind, magnetometer, mounting) {
        if let Some(window) = &mut window {
            while let Some((until_s, rate)) = rates.next_if(|(at_s, _)| *at_s <= time_s) {
                window.turn(until_s, rate);
            }
            if time_s - window.begin_s < WINDOW_S {
                continue;
            }
            windows += 1;
            given += distance_2(field, window.by_given);
            degrees += distance_2(field, window.by_degrees);
            still += distance_2(field, window.still);
        }
        window = Some(Window {
            begin_s: time_s,
            until_s: time_s,
            still: field,
            by_given: field,
            by_degrees: field,
        });
    }
    (windows >= LEAST_WINDOWS && given.min(still) > CLEARLY * degrees).then(|| {
        "gyroscope: the field of the magnetometer turns as if rates were in °/s: they are in \
         rad/s; are they in °/s?"
            .to_owned()
    })
}

/// Samples in the body's axes.
fn possible(
    kind: &Kind,
    series: &Series,
    mounting: &Mounting,
) -> impl Iterator<Item = (f64, [f64; 3])> {
    let samples = series.times_s.iter().zip(&series.rows);
    samples
        .filter(|(_, row)| kind.is_possible(row))
        .map(|(time_s, row)| (*time_s, mounting.body(kind.name, *row)))
}

/// The field at the begin of a window, as it would be now.
struct Window {
    begin_s: f64,
    until_s: f64,
    still: [f64; 3],
    by_given: [f64; 3],
    by_degrees: [f64; 3],
}

impl Window {
    fn turn(&mut self, until_s: f64, rate: [f64; 3]) {
        let time_s = (until_s - self.until_s).max(0.0);
        self.until_s = self.until_s.max(until_s);
        self.by_given = turned(self.by_given, rate.map(|along| along * time_s));
        let degrees = rate.map(|along| (along * time_s).to_radians());
        self.by_degrees = turned(self.by_degrees, degrees);
    }
}

/// What stays where it is, in axes that are turned by this angle around its direction, rad
/// (Rodrigues 1840).
fn turned(vector: [f64; 3], angle: [f64; 3]) -> [f64; 3] {
    let size = dot(angle, angle).sqrt();
    if size < f64::EPSILON {
        return vector;
    }
    let axis = angle.map(|along| along / size);
    let along = dot(axis, vector) * (1.0 - size.cos());
    let kept = plus([0.0; 3], size.cos(), vector);
    plus(plus(kept, size.sin(), cross(vector, axis)), along, axis)
}

fn distance_2(one: [f64; 3], other: [f64; 3]) -> f64 {
    let apart = plus(one, -1.0, other);
    dot(apart, apart)
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

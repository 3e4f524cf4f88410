//! The picture of a calibration at work, in text.

use std::fmt::Write as _;

use fcc_calibration::{CELLS, CELLS_OF_BANDS, Coverage, GuidedCalibration, Place};
use fcc_core::flight::Measurements;
use fcc_flight::calibrate::{CalibrationKind, words};

/// Characters of the bar.
const BAR: usize = 40;

/// What there is, what is missing, the values, and what to do next.
pub(super) fn picture(
    kind: CalibrationKind,
    guided: &GuidedCalibration,
    measured: &Measurements,
) -> String {
    let mut text = String::new();
    match guided.coverage() {
        Coverage::Places(held) => places(&mut text, held),
        Coverage::Cells(covered) => cells(&mut text, covered),
        Coverage::Turns(known) => turns(&mut text, known),
        Coverage::None => {}
    }
    let bar = bar(guided.progress(), BAR);
    let percent = 100.0 * guided.progress();
    let rest = if guided.is_at_rest() {
        "at rest"
    } else {
        "moving"
    };
    let _ = writeln!(text, "  {bar} {percent:3.0} %   {rest}");
    let _ = writeln!(text, "  {}", values(kind, measured));
    let _ = write!(text, "  → {}", words(guided.next()));
    text
}

/// So much of a bar.
fn bar(share: f64, length: usize) -> String {
    let done = (share * length as f64).round() as usize;
    "█".repeat(done) + &"·".repeat(length - done.min(length))
}

/// How much is known of turns about each axis.
fn turns(text: &mut String, known: [f64; 3]) {
    for (share, axis) in known.into_iter().zip(["x", "y", "z"]) {
        let bar = bar(share, BAR / 2);
        let _ = writeln!(text, "  turned about {axis}  {bar} {:3.0} %", 100.0 * share);
    }
}

/// The faces as an unfolded cube, and the edges of each two axes.
fn places(text: &mut String, held: [bool; Place::ALL.len()]) {
    let mark = |name: &str| {
        let mut all = Place::ALL.iter().zip(held);
        let is_held = all.find(|(place, _)| place.to_string() == name);
        if is_held.is_some_and(|(_, held)| held) {
            format!("[{name}]")
        } else {
            format!(" {name} ")
        }
    };
    let edges = |from: usize| {
        let names = Place::ALL.iter().skip(from).take(4);
        let marked: Vec<_> = names.map(|place| mark(&place.to_string())).collect();
        marked.join(" ")
    };
    let [a, b, c, d, e, f] = ["+z", "-y", "+x", "+y", "-x", "-z"].map(mark);
    let _ = writeln!(text, "        {a}             edges, two of each row:");
    let _ = writeln!(text, "  {b}  {c}  {d}  {e}     {}", edges(6));
    let _ = writeln!(text, "        {f}             {}", edges(10));
    let _ = writeln!(text, "{:33}{}", "", edges(14));
}

/// The sphere, unrolled: from +z above to -z below.
fn cells(text: &mut String, covered: &[bool; CELLS]) {
    let mut left = covered.as_slice();
    let names = ["+z", "", "-x  -y  +x  +y  -x", "", "-z"];
    for (count, name) in CELLS_OF_BANDS.into_iter().zip(names) {
        let (band, rest) = left.split_at_checked(count).unwrap_or((left, &[]));
        left = rest;
        let width = 3 * CELLS_OF_BANDS.iter().max().unwrap_or(&0) / count;
        let marks = band.iter().map(|is_covered| {
            let mark = if *is_covered { "█" } else { "·" };
            mark.repeat(width - 1) + " "
        });
        let _ = writeln!(text, "  {}  {name}", marks.collect::<String>());
    }
}

/// What the sensor gives, uncalibrated.
fn values(kind: CalibrationKind, measured: &Measurements) -> String {
    let axes = |values: [f64; 3], unit: &str| {
        let [x, y, z] = values;
        format!("x {x:8.3}  y {y:8.3}  z {z:8.3} {unit}")
    };
    let (f, r, m) = (
        measured.raw_specific_force.value,
        measured.raw_body_rates.value,
        measured.magnetic_field.value,
    );
    match kind {
        CalibrationKind::Accelerometer | CalibrationKind::Mounting => {
            axes([f.x_mps2, f.y_mps2, f.z_mps2], "m/s²")
        }
        CalibrationKind::Gyroscope => {
            let rates = [r.roll_radps, r.pitch_radps, r.yaw_radps];
            axes(rates.map(f64::to_degrees), "°/s")
        }
        CalibrationKind::Magnetometer => axes([m.x_ut, m.y_ut, m.z_ut], "µT"),
        CalibrationKind::Airspeed => {
            format!("{:.1} Pa", measured.differential_pressure_pa.value)
        }
    }
}

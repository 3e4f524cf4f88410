//! Actual values, set points, and the positions of the controls.

use fcc_core::framework::{Reading, RecordOf, State};
use fcc_fixed_wing::Autopilot;
use fcc_telemetry::ShownAltitude;
use fcc_telemetry::units::{M_FT, MPS_KT};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Stylize;
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use crate::picture::Picture;

const MPS_FPM: f64 = 60.0 * M_FT;

/// Width of a control's name and value.
const LABEL_WIDTH: usize = 15;

/// Draws the table and, below it, the controls.
pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, picture: &Picture<Autopilot>) {
    let Some(record) = &picture.record else {
        return;
    };
    let mut lines = table(record);
    lines.extend(controls(record, usize::from(area.width)));
    frame.render_widget(Paragraph::new(lines), area);
}

/// A quantity as it is and as it should be, in the units of aviation.
pub(super) struct Quantity {
    name: &'static str,
    unit: &'static str,
    /// Its name for other tools.
    pub(super) key: &'static str,
    digits: usize,
    pub(super) actual: Option<f64>,
    pub(super) desired: f64,
}

/// What is flown by.
pub(super) fn quantities(record: &RecordOf<Autopilot>) -> [Quantity; 6] {
    let (measured, wanted) = (&record.measurements, &record.setpoints);
    let compass = |rad: f64| rad.to_degrees().rem_euclid(360.0);
    let of = |(name, unit, key), digits, actual, desired| Quantity {
        name,
        unit,
        key,
        digits,
        actual,
        desired,
    };
    let (heading, altitude) = (known(&measured.heading_rad), known(&measured.altitude_m));
    let shown = ShownAltitude::of(record);
    let above = |m: f64| (m - shown.datum_m) * M_FT;
    let airspeed = known(&measured.airspeed_mps).map(|mps| mps * MPS_KT);
    let climb = known(&measured.velocity).map(|velocity| -velocity.down_mps * MPS_FPM);
    let attitude = known(&measured.attitude);
    let bank = attitude.map(|attitude| attitude.roll_rad.to_degrees());
    let pitch = attitude.map(|attitude| attitude.pitch_rad.to_degrees());
    [
        of(
            ("heading", "°", "heading_deg"),
            1,
            heading.map(compass),
            compass(wanted.heading_rad),
        ),
        of(
            (altitude_name(&shown), "ft", "altitude_ft"),
            0,
            altitude.map(above),
            above(wanted.altitude_m),
        ),
        of(
            ("airspeed", "kt", "airspeed_kt"),
            1,
            airspeed,
            wanted.airspeed_mps * MPS_KT,
        ),
        of(
            ("climb", "fpm", "climb_fpm"),
            0,
            climb,
            wanted.climb_rate_mps * MPS_FPM,
        ),
        of(
            ("bank", "°", "bank_deg"),
            1,
            bank,
            wanted.roll_rad.to_degrees(),
        ),
        of(
            ("pitch", "°", "pitch_deg"),
            1,
            pitch,
            wanted.pitch_rad.to_degrees(),
        ),
    ]
}

/// What kind of altitude it is, in the room for a name.
fn altitude_name(shown: &ShownAltitude) -> &'static str {
    match shown.name {
        "pressure altitude" => "pressure",
        name => name,
    }
}

/// What was ever measured.
fn known<T: Copy>(reading: &Reading<T>) -> Option<T> {
    (!reading.is_never()).then_some(reading.value)
}

fn table(record: &RecordOf<Autopilot>) -> Vec<Line<'static>> {
    let engaged = record.state == State::Engaged;
    let row = |quantity: Quantity| {
        let digits = quantity.digits;
        let number = |value: Option<f64>| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
        };
        let desired = Some(quantity.desired).filter(|_| engaged);
        Line::from(vec![
            format!("{:<8}", quantity.name).dim(),
            format!("{:>6}", number(quantity.actual)).bold(),
            " → ".dim(),
            format!("{:>6}", number(desired)).into(),
            format!(" {}", quantity.unit).dim(),
        ])
    };
    quantities(record).map(row).into()
}

fn controls(record: &RecordOf<Autopilot>, width: usize) -> Vec<Line<'static>> {
    let outputs = &record.outputs;
    let room = width.saturating_sub(LABEL_WIDTH).max(3);
    [
        ("throttle", outputs.throttle, bar(outputs.throttle, room)),
        (
            "elevator",
            outputs.elevator,
            deflection(outputs.elevator, room),
        ),
        (
            "aileron",
            outputs.aileron,
            deflection(outputs.aileron, room),
        ),
        ("rudder", outputs.rudder, deflection(outputs.rudder, room)),
    ]
    .into_iter()
    .map(|(name, value, bar)| {
        if !record.sent {
            return Line::from(vec![
                format!("{name:<8}").dim(),
                " not controlled".dim().italic(),
            ]);
        }
        Line::from(vec![
            format!("{name:<8} ").dim(),
            bar,
            format!(" {value:+5.2}").bold(),
        ])
    })
    .collect()
}

/// 0 to 1, from the left.
fn bar(value: f64, room: usize) -> Span<'static> {
    let full = (value.clamp(0.0, 1.0) * room as f64).round() as usize;
    let bar: String = (0..room)
        .map(|column| if column < full { '█' } else { '·' })
        .collect();
    bar.green()
}

/// -1 to 1, from the middle.
fn deflection(value: f64, room: usize) -> Span<'static> {
    // As much room on either side.
    let middle = (room - 1) / 2;
    let spare = room - (2 * middle + 1);
    let room = room - spare;
    let reach = (value.clamp(-1.0, 1.0) * middle as f64).round() as i64;
    let at = middle as i64 + reach;
    let bar: String = (0..room as i64)
        .map(|column| {
            let middle = middle as i64;
            if column == middle {
                '┃'
            } else if (column > middle && column <= at) || (column < middle && column >= at) {
                '█'
            } else {
                '·'
            }
        })
        .chain(std::iter::repeat_n(' ', spare))
        .collect();
    bar.cyan()
}

//! What is flown: actual values, set points, and where the controls stand.

use fcc_core::flight::Autopilot;
use fcc_core::framework::{RecordOf, State};
use fcc_telemetry::units::{M_FT, MPS_KT};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Stylize;
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use crate::picture::Picture;

const MPS_FPM: f64 = 60.0 * M_FT;

/// Characters of a control's name and of its number.
const WORDS: usize = 15;

/// Draws the table and, below it, the controls.
pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, picture: &Picture<Autopilot>) {
    let Some(record) = &picture.record else {
        return;
    };
    let mut lines = table(record);
    lines.extend(controls(record, usize::from(area.width)));
    frame.render_widget(Paragraph::new(lines), area);
}

fn table(record: &RecordOf<Autopilot>) -> Vec<Line<'static>> {
    let measured = &record.measurements;
    let aims = &record.setpoints;
    let engaged = record.state == State::Engaged;
    let row = |name: &'static str, unit: &'static str, digits: usize, now: Option<f64>, aim| {
        let now = now.map_or_else(|| "–".to_owned(), |now| format!("{now:.digits$}"));
        let aim = if engaged {
            format!("{aim:.digits$}")
        } else {
            "–".to_owned()
        };
        Line::from(vec![
            format!("{name:<8}").dim(),
            format!("{now:>6}").bold(),
            " → ".dim(),
            format!("{aim:>6}").into(),
            format!(" {unit}").dim(),
        ])
    };
    let attitude = (!measured.attitude.is_never()).then_some(measured.attitude.value);
    let velocity = (!measured.velocity.is_never()).then_some(measured.velocity.value);
    let some = |reading: &fcc_core::framework::Reading<f64>| {
        (!reading.is_never()).then_some(reading.value)
    };
    vec![
        row(
            "heading",
            "°",
            1,
            some(&measured.heading_rad).map(|rad| rad.to_degrees().rem_euclid(360.0)),
            aims.heading_rad.to_degrees().rem_euclid(360.0),
        ),
        row(
            "altitude",
            "ft",
            0,
            some(&measured.altitude_m).map(|m| m * M_FT),
            aims.altitude_m * M_FT,
        ),
        row(
            "airspeed",
            "kt",
            1,
            some(&measured.airspeed_mps).map(|mps| mps * MPS_KT),
            aims.airspeed_mps * MPS_KT,
        ),
        row(
            "climb",
            "fpm",
            0,
            velocity.map(|velocity| -velocity.down_mps * MPS_FPM),
            aims.climb_rate_mps * MPS_FPM,
        ),
        row(
            "bank",
            "°",
            1,
            attitude.map(|attitude| attitude.roll_rad.to_degrees()),
            aims.roll_rad.to_degrees(),
        ),
        row(
            "pitch",
            "°",
            1,
            attitude.map(|attitude| attitude.pitch_rad.to_degrees()),
            aims.pitch_rad.to_degrees(),
        ),
    ]
}

fn controls(record: &RecordOf<Autopilot>, width: usize) -> Vec<Line<'static>> {
    let outputs = &record.outputs;
    let room = width.saturating_sub(WORDS).max(3);
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

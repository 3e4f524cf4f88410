//! What makes the flight possible: the stages of a tick, the sensors, the
//! recorder and the live telemetry itself.

use fcc_core::framework::{Reading, Time};
use fcc_live::{RecorderState, Status};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Stylize;
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::picture::Picture;
use super::timing::duration;

/// Older than this is worth a colour, ms: half of what the loop takes for a
/// loss unless told otherwise.
const OLD_MS: u128 = 125;

/// How long each stage took, now and at most.
pub(super) fn stages(frame: &mut Frame<'_>, area: Rect, picture: &Picture) {
    let Some(record) = &picture.record else {
        return;
    };
    let (now, most) = (&record.stages, &picture.longest);
    let lines: Vec<_> = [
        ("sensors", now.sensors_ns, most.sensors_ns),
        ("estimate", now.estimate_ns, most.estimate_ns),
        ("guide", now.guide_ns, most.guide_ns),
        ("control", now.control_ns, most.control_ns),
        ("actuat.", now.actuators_ns, most.actuators_ns),
        ("total", now.total_ns, most.total_ns),
    ]
    .into_iter()
    .map(|(name, now_ns, most_ns)| {
        Line::from(vec![
            format!("{name:<8}").dim(),
            format!("{:>7}", short(now_ns)).bold(),
            format!(" ≤{:>6}", short(most_ns)).into(),
        ])
    })
    .collect();
    frame.render_widget(Paragraph::new(lines), area);
}

/// A time without the space before its unit.
fn short(ns: u64) -> String {
    duration(ns).replace(' ', "")
}

/// How old each reading was at the tick.
pub(super) fn ages(frame: &mut Frame<'_>, area: Rect, picture: &Picture) {
    let Some(record) = &picture.record else {
        return;
    };
    let now = record.tick.woke;
    let m = &record.measurements;
    let rows = [
        [
            ("attitude", m.attitude.taken),
            ("AoA", m.angle_of_attack_rad.taken),
        ],
        [
            ("heading", taken(&m.heading_rad)),
            ("pos.", taken(&m.position)),
        ],
        [
            ("rates", taken(&m.body_rates)),
            ("vel.", taken(&m.velocity)),
        ],
        [
            ("force", taken(&m.specific_force)),
            ("surf.", taken(&m.surfaces)),
        ],
        [
            ("airspeed", taken(&m.airspeed_mps)),
            ("switch", taken(&m.engage_switch)),
        ],
        [
            ("altitude", taken(&m.altitude_m)),
            ("plant", taken(&m.plant)),
        ],
    ];
    let lines: Vec<_> = rows
        .into_iter()
        .map(|[left, right]| {
            let mut spans = age(left, 9, now).to_vec();
            spans.push(" ".into());
            spans.extend(age(right, 7, now));
            Line::from(spans)
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), area);
}

const fn taken<T>(reading: &Reading<T>) -> Time {
    reading.taken
}

fn age((name, taken): (&'static str, Time), width: usize, now: Time) -> [Span<'static>; 2] {
    let name = format!("{name:<width$}").dim();
    if taken.is_never() {
        return [name, "   –".dim()];
    }
    let age_ms = now.since(taken).as_millis();
    let words = if age_ms < 1_000 {
        format!("{age_ms:>2}ms")
    } else {
        format!("{}s", age_ms / 1_000)
    };
    let words = format!("{words:>4}");
    [
        name,
        if age_ms > OLD_MS {
            words.red().bold()
        } else {
            words.green()
        },
    ]
}

/// How recording goes, and who watches.
pub(super) fn recorder(frame: &mut Frame<'_>, area: Rect, picture: &Picture) {
    let Some(status) = &picture.status else {
        return;
    };
    let state = match status.recorder() {
        RecorderState::Off => "not recording".dim(),
        RecorderState::Recording => "recording".green().bold(),
        RecorderState::Stopped => "STOPPED".red().bold(),
    };
    let mut lines = vec![
        Line::from(state),
        Line::from(status.recording.as_str().to_owned()),
    ];
    if status.recorder() == RecorderState::Off {
        lines.truncate(1);
    } else {
        lines.push(Line::from(format!(
            "{} records, {}",
            status.recorded,
            size(status.recording_bytes)
        )));
        lines.push(lost("not recorded", status.not_recorded));
    }
    lines.push(watched(status, picture));
    lines.push(lost("not published", status.not_published));
    frame.render_widget(Paragraph::new(lines), area);
}

fn watched(status: &Status, picture: &Picture) -> Line<'static> {
    let percent = status.cpu_ns as f64 * 1e-7 / picture.seconds(status.time_ns).max(1.0);
    Line::from(format!("{} watching, {percent:.1} % CPU", status.watchers))
}

fn lost(name: &'static str, number: u64) -> Line<'static> {
    let words = format!("{number} {name}");
    if number == 0 {
        Line::from(words.dim())
    } else {
        Line::from(words.red().bold())
    }
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1_024 => format!("{bytes} B"),
        1_024..1_048_576 => format!("{} KiB", bytes / 1_024),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

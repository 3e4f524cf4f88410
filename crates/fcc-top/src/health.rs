//! Health of the loop: the stages of a tick, the sensors, the recorder and the
//! live telemetry.

use fcc_core::framework::{Readings as _, Stage, Time};
use fcc_live::{RecorderState, Status};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Stylize;
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::picture::Picture;
use super::timing::duration;
use super::watched::Watched;

/// Older readings are coloured, ms: half of the default timeout of the loop.
const OLD_MS: u128 = 125;

/// Durations of the stages, newest and longest.
pub(super) fn stages<C: Watched>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
    let Some(record) = &picture.record else {
        return;
    };
    let (now, most) = (&record.stages, &picture.longest);
    let stages = Stage::TIMED.into_iter().chain([Stage::Tick]);
    let lines: Vec<_> = stages
        .map(|stage| {
            let (now_ns, most_ns) = (now.of(stage), most.of(stage));
            let name = match stage {
                Stage::Tick => "total".to_owned(),
                Stage::Actuators => "actuat.".to_owned(),
                stage => stage.to_string(),
            };
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

/// The age of each reading at the tick: as many as there is room for, in two
/// columns.
pub(super) fn ages<C: Watched>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
    let Some(record) = &picture.record else {
        return;
    };
    let now = record.tick.woke;
    let mut taken = Vec::new();
    record
        .measurements
        .each_source(&mut |_, time| taken.push(time));
    let readings: Vec<_> = C::READINGS.iter().copied().zip(taken).collect();
    let (left, right) = readings.split_at(readings.len().min(area.height.into()));
    // A single column has the whole width.
    let width = if right.is_empty() {
        usize::from(area.width).saturating_sub(5).max(9)
    } else {
        9
    };
    let lines: Vec<_> = left
        .iter()
        .enumerate()
        .map(|(row, reading)| {
            let mut spans = age(*reading, width, now).to_vec();
            if let Some(reading) = right.get(row) {
                spans.push(" ".into());
                spans.extend(age(*reading, 7, now));
            }
            Line::from(spans)
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), area);
}

fn age((name, taken): (&'static str, Time), width: usize, now: Time) -> [Span<'static>; 2] {
    let most = width - 1;
    let name = format!("{name:<width$.most$}").dim();
    if taken.is_never() {
        return [name, "   –".dim()];
    }
    let age_ms = now.since(taken).as_millis();
    let text = if age_ms < 1_000 {
        format!("{age_ms:>2}ms")
    } else {
        format!("{}s", age_ms / 1_000)
    };
    let text = format!("{text:>4}");
    [
        name,
        if age_ms > OLD_MS {
            text.red().bold()
        } else {
            text.green()
        },
    ]
}

/// State of the recorder, and number of watchers.
pub(super) fn recorder<C: Watched>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
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

fn watched<C: Watched>(status: &Status, picture: &Picture<C>) -> Line<'static> {
    let percent = status.cpu_ns as f64 * 1e-7 / picture.seconds(status.time_ns).max(1.0);
    Line::from(format!("{} watching, {percent:.1} % CPU", status.watchers))
}

fn lost(name: &'static str, number: u64) -> Line<'static> {
    let text = format!("{number} {name}");
    if number == 0 {
        Line::from(text.dim())
    } else {
        Line::from(text.red().bold())
    }
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1_024 => format!("{bytes} B"),
        1_024..1_048_576 => format!("{} KiB", bytes / 1_024),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

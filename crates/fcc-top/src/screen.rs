//! The screen: the layout of its parts, its first and its last line, and the
//! events.

use fcc_core::framework::State;
use fcc_telemetry::Instance;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Paragraph};

use super::picture::Picture;
use super::watched::{ScreenPart, Watched};
use super::{health, timing};

/// Smallest screen with room for everything.
const LEAST: (u16, u16) = (80, 24);

/// Heights of the first row of parts, with its title, and of the second.
const UPPER_ROWS: u16 = 11;
const LOWER_ROWS: u16 = 7;

/// Draws the whole screen.
pub fn draw<C: Watched>(frame: &mut Frame<'_>, instance: &Instance, picture: &Picture<C>) {
    let area = frame.area();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        let words = format!(
            "{} top needs {} x {} characters; this one has {} x {}. q quits",
            C::PROGRAM,
            LEAST.0,
            LEAST.1,
            area.width,
            area.height
        );
        frame.render_widget(
            Paragraph::new(words).wrap(ratatui::widgets::Wrap { trim: true }),
            area,
        );
        return;
    }
    // A high screen gives the first row more room, and the events the rest.
    let upper_rows = UPPER_ROWS + (area.height - LEAST.1) / 3;
    let [head, upper, lower, events, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(upper_rows),
        Constraint::Length(LOWER_ROWS),
        Constraint::Fill(1),
        Constraint::Length(1),
    ])
    .areas(area);
    let row = |area: Rect, parts: Vec<(String, u16, ScreenPart<C>)>| {
        // A wide screen widens all of them.
        let widths = parts.iter().map(|(_, width, _)| Constraint::Fill(*width));
        let areas = Layout::horizontal(widths).spacing(1).split(area);
        let areas: Vec<Rect> = areas.to_vec();
        let parts = parts.into_iter().zip(areas);
        parts.map(|((title, _, draw), area)| (title, area, draw))
    };
    let mut above = C::parts(picture.record.as_ref());
    above.push(("Lateness".to_owned(), 28, timing::draw));
    let below: Vec<(String, u16, ScreenPart<C>)> = vec![
        ("Stages".to_owned(), 23, health::stages),
        ("Sensor ages".to_owned(), 27, health::ages),
        ("Telemetry".to_owned(), 28, health::recorder),
    ];
    let events_part: Vec<(String, u16, ScreenPart<C>)> =
        vec![("Events".to_owned(), 1, draw_events)];
    let parts = row(upper, above)
        .chain(row(lower, below))
        .chain(row(events, events_part));
    frame.render_widget(head_line(instance, picture), head);
    for (title, area, draw) in parts {
        let block = Block::new()
            .borders(Borders::TOP)
            .border_style(Style::new().dark_gray())
            .title(format!(" {title} ").bold());
        let inner = block.inner(area);
        frame.render_widget(block, area);
        draw(frame, inner, picture);
    }
    frame.render_widget(foot_line(instance, picture), foot);
}

fn head_line<'a, C: Watched>(instance: &Instance, picture: &Picture<C>) -> Line<'a> {
    let info = &picture.info;
    let mut spans = vec![format!(" {instance} ").bold().reversed(), " ".into()];
    spans.push(state(picture));
    if let Some(record) = &picture.record {
        let now_ns = record.tick.woke.as_nanos();
        if let Some(since_ns) = picture.state_since_ns {
            let seconds = now_ns.saturating_sub(since_ns) as f64 * 1e-9;
            spans.push(format!("{seconds:.0} s  ").into());
        }
        spans.push(format!("tick {}  ", record.tick.number).into());
    }
    let policy = info.policy.as_str().trim_start_matches("SCHED_");
    let scheduling = if info.priority > 0 {
        format!("{policy} {}", info.priority)
    } else {
        policy.to_owned()
    };
    spans.push(
        format!(
            "{}  {} Hz  {}  {scheduling}",
            info.plant, info.rate_hz, info.timer
        )
        .into(),
    );
    if info.requests_denied > 0 {
        spans.push(format!("  {} requests denied", info.requests_denied).red());
    }
    Line::from(spans)
}

fn state<C: Watched>(picture: &Picture<C>) -> Span<'static> {
    if picture.ended {
        return " ENDED ".white().on_red();
    }
    match picture.record.as_ref().map(|record| record.state.state()) {
        None => "no tick yet  ".dim(),
        Some(State::Engaged) => "ENGAGED ".green().bold(),
        Some(State::Standby) => "STANDBY ".yellow().bold(),
        Some(State::Failsafe(_)) => "FAILSAFE ".red().bold(),
        Some(State::Stopped) => "STOPPED ".bold(),
    }
}

/// The most important message, and how to quit.
fn foot_line<'a, C: Watched>(instance: &Instance, picture: &Picture<C>) -> Line<'a> {
    let quits = " q quits ".reversed();
    let words: Span<'a> = if picture.ended {
        let program = C::PROGRAM;
        format!(" {program} '{instance}' has ended. The screen continues when it is started again.")
            .red()
    } else if let Some(record) = &picture.record {
        let (title, flags, color) = if record.faults.is_empty() {
            ("not ready", record.engage_inhibits, Color::Yellow)
        } else {
            ("faults", record.faults, Color::Red)
        };
        let names: Vec<_> = flags.iter().map(C::flag_name).collect();
        if names.is_empty() {
            Span::raw("")
        } else {
            Span::styled(format!(" {title}: {}", names.join(", ")), color)
        }
    } else {
        Span::raw(" waiting for the first tick")
    };
    Line::from(vec![quits, words])
}

/// The newest events, the newest last.
fn draw_events<C: Watched>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
    let room = usize::from(area.height);
    let skipped = picture.events.len().saturating_sub(room);
    let lines: Vec<_> = picture
        .events
        .iter()
        .skip(skipped)
        .map(|event| {
            let time_s = picture.seconds(event.time_ns).max(0.0);
            Line::from(vec![
                format!("{time_s:9.2} s  ").dim(),
                event.text.as_str().to_owned().into(),
            ])
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), area);
}

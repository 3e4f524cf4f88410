//! The screen: where its parts are, its first and its last line, and the events.

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, State};
use fcc_telemetry::Instance;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Paragraph};

use super::picture::Picture;
use super::{flight, health, horizon, timing};

/// Smallest screen on which everything has its place.
const LEAST: (u16, u16) = (80, 24);

/// Heights of the first row of parts, with its title, and of the second.
const FLIGHT_ROWS: u16 = 11;
const HEALTH_ROWS: u16 = 7;

/// Draws the screen.
pub(super) fn draw(frame: &mut Frame<'_>, instance: &Instance, picture: &Picture) {
    let area = frame.area();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        let words = format!(
            "fccd top needs {} x {} characters; here are {} x {}. q quits",
            LEAST.0, LEAST.1, area.width, area.height
        );
        frame.render_widget(
            Paragraph::new(words).wrap(ratatui::widgets::Wrap { trim: true }),
            area,
        );
        return;
    }
    // A high screen gives the horizon more room, and the events what is left.
    let flight_rows = FLIGHT_ROWS + (area.height - LEAST.1) / 3;
    let [head, upper, lower, events, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(flight_rows),
        Constraint::Length(HEALTH_ROWS),
        Constraint::Fill(1),
        Constraint::Length(1),
    ])
    .areas(area);
    // A wide one widens all three.
    let columns = [
        Constraint::Fill(23),
        Constraint::Fill(27),
        Constraint::Fill(28),
    ];
    let [left, middle, right] = Layout::horizontal(columns).spacing(1).areas(upper);
    let [lower_left, lower_middle, lower_right] =
        Layout::horizontal(columns).spacing(1).areas(lower);

    // Engaged, the mode of guidance and where it is.
    let flown = match &picture.record {
        Some(record) if record.state == State::Engaged => record.setpoints.guidance.to_string(),
        _ => "Flight".to_owned(),
    };
    let parts: [(&str, Rect, Part); 7] = [
        ("Attitude", left, horizon::draw),
        (&flown, middle, flight::draw),
        ("Lateness", right, timing::draw),
        ("Stages", lower_left, health::stages),
        ("Sensor ages", lower_middle, health::ages),
        ("Telemetry", lower_right, health::recorder),
        ("Events", events, draw_events),
    ];
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

/// Draws a part of the screen into its place.
type Part = fn(&mut Frame<'_>, Rect, &Picture);

fn head_line<'a>(instance: &Instance, picture: &Picture) -> Line<'a> {
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
            info.aircraft, info.rate_hz, info.timer
        )
        .into(),
    );
    if info.requests_denied > 0 {
        spans.push(format!("  {} requests denied", info.requests_denied).red());
    }
    Line::from(spans)
}

fn state(picture: &Picture) -> Span<'static> {
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

/// What matters most now, and how to leave.
fn foot_line<'a>(instance: &Instance, picture: &Picture) -> Line<'a> {
    let quits = " q quits ".reversed();
    let words: Span<'a> = if picture.ended {
        format!(" fccd '{instance}' has ended. This shows it again when it is started again.").red()
    } else if let Some(record) = &picture.record {
        let (title, flags, color) = if record.faults.is_empty() {
            ("not ready", record.engage_inhibits, Color::Yellow)
        } else {
            ("faults", record.faults, Color::Red)
        };
        let names: Vec<_> = flags.iter().map(Autopilot::flag_name).collect();
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
fn draw_events(frame: &mut Frame<'_>, area: Rect, picture: &Picture) {
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

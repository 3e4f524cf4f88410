//! Tables as text and HTML.

use std::fmt::Write as _;

use comfy_table::{CellAlignment, LineStyle, Row, Table, TableStyle};
use maud::{Markup, html};

use fcc_record::{Entry, Wholeness};
use fcc_telemetry::TimingReport;

/// One line under the header only.
const STYLE: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

pub(crate) fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(STYLE);
    table.set_header(header);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// The same for a page, with text in these columns and numbers in the others.
pub(crate) fn markup(table: &Table, text_columns: &[usize]) -> Markup {
    let cells = |row: &Row| -> Vec<(bool, String)> {
        let cells = row.cell_iter().enumerate();
        cells
            .map(|(n, cell)| (text_columns.contains(&n), cell.content()))
            .collect()
    };
    html! {
        div.wide { table {
            thead { tr {
                @for (is_text, cell) in table.header().map(cells).unwrap_or_default() {
                    th.text[is_text] { (cell) }
                }
            } }
            tbody {
                @for row in table.row_iter().map(cells) {
                    tr.worst[row.first().is_some_and(|(_, name)| name == "worst")] {
                        @for (is_text, cell) in row { td.text[is_text] { (cell) } }
                    }
                }
            }
        } }
    }
}

/// The table of the thesis (tables 6.1 to 6.3), a column per report, and below
/// it values that the thesis does not have.
pub fn timing_table(reports: &[TimingReport]) -> String {
    // Three fit on a terminal of 80 columns.
    let tables = reports
        .chunks(3)
        .map(|some| timing_columns(some).to_string());
    let mut text = tables.collect::<Vec<_>>().join("\n\n");
    if let Some(realtime) = reports.first().map(|r| &r.realtime)
        && !realtime.cpu_because.is_empty()
    {
        let _ = match realtime.cpu {
            Some(cpu) => write!(text, "\non CPU {cpu}: {}", realtime.cpu_because),
            None => write!(text, "\nCPU {}", realtime.cpu_because),
        };
    }
    for refused in reports.first().iter().flat_map(|r| &r.realtime.refused) {
        let _ = write!(text, "\nnot granted: {refused}");
    }
    text
}

/// The same without the text below it.
pub(crate) fn timing_columns(reports: &[TimingReport]) -> Table {
    let name =
        |report: &TimingReport| format!("{} Hz {}", report.rate_hz, timer_name(&report.timer));
    let header: Vec<String> = reports.iter().map(name).collect();
    let mut header: Vec<&str> = header.iter().map(String::as_str).collect();
    header.insert(0, "");
    let mut table = table(&header);
    let mut row = |name: &'static str, value: &dyn Fn(&TimingReport) -> String| {
        let mut cells = vec![name.to_owned()];
        cells.extend(reports.iter().map(value));
        table.add_row(cells);
    };
    row("Runtime", &|r| figure(r.runtime_s, 2, "s"));
    row("Average", &|r| figure(r.period_ms.mean, 4, "ms"));
    row("Median", &|r| figure(r.period_ms.median, 3, "ms"));
    row("Min time", &|r| figure(r.period_ms.min, 3, "ms"));
    row("Max time", &|r| figure(r.period_ms.max, 3, "ms"));
    row("Range", &|r| figure(r.period_ms.range, 3, "ms"));
    row("Missed", &|r| r.missed.to_string());
    row("Within ±2 %", &|r| {
        figure(100.0 * r.period_ms.within_2_percent, 3, "%")
    });
    row("Lateness p50", &|r| micros(r.lateness_us.p50));
    row("Lateness p99", &|r| micros(r.lateness_us.p99));
    row("Lateness p99.9", &|r| micros(r.lateness_us.p99_9));
    row("Lateness max", &|r| micros(r.lateness_us.max));
    row("CPU", &|r| {
        figure(r.cpu_percent.unwrap_or(f64::NAN), 2, "%")
    });
    if reports.iter().any(|r| r.early_wake.is_some()) {
        row("Woken early by", &|r| {
            or_unknown(r.early_wake.map_or_else(String::new, |early| {
                format!("{:.0} µs, ≤ {:.0} µs", early.last_us, early.max_us)
            }))
        });
        row("Spinning", &|r| {
            let percent = r.early_wake.and_then(|early| early.spin_percent);
            figure(percent.unwrap_or(f64::NAN), 2, "%")
        });
    }
    row("Page faults", &|r| {
        or_unknown(
            r.page_faults
                .map_or_else(String::new, |faults| faults.to_string()),
        )
    });
    row("Scheduling", &|r| match r.realtime.priority {
        0 => or_unknown(r.realtime.policy.clone()),
        priority => format!("{} {priority}", r.realtime.policy),
    });
    row("Memory locked", &|r| {
        match (r.realtime.policy.is_empty(), r.realtime.memory_locked) {
            (true, _) => UNKNOWN,
            (false, true) => "yes",
            (false, false) => "no",
        }
        .to_owned()
    });
    if reports.iter().any(|r| r.realtime.cpu.is_some()) {
        row("On CPU", &|r| {
            or_unknown(
                r.realtime
                    .cpu
                    .map_or_else(String::new, |cpu| cpu.to_string()),
            )
        });
    }
    table
}

/// The timer for users: in lockstep there is none.
pub(crate) fn timer_name(timer: &str) -> &str {
    match timer {
        "manual" => "lockstep",
        other => other,
    }
}

/// Shown in a table for a value that was not measured.
const UNKNOWN: &str = "–";

/// A number with its unit.
pub(crate) fn figure(value: f64, decimals: usize, unit: &str) -> String {
    if value.is_finite() {
        format!("{value:.decimals$} {unit}")
    } else {
        UNKNOWN.to_owned()
    }
}

/// A lateness: in a spinning loop it is some nanoseconds.
fn micros(us: f64) -> String {
    figure(us, if us < 10.0 { 3 } else { 1 }, "µs")
}

fn or_unknown(text: String) -> String {
    if text.is_empty() {
        UNKNOWN.to_owned()
    } else {
        text
    }
}

/// A row per recording, of 80 columns: its name has when and of what it is.
pub fn recordings_table(entries: &[Entry]) -> String {
    let mut table = table(&["Recording", "duration", "worst late", "end"]);
    for entry in entries {
        let name = entry.path.file_name().unwrap_or(entry.path.as_os_str());
        let tenths = (entry.duration_s * 10.0).round() as u64;
        table.add_row(vec![
            name.to_string_lossy().replace('\n', "\\n"),
            format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10),
            if entry.worst_lateness_us < 1e4 {
                format!("{:.1} µs", entry.worst_lateness_us)
            } else {
                format!("{:.1} ms", entry.worst_lateness_us * 1e-3)
            },
            match entry.file {
                Wholeness::Whole if entry.not_recorded > 0 => {
                    format!("{}, {} not recorded", entry.state, entry.not_recorded)
                }
                Wholeness::Whole => entry.state.clone(),
                Wholeness::Damaged => "damaged".to_owned(),
                Wholeness::Cut => "cut".to_owned(),
                Wholeness::BeingWritten => "writing".to_owned(),
            },
        ]);
    }
    let to_recover = |entry: &Entry| matches!(entry.file, Wholeness::Damaged | Wholeness::Cut);
    if entries.iter().any(to_recover) {
        return format!("{table}\nfccd recover FILE finishes a cut or damaged recording");
    }
    table.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_telemetry::{Lateness, Period, Realtime};

    #[test]
    fn a_minute_less_a_moment_is_listed_as_a_minute() {
        let entry = |duration_s| Entry {
            path: "flight.mcap".into(),
            started: "2026-11-20T04:21:33Z".to_owned(),
            part: 1,
            plant: "built-in".to_owned(),
            duration_s,
            ticks: 2_400,
            worst_lateness_us: 12.34,
            state: "stopped".to_owned(),
            ending: "stopped by command".to_owned(),
            not_recorded: 0,
            file: Wholeness::Whole,
            damages: Vec::new(),
        };
        let text = recordings_table(&[entry(59.97), entry(600.0), entry(5.25), entry(3_725.04)]);
        for cell in [
            " 1:00.0 ",
            " 10:00.0 ",
            " 0:05.3 ",
            " 62:05.0 ",
            " 12.3 µs ",
        ] {
            assert!(text.contains(cell), "{cell} is not in\n{text}");
        }
    }

    /// The thesis' table 6.1, from its own figures.
    #[test]
    fn prints_the_thesis_table_as_the_thesis_does() {
        let report = TimingReport {
            rate_hz: 40.0,
            timer: "posix".to_owned(),
            ticks: 2_716,
            missed: 0,
            runtime_s: 67.90,
            period_ms: Period {
                mean: 25.0001,
                median: 24.994,
                min: 16.785,
                max: 32.593,
                range: 32.593 - 16.785,
                within_2_percent: 0.7,
            },
            lateness_us: Lateness {
                p50: 1.0,
                p99: 2.0,
                p99_9: 3.0,
                max: 4.0,
            },
            realtime: Realtime {
                policy: "SCHED_OTHER".to_owned(),
                priority: 0,
                ..Realtime::default()
            },
            cpu_percent: Some(1.0),
            page_faults: Some(0),
            early_wake: None,
        };
        let text = timing_table(&[report]);
        for figure in [
            "67.90 s",
            "25.0001 ms",
            "24.994 ms",
            "16.785 ms",
            "32.593 ms",
            "15.808 ms",
        ] {
            assert!(text.contains(figure), "{figure} is not in\n{text}");
        }
    }
}

//! A report as text for a terminal.

use std::fmt::Write as _;

use comfy_table::Table;
use fcc_telemetry::TimingReport;

use super::durations::NamedPercentiles;
use super::origin::FileEnd;
use super::report::{Report, RunReport, Timing};
use crate::reported::Addition;
use crate::table::{figure, table, timer_name, timing_table};

/// At most this many events are shown: the first ones, and the last ones.
const FIRST_EVENTS: usize = 14;
const LAST_EVENTS: usize = 6;

impl<A: Addition> Report<A> {
    /// The report as text.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (name, value) in self.header() {
            let _ = writeln!(text, "{name:<14} {value}");
        }
        text.push('\n');
        for finding in &self.findings {
            let _ = writeln!(text, "{finding}");
        }
        if let Some(timing) = &self.timing {
            let _ = writeln!(text, "\n{}", timing_table(&timing.columns()));
        }
        if !self.stages.is_empty() {
            let _ = writeln!(text, "\n{}", percentiles_table("Stage", &self.stages));
        }
        if self.has_ages() {
            let _ = writeln!(text, "\n{}", percentiles_table("Age of", &self.sensor_ages));
        }
        if !self.values.is_empty() {
            let _ = writeln!(text, "\n{}", self.values_table());
        }
        let of_this_plant = self.addition.text();
        if !of_this_plant.is_empty() {
            let _ = writeln!(text, "\n{of_this_plant}");
        }
        self.write_events(&mut text);
        text.truncate(text.trim_end().len());
        text
    }
}

impl RunReport {
    fn write_events(&self, text: &mut String) {
        if self.events.is_empty() {
            return;
        }
        text.push('\n');
        let omitted = self.event_count.saturating_sub(FIRST_EVENTS + LAST_EVENTS);
        let resumes = self.events.len().saturating_sub(LAST_EVENTS);
        for (index, event) in self.events.iter().enumerate() {
            if omitted > 0 && index == FIRST_EVENTS {
                let _ = writeln!(
                    text,
                    "{:>10}    {omitted} more: see the page (--html) or events.csv (--csv)",
                    "..."
                );
            }
            if omitted == 0 || index < FIRST_EVENTS || index >= resumes {
                let _ = writeln!(text, "{:10.3} s  {}", event.time_s, event.text);
            }
        }
    }

    /// The start of the run: `2026-11-20 04:21:33 UTC`.
    pub(super) fn started(&self) -> String {
        self.origin.started.replace('T', " ").replace('Z', " UTC")
    }

    /// The known properties of the recording, with their names.
    pub(super) fn header(&self) -> Vec<(&'static str, String)> {
        let origin = &self.origin;
        let realtime = &origin.realtime;
        let scheduling = match (realtime.policy.as_str(), realtime.priority) {
            ("", _) => String::new(),
            (policy, 0) => policy.to_owned(),
            (policy, priority) => format!("{policy} {priority}"),
        };
        let memory = match (realtime.policy.as_str(), realtime.memory_locked) {
            ("", _) => "",
            (_, true) => ", memory locked",
            (_, false) => ", memory not locked",
        };
        let loop_of = self.timing.as_ref().map_or_else(String::new, |timing| {
            format!("{} Hz {}", timing.table.rate_hz, timer_name(&origin.timer))
        });
        let end = match &self.end {
            FileEnd::Finished(reason) | FileEnd::BeingWritten(reason) => reason.clone(),
            FileEnd::Cut(reason) => format!("cut: {reason}"),
            FileEnd::Unknown => String::new(),
        };
        let last_state = self.states.last().map(|span| span.state.clone());
        let mut rows = vec![
            ("Recording", origin.file.clone()),
            ("Started", self.started()),
            (self.terms.plant, origin.plant.clone()),
            ("Duration", duration(self.duration_s)),
            ("Ended", end),
            ("Last state", last_state.unwrap_or_default()),
            ("Loop", loop_of),
            ("Scheduling", format!("{scheduling}{memory}")),
        ];
        rows.extend(
            realtime
                .refused
                .iter()
                .map(|refused| ("Not granted", refused.to_string())),
        );
        rows.extend([
            ("Software", origin.software.clone()),
            ("Commit", origin.git_hash.clone()),
            ("Config SHA-256", origin.config_sha256.clone()),
            ("Host", origin.host.clone()),
            ("Kernel", origin.kernel.clone()),
        ]);
        rows.retain(|(_, value)| !value.is_empty());
        // A name may contain the end of a line, and would pass for another row.
        for (_, value) in &mut rows {
            *value = value.replace('\n', "\\n");
        }
        rows
    }
}

impl RunReport {
    /// What each value ranged over.
    pub(super) fn values_table(&self) -> Table {
        let mut table = table(&["Value", "Unit", "Lowest", "Highest", "Last"]);
        for value in &self.values {
            let name = format!("{}, {}", value.quantity, value.role);
            let numbers = [value.lowest, value.highest, value.last];
            let mut cells = vec![name, value.unit.to_owned()];
            cells.extend(numbers.map(|number| format!("{number:.3}")));
            table.add_row(cells);
        }
        table
    }
}

impl Timing {
    /// The columns of its table: beside it the thesis', where it measured at
    /// this rate.
    pub(super) fn columns(&self) -> Vec<TimingReport> {
        let mut columns = vec![self.table.clone()];
        columns.extend(self.thesis.map(|thesis| thesis.timing()));
        columns
    }
}

/// Median to largest of each, with units.
pub(super) fn percentiles_table(title: &str, rows: &[NamedPercentiles]) -> Table {
    let mut table = table(&[title, "p50", "p90", "p99", "p99.9", "max"]);
    for NamedPercentiles { name, of } in rows {
        let times = [of.p50_us, of.p90_us, of.p99_us, of.p99_9_us, of.max_us].map(time);
        table.add_row(std::iter::once(name.clone()).chain(times));
    }
    table
}

/// A time in a suitable unit, with three to four figures.
pub(super) fn time(us: f64) -> String {
    match us {
        0.0 => "0 µs".to_owned(),
        us if us < 10.0 => figure(us, 2, "µs"),
        us if us < 1_000.0 => figure(us, 1, "µs"),
        us if us < 100_000.0 => figure(us / 1e3, 2, "ms"),
        us if us < 10_000_000.0 => figure(us / 1e3, 0, "ms"),
        us => figure(us / 1e6, 1, "s"),
    }
}

/// `2 min 15.3 s`.
pub(super) fn duration(seconds: f64) -> String {
    let tenths = (seconds * 10.0).round() as u64;
    let (minutes, rest_s) = (tenths / 600, (tenths % 600) as f64 / 10.0);
    match minutes {
        0 => format!("{rest_s:.1} s"),
        1..60 => format!("{minutes} min {rest_s:.1} s"),
        _ => format!("{} h {} min {rest_s:.0} s", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_and_times_have_suitable_units() {
        assert_eq!(duration(42.04), "42.0 s");
        assert_eq!(duration(182.0), "3 min 2.0 s");
        assert_eq!(duration(3_599.99), "1 h 0 min 0 s");
        for (us, expected) in [
            (0.0, "0 µs"),
            (2.345, "2.35 µs"),
            (54.321, "54.3 µs"),
            (25_000.0, "25.00 ms"),
            (250_000.0, "250 ms"),
            (12_000_000.0, "12.0 s"),
        ] {
            assert_eq!(time(us), expected);
        }
    }
}

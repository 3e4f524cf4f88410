//! The results as a document that can be sent to others: Markdown, and JSON.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::link::Link;
use crate::result::{Outcome, StepResult};
use crate::watched::Watched;

/// The stretch of time from which rates are computed.
const RATES_OF: Duration = Duration::from_secs(60);

/// What was seen of X-Plane.
#[derive(Clone, Debug, Serialize)]
pub struct Simulator {
    /// Where requests go.
    pub address: String,
    /// Where replies come from.
    pub replies_from: Vec<String>,
    /// As X-Plane numbers it: 121000 is 12.1.0.
    pub version: Option<u32>,
    /// In the last minute.
    pub frames_per_s: Option<f64>,
    /// Datarefs that were requested and never came.
    pub missing: Vec<String>,
}

impl Simulator {
    pub(crate) fn seen(link: &Link) -> Self {
        let now = Instant::now();
        let all = link.since(now.checked_sub(RATES_OF).unwrap_or(now));
        let from: BTreeSet<String> = all.clone().map(|s| s.from.to_string()).collect();
        let version = link.number(Watched::Version);
        let span = all.clone().next().zip(all.clone().last());
        let seconds = span.map(|(first, last)| (last.at - first.at).as_secs_f64());
        let datagrams = all.count() as f64;
        Self {
            address: link.simulator().to_string(),
            replies_from: from.into_iter().collect(),
            version: (version > 0.0).then_some(version as u32),
            frames_per_s: seconds.filter(|s| *s > 1.0).map(|s| datagrams / s),
            missing: Watched::all()
                .filter(|what| link.latest().is_none_or(|last| last.get(*what).is_none()))
                .map(|what| link.path(what).to_owned())
                .collect(),
        }
    }

    /// The version as X-Plane shows it: 12.1.0, 11.55.
    pub fn version_text(&self) -> String {
        match self.version {
            None => "unknown".to_owned(),
            Some(v) if v >= 121_000 => {
                format!("{}.{}.{}", v / 10_000, v / 1_000 % 10, v / 100 % 10)
            }
            Some(v) => format!("{}.{:02}", v / 10_000, v / 100 % 100),
        }
    }
}

/// The results of a check.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The version of `fccd`.
    pub fccd: &'static str,
    /// What was seen of X-Plane.
    pub x_plane: Simulator,
    /// Whether waits were shortened: such a check proves less.
    pub is_short: bool,
    /// Whether nobody was asked.
    pub is_unattended: bool,
    /// The results of all steps, in order.
    pub steps: Vec<StepResult>,
    /// The configuration as given.
    pub configuration: String,
}

impl Report {
    pub(crate) fn new(
        x_plane: Simulator,
        steps: Vec<StepResult>,
        (is_short, is_unattended): (bool, bool),
        configuration: String,
    ) -> Self {
        Self {
            fccd: env!("CARGO_PKG_VERSION"),
            x_plane,
            is_short,
            is_unattended,
            steps,
            configuration,
        }
    }

    /// How many steps ended so.
    pub fn count(&self, outcome: Outcome) -> usize {
        let steps = self.steps.iter();
        steps.filter(|step| step.outcome == outcome).count()
    }

    /// Whether every step passed.
    pub fn is_passed(&self) -> bool {
        self.count(Outcome::Passed) == self.steps.len()
    }

    /// In one line.
    pub fn summary(&self) -> String {
        format!(
            "{} of {} steps passed, {} failed, {} skipped",
            self.count(Outcome::Passed),
            self.steps.len(),
            self.count(Outcome::Failed),
            self.count(Outcome::Skipped)
        )
    }

    /// As Markdown.
    pub fn markdown(&self) -> String {
        let mut text = String::from("# fccd x-plane check\n\n");
        let simulator = &self.x_plane;
        let _ = write!(
            text,
            "{}.\n\n| | |\n|---|---|\n| fccd | {} |\n| X-Plane | {} |\n| requests go to | {} |\n\
             | replies come from | {} |\n| frames a second | {} |\n| datarefs that never came | {} |\n",
            self.summary(),
            self.fccd,
            simulator.version_text(),
            simulator.address,
            list(&simulator.replies_from),
            simulator
                .frames_per_s
                .map_or_else(|| "–".to_owned(), |rate| format!("{rate:.1}")),
            list(&simulator.missing),
        );
        if self.is_short {
            text.push_str("| waits | shortened: this proves less than a full check |\n");
        }
        if self.is_unattended {
            text.push_str("| person | none: unattended, with cues for a stand-in |\n");
        }
        text.push_str("\n| step | | result | |\n|---|---|---|---|\n");
        for step in &self.steps {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} |",
                step.number,
                step.title,
                step.outcome.as_str(),
                cell(step.why.as_deref().unwrap_or_default())
            );
        }
        for step in self.steps.iter().filter(|step| step.duration_s > 0.0) {
            section(&mut text, step);
        }
        let _ = write!(
            text,
            "\n## Configuration\n\n```toml\n{}\n```\n",
            self.configuration.trim_end()
        );
        text
    }
}

fn section(text: &mut String, step: &StepResult) {
    let _ = write!(
        text,
        "\n## {}. {}\n\n{} after {:.1} s.",
        step.number,
        step.title,
        step.outcome.as_str(),
        step.duration_s
    );
    if let Some(why) = &step.why {
        let _ = write!(text, " {why}.");
    }
    if let Some(advice) = step.advice {
        let _ = write!(text, "\n\nWhat to do: {advice}");
    }
    text.push('\n');
    if !step.figures.is_empty() {
        text.push_str("\n| | measured | limit | |\n|---|---|---|---|\n");
        for figure in &step.figures {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} |",
                figure.name,
                figure.text(),
                figure.limit.as_deref().unwrap_or("–"),
                if figure.within { "" } else { "outside" }
            );
        }
    }
    for note in &step.notes {
        let _ = write!(text, "\n- {note}");
    }
    if !step.notes.is_empty() {
        text.push('\n');
    }
    if !step.daemon.is_empty() {
        let _ = write!(text, "\n```\n{}\n```\n", step.daemon.join("\n"));
    }
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn list(items: &[String]) -> String {
    if items.is_empty() {
        "–".to_owned()
    } else {
        items.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, Limit};

    fn simulator(version: u32) -> Simulator {
        Simulator {
            address: "192.0.2.7:49000".to_owned(),
            replies_from: vec!["192.0.2.7:49001".to_owned()],
            version: Some(version),
            frames_per_s: Some(59.94),
            missing: Vec::new(),
        }
    }

    /// As Laminar names its releases.
    #[test]
    fn versions_are_written_as_x_plane_does() {
        for (number, text) in [
            (104_100, "10.41"),
            (115_501, "11.55"),
            (120_800, "12.08"),
            (121_000, "12.1.0"),
        ] {
            assert_eq!(simulator(number).version_text(), text);
        }
    }

    #[test]
    fn a_figure_outside_its_limit_is_marked_and_a_failed_step_fails_the_report() {
        let step = StepResult {
            number: 12,
            title: "a pause of 20 s",
            outcome: Outcome::Failed,
            why: Some("a | in it".to_owned()),
            advice: Some("Send this report."),
            duration_s: 31.25,
            figures: vec![Figure::new("change of bank", 7.5, "°", Limit::AtMost(5.0))],
            notes: vec!["a note".to_owned()],
            daemon: vec!["12.00 s  engaged -> failsafe".to_owned()],
        };
        let report = Report::new(
            simulator(121_000),
            vec![step],
            (true, false),
            "[x-plane]".into(),
        );
        assert!(!report.is_passed());
        assert_eq!(report.summary(), "0 of 1 steps passed, 1 failed, 0 skipped");
        let text = report.markdown();
        for part in [
            "| replies come from | 192.0.2.7:49001 |",
            "| waits | shortened",
            "| 12 | a pause of 20 s | failed | a \\| in it |",
            "| change of bank | 7.500 ° | at most 5 | outside |",
            "What to do: Send this report.",
            "engaged -> failsafe",
            "```toml\n[x-plane]\n```",
        ] {
            assert!(text.contains(part), "no {part} in:\n{text}");
        }
    }
}

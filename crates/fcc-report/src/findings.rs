//! The summary of a recording: sentences above the tables.

use super::origin::FileEnd;
use super::report::RunReport;
use super::states::{Phase, time_in};

/// The sentences, the most important first.
pub(super) fn findings(report: &RunReport) -> Vec<String> {
    let mut sentences = Vec::new();
    if report.continuity.ticks == 0 {
        let run = report.terms.run;
        sentences.push(format!(
            "There is no tick in this recording: nothing is known about the {run}."
        ));
        sentences.extend(end(report));
        sentences.extend(damages(report));
        return sentences;
    }
    sentences.extend(end(report));
    sentences.extend(damages(report));
    sentences.extend(gaps(report));
    sentences.extend(timing(report));
    sentences.extend(states(report));
    sentences.extend(missing(report));
    sentences
}

fn end(report: &RunReport) -> Option<String> {
    match &report.end {
        FileEnd::Cut(reason) => Some(format!(
            "The recording is not whole: {reason}. The report covers what is there."
        )),
        FileEnd::BeingWritten(so_far) => Some(format!(
            "The recording is {so_far}. The report covers these."
        )),
        FileEnd::Finished(_) | FileEnd::Unknown => None,
    }
}

/// At most this many damages are listed.
const MOST_DAMAGES: usize = 5;

fn damages(report: &RunReport) -> Vec<String> {
    let mut sentences: Vec<String> = report
        .damages
        .iter()
        .take(MOST_DAMAGES)
        .map(|damage| format!("The recording is {damage}."))
        .collect();
    if report.damages.len() > MOST_DAMAGES {
        sentences.push(format!(
            "It is damaged in {} places in all.",
            report.damages.len()
        ));
    }
    sentences
}

fn gaps(report: &RunReport) -> Vec<String> {
    let continuity = &report.continuity;
    let mut sentences = Vec::new();
    let missing_before = continuity.first_tick.saturating_sub(1);
    if report.origin.part > 1 {
        sentences.push(format!(
            "This is part {} of a recording: it begins at tick {}.",
            report.origin.part, continuity.first_tick
        ));
    } else if missing_before > 0 {
        sentences.push(format!(
            "The recording begins late, at tick {}: {} before it are missing. Times count from \
             there.",
            continuity.first_tick,
            ticks(missing_before)
        ));
    }
    if continuity.lost == 0 {
        let span = (continuity.last_tick + 1).saturating_sub(continuity.first_tick);
        let missed = span.saturating_sub(continuity.ticks);
        let but = match missed {
            0 => String::new(),
            _ => format!(", but for {} that the loop missed", ticks(missed)),
        };
        sentences.push(format!(
            "Every tick from {} to {} is in the file{but}.",
            continuity.first_tick, continuity.last_tick
        ));
    } else {
        let longest = continuity
            .gaps
            .iter()
            .max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)));
        let where_longest = longest.map_or_else(String::new, |gap| {
            format!(
                ", the longest of {:.2} s after {:.2} s",
                gap.to_s - gap.from_s,
                gap.from_s
            )
        });
        sentences.push(format!(
            "{} missing from the file, in {}{where_longest}; the plots show gaps there.",
            are(continuity.lost, "tick"),
            plural(continuity.gap_count, "gap"),
        ));
    }
    if continuity.lost_after > 0 {
        sentences.push(format!(
            "{} missing after that, at the end.",
            are(continuity.lost_after, "tick")
        ));
    }
    if continuity.out_of_order > 0 {
        sentences.push(format!(
            "{} out of order and left out.",
            are(continuity.out_of_order, "tick")
        ));
    }
    sentences
}

fn timing(report: &RunReport) -> Option<String> {
    let timing = report.timing.as_ref()?;
    if timing.is_lockstep() {
        return Some(
            "Every wake-up was exactly at its deadline: the loop ran in lockstep; its timing \
             does not describe a machine."
                .to_owned(),
        );
    }
    let timing = &timing.table;
    let missed = match timing.missed {
        0 => "No deadline was missed".to_owned(),
        1 => "1 deadline was missed".to_owned(),
        missed => format!("{missed} deadlines were missed"),
    };
    timing
        .period_ms
        .within_2_percent
        .is_finite()
        .then(|| {
            format!(
                "{missed}; {:.3} % of the periods lie within ±2 % of {:.3} ms.",
                100.0 * timing.period_ms.within_2_percent,
                1e3 / timing.rate_hz
            )
        })
        .or_else(|| Some("There is only one tick: it has no period.".to_owned()))
}

fn states(report: &RunReport) -> Vec<String> {
    let mut sentences = Vec::new();
    let controller = report.terms.controller;
    let engaged_s = time_in(&report.states, Phase::Engaged);
    let engagements = report
        .states
        .iter()
        .filter(|span| span.phase == Phase::Engaged)
        .count();
    if engagements == 0 {
        sentences.push(format!(
            "The {controller} was never engaged: there are no set points to compare with."
        ));
    } else {
        let times = if engagements > 1 {
            format!(", in {}", plural(engagements as u64, "engagement"))
        } else {
            String::new()
        };
        sentences.push(format!(
            "The {controller} was engaged for {engaged_s:.1} s of {:.1} s{times}.",
            report.duration_s
        ));
    }
    if report.failsafes > 0 {
        sentences.push(format!(
            "It entered failsafe {}, {:.1} s in all.",
            if report.failsafes == 1 {
                "once".to_owned()
            } else {
                format!("{} times", report.failsafes)
            },
            time_in(&report.states, Phase::Failsafe)
        ));
    }
    sentences
}

fn missing(report: &RunReport) -> Vec<String> {
    let mut sentences = Vec::new();
    if report.event_count > report.events.len() {
        sentences.push(format!(
            "Only the first {} of {} events are shown.",
            report.events.len(),
            report.event_count
        ));
    }
    if !report.sensor_ages.is_empty() && !report.has_ages() {
        sentences.push("Every measurement was taken in the tick that used it.".to_owned());
    }
    sentences
}

fn ticks(count: u64) -> String {
    plural(count, "tick")
}

fn are(count: u64, what: &str) -> String {
    let verb = if count == 1 { "is" } else { "are" };
    format!("{} {verb}", plural(count, what))
}

fn plural(count: u64, what: &str) -> String {
    if count == 1 {
        format!("1 {what}")
    } else {
        format!("{count} {what}s")
    }
}

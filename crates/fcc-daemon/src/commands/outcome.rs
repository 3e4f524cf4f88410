//! The end of a flight as text.

use std::fmt::Write as _;

use fcc_flight::flight::{Outcome, Pace};
use fcc_report::{FlownPlan, flight_table, timing_table};

/// Tables, and the state of the recording.
pub(super) fn text(outcome: &Outcome, plan: &FlownPlan) -> String {
    let mut text = String::new();
    // In lockstep there is no real time to keep.
    if outcome.pace == Pace::RealTime {
        text = timing_table(std::slice::from_ref(&outcome.timing));
        text.push_str("\n\n");
    }
    if let Some(flight) = outcome.flight.as_ref().filter(|f| !f.legs.is_empty()) {
        text.push_str(&flight_table(flight, outcome.scored_by));
        text.push_str("\n\n");
    }
    if !plan.is_empty() {
        for part in [plan.text(), plan.finding().unwrap_or_default()] {
            if !part.is_empty() {
                let _ = writeln!(text, "{part}\n");
            }
        }
    }
    for figure in &outcome.figures {
        let _ = writeln!(
            text,
            "{:<32} {:6.2} {}",
            figure.name, figure.value, figure.unit
        );
    }
    if !outcome.figures.is_empty() {
        text.push('\n');
    }
    if let Some(why) = &outcome.not_scored {
        let _ = writeln!(text, "no score: {why}\n");
    }
    let _ = write!(text, "ended: {}", outcome.ending);
    if outcome.failsafes > 0 {
        let times = if outcome.failsafes == 1 {
            "time"
        } else {
            "times"
        };
        let _ = write!(text, "; failsafe {} {times}", outcome.failsafes);
    }
    if outcome.overruns > 0 {
        let _ = write!(text, "; {} ticks overran their budget", outcome.overruns);
    }
    if outcome.unslept > 0 {
        let _ = write!(text, "; {} ticks left no time to sleep", outcome.unslept);
    }
    if !outcome.released {
        text.push_str("; CONTROL MAY STILL BE HELD: release the overrides in the simulator");
    }
    if let Some(recording) = &outcome.recording {
        for file in &recording.files {
            let _ = write!(text, "\nrecorded: {file}");
        }
        if recording.not_recorded > 0 {
            let _ = write!(text, "\nNOT RECORDED: {} messages", recording.not_recorded);
        }
        if let Some(why) = &recording.stopped {
            let _ = write!(text, "\nTHE END IS NOT RECORDED: {why}");
        }
    }
    text
}

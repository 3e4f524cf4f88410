//! `fccd x-plane steps`: what the check does.

use std::fmt::Write as _;

use fcc_xplane_check::STEPS;
use serde_json::json;

use crate::exit::Exit;
use crate::output;

/// Prints the steps.
pub(super) fn list(as_json: bool) -> Exit {
    if as_json {
        let steps = STEPS.map(|step| {
            json!({
                "number": step.number,
                "title": step.title,
                "action": step.action,
                "passes": step.passes,
                "source": step.source,
                "advice": step.advice,
            })
        });
        return output::json(&steps.as_slice(), Exit::Success);
    }
    let mut text = String::new();
    for step in &STEPS {
        let _ = write!(
            text,
            "{:2}. {}\n    {}\n    Passes: {}\n    Limits: {}.\n\n",
            step.number, step.title, step.action, step.passes, step.source
        );
    }
    output::result(text.trim_end(), Exit::Success)
}

//! What a step of the check is.

use serde::Serialize;

use crate::bench::{Bench, Done};
use crate::figure::Figure;

/// A step of the check.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// 1 to 20.
    pub number: u8,
    /// A short name.
    pub title: &'static str,
    /// What happens: what the check does, and what a person does.
    pub action: &'static str,
    /// What has to be seen for it to pass.
    pub passes: &'static str,
    /// Where the limits come from.
    pub source: &'static str,
    /// What to do if it fails.
    pub advice: &'static str,
    /// Does it.
    pub(crate) run: fn(&mut Bench<'_>) -> Done,
    /// Restores what the step has changed, however it ended.
    pub(crate) restore: fn(&mut Bench<'_>),
}

/// How a step ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// All was as it should be.
    Passed,
    /// Something was not.
    Failed,
    /// It was not done.
    Skipped,
}

impl Outcome {
    /// In words.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Skipped => "skipped",
        }
    }
}

/// The result of a step.
#[derive(Clone, Debug, Serialize)]
pub struct StepResult {
    /// Its number.
    pub number: u8,
    /// Its name.
    pub title: &'static str,
    /// How it ended.
    pub outcome: Outcome,
    /// Why it failed or was skipped.
    pub why: Option<String>,
    /// What to do, if it failed.
    pub advice: Option<&'static str>,
    /// How long it took.
    pub duration_s: f64,
    /// What was measured.
    pub figures: Vec<Figure>,
    /// What was noticed.
    pub notes: Vec<String>,
    /// What the daemon said meanwhile, without its status lines.
    pub daemon: Vec<String>,
}

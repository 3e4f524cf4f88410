//! How a step of the check ended.

use serde::Serialize;

use crate::figure::Figure;

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

//! What a step of the check is.

use crate::bench::{Bench, Done};

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

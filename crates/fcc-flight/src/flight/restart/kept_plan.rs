//! The plan that replaced the configuration's, kept for a restart.
//!
//! The [state file](super::state_file) has its hash; its content is in a file beside it,
//! written before the first state with this hash.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::saved::SavedPlan;
use super::state_file;
use crate::config::{Config, PreparedPlan};
use crate::sealed;

/// The beginning of every such file, and the version of its layout.
const NAME: &str = "fccd-plan";
const VERSION: u32 = 1;
/// A plan's file has half of it.
const MOST_BYTES: u64 = 8 << 20;

/// The plans that may have replaced the configuration's.
#[derive(Debug, Default)]
pub(super) struct NotedPlans {
    flown: Option<Arc<PreparedPlan>>,
    next: Option<Arc<PreparedPlan>>,
    /// The recovered flight's is not reported yet.
    is_new: bool,
}

impl NotedPlans {
    /// A flight with this plan is to be recovered.
    pub(super) fn recovered(&mut self, plan: Option<Arc<PreparedPlan>>) {
        self.flown = plan;
        self.is_new = true;
    }

    /// A plan was prepared, and may be flown next.
    pub(super) fn note(&mut self, plan: Arc<PreparedPlan>) {
        self.next = Some(plan);
    }

    /// The plan of the flight to recover, once.
    pub(super) fn report(&mut self) -> Option<Arc<PreparedPlan>> {
        let is_new = std::mem::take(&mut self.is_new);
        self.flown.clone().filter(|_| is_new)
    }

    /// The plan with this hash, which is flown, if it is one of them.
    pub(super) fn flown(&mut self, hash: u64) -> Option<Arc<PreparedPlan>> {
        let is_it = |plan: &mut Arc<PreparedPlan>| plan.replacement.plan_hash == hash;
        if let Some(next) = self.next.take_if(is_it) {
            self.flown = Some(next);
        }
        self.flown
            .clone()
            .filter(|plan| plan.replacement.plan_hash == hash)
    }
}

fn path_of(state: &Path) -> PathBuf {
    state.with_extension("flight.plan")
}

/// Writes the content beside a state file.
pub(super) fn write(state: &Path, content: &str) -> io::Result<()> {
    let bytes = sealed::seal(NAME, VERSION, content.as_bytes());
    sealed::replace(&path_of(state), "plan.new", &bytes)
}

/// Removes it, if it is there.
pub(super) fn remove(state: &Path) -> io::Result<()> {
    state_file::remove(&path_of(state))
}

/// The plan that was flown, if it is not the configuration's.
///
/// # Errors
/// Why it cannot be flown.
pub(super) fn restore(
    state: &Path,
    flown: SavedPlan,
    config: &Config,
) -> Result<Option<PreparedPlan>, String> {
    let own = config.plan.identity();
    let own = own.map_or(0, |identity| identity.hash.first_64_bits());
    if flown.hash == 0 || flown.hash == own {
        return Ok(None);
    }
    let path = path_of(state);
    let missing = |why: &dyn std::fmt::Display| {
        let digits = flown.hash >> 16;
        format!(
            "its plan, {digits:012x}, is not that of plan.file, and {} {why}",
            path.display()
        )
    };
    let bytes = fcc_record::read_own_file(&path, MOST_BYTES).map_err(|error| {
        if error.kind() == ErrorKind::NotFound {
            missing(&"is not there")
        } else {
            missing(&format_args!("cannot be read: {error}"))
        }
    })?;
    let damaged = || missing(&"is damaged");
    let body = sealed::open(NAME, VERSION, &bytes).map_err(|_| damaged())?;
    let content = std::str::from_utf8(body).map_err(|_| damaged())?;
    let plan = config
        .prepare_again(content, 0, flown.uploaded_unix_s)
        .map_err(|_| damaged())?;
    if plan.replacement.plan_hash != flown.hash {
        return Err(missing(&"has another one"));
    }
    Ok(Some(plan))
}

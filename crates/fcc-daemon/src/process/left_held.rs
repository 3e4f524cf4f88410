//! Controls that a daemon which was killed, with its release helper, has left
//! held: the plant's file tells it, and they are released.

use std::time::{Duration, Instant};

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_flight::config::{RestartMode, RestartSection};

/// How long a recovery may take to take control again: nominally 0.7 s.
const RECOVERED_WITHIN: Duration = Duration::from_secs(5);

/// Releases what was left held, unless the interrupted flight is recovered.
pub(super) struct LeftHeld {
    releases: bool,
    after: Duration,
    found: Option<Instant>,
}

impl LeftHeld {
    pub(super) const fn new(section: &RestartSection) -> Self {
        Self {
            releases: section.release_left_held,
            after: match section.mode {
                RestartMode::Cold => Duration::ZERO,
                RestartMode::Warm => RECOVERED_WITHIN,
            },
            found: None,
        }
    }

    /// The plant that was found was left held.
    pub(super) fn found(&mut self) {
        self.found = Some(Instant::now());
    }

    /// Releases it once it is due; `held` is what this program holds.
    pub(super) fn poll(
        &mut self,
        authority: &dyn ControlAuthority,
        held: Option<PlantId>,
        report: &mut dyn FnMut(String),
    ) {
        // Recovered. Without a recovery, the state file of the flight may have
        // begun the release already.
        if held.is_some() && !self.after.is_zero() {
            self.found = None;
        }
        let is_due = |found: &Instant| found.elapsed() >= self.after;
        if self.found.take_if(|found| is_due(found)).is_none() {
            return;
        }
        let was = "an earlier flight was cut off and may have left the controls held";
        if self.releases {
            report(format!("{was}; they are released"));
            authority.release_left();
        } else {
            let by_hand = authority.by_hand();
            report(format!(
                "{was}; they are not released, since restart.release_left_held is false: {by_hand}"
            ));
        }
    }
}

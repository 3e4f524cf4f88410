//! Keeps a release helper running for as long as a flight lasts.

use std::time::{Duration, Instant};

use fcc_core::framework::PlantId;
use fcc_flight::config::Config;

use super::BY_HAND;
use super::notice::Notice;
use super::release_helper::ReleaseHelper;

/// A helper that was started, or could not be, is not started again before this.
const AGAIN_AFTER: Duration = Duration::from_secs(1);
/// A helper that has ended is started again this often.
const TIMES_AGAIN: u32 = 5;

/// The release helper of a flight, and what to do if there is none.
pub(super) struct KeptHelper {
    helper: Option<ReleaseHelper>,
    /// The last start, or attempt.
    started: Instant,
    /// How often it may still be started again.
    again: u32,
    /// The last attempt has failed.
    is_missing: bool,
    untold: Option<String>,
}

impl KeptHelper {
    /// None yet.
    pub(super) fn none() -> Self {
        Self {
            helper: None,
            started: Instant::now(),
            again: TIMES_AGAIN,
            is_missing: false,
            untold: None,
        }
    }

    /// Starts it; whether that succeeded. Without it the flight continues, and
    /// [`keep`](Self::keep) reports that.
    pub(super) fn start(
        &mut self,
        config: &Config,
        notice: &Notice,
        held: Option<PlantId>,
    ) -> bool {
        self.started = Instant::now();
        match ReleaseHelper::start(config, notice, held) {
            Ok(helper) => {
                self.helper = Some(helper);
                self.is_missing = false;
            }
            Err(error) => {
                self.helper = None;
                if !std::mem::replace(&mut self.is_missing, true) {
                    self.untold = Some(format!(
                        "no release helper ({error}): its start is tried again each second; until \
                         then, {BY_HAND}"
                    ));
                }
            }
        }
        self.helper.is_some()
    }

    /// Starts it again if it has ended, for example killed for want of memory,
    /// or could not be started; whether a new one was started.
    pub(super) fn keep(
        &mut self,
        config: &Config,
        notice: &Notice,
        held: Option<PlantId>,
        report: &mut dyn FnMut(String),
    ) -> bool {
        if let Some(words) = self.untold.take() {
            report(words);
        }
        if self.started.elapsed() < AGAIN_AFTER {
            return false;
        }
        if self
            .helper
            .as_mut()
            .is_some_and(|helper| !helper.has_ended())
        {
            return false;
        }
        let has_ended = self.helper.take().is_some();
        if self.again == 0 {
            if has_ended {
                report(format!(
                    "the release helper has ended again, and is not started any more: {BY_HAND}"
                ));
            }
            return false;
        }
        if !self.start(config, notice, held) {
            return false;
        }
        // A failed attempt does not count: it took no pipe.
        self.again -= 1;
        report(if has_ended {
            "the release helper had ended, and was started again".to_owned()
        } else {
            "the release helper, which could not be started before, was started".to_owned()
        });
        true
    }

    pub(super) fn id(&self) -> Option<u32> {
        self.helper.as_ref().map(ReleaseHelper::id)
    }

    /// Ends it; it has nothing to release.
    pub(super) fn end(&mut self) {
        if let Some(helper) = self.helper.take() {
            helper.end();
        }
    }
}

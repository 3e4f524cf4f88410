//! Keeps a release helper running for as long as a flight lasts.

use std::time::{Duration, Instant};

use fcc_core::framework::PlantId;
use fcc_flight::config::Config;

use super::BY_HAND;
use super::notice::Notice;
use super::release_helper::ReleaseHelper;

/// A helper that was started, or could not be, is not started again before this.
const AGAIN_AFTER: Duration = Duration::from_secs(1);
/// A helper that has not read what it was told for so long hangs, or is stopped.
const READS_WITHIN: Duration = Duration::from_secs(5);
/// A helper that has ended, or hangs, is started again this often.
const TIMES_AGAIN: u32 = 5;

/// The release helper of a flight, and what to do if there is none.
pub(super) struct KeptHelper {
    helper: Option<ReleaseHelper>,
    /// The last start, or attempt.
    started: Instant,
    /// Since when it had read all that it was told.
    read: Instant,
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
            read: Instant::now(),
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
        self.read = self.started;
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

    /// Starts it again if it has ended, for example killed for want of memory, or
    /// hangs, or could not be started; whether a new one was started.
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
        let ended = match self.helper.as_mut().map(ReleaseHelper::has_ended) {
            Some(true) => Some("the release helper had ended, and was started again"),
            Some(false) if !self.has_read(notice) => {
                Some("the release helper did not read its input, and was started again")
            }
            Some(false) => return false,
            None => None,
        };
        self.end();
        if self.again == 0 {
            if ended.is_some() {
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
        let not_before = "the release helper, which could not be started before, was started";
        report(ended.unwrap_or(not_before).to_owned());
        true
    }

    /// Whether it has read what it was told, lately.
    fn has_read(&mut self, notice: &Notice) -> bool {
        if notice.is_read() {
            self.read = Instant::now();
        }
        self.read.elapsed() < READS_WITHIN
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

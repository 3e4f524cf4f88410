//! A release that can wait until the controller has prepared the plant for it.

use std::time::Duration;

use fcc_core::framework::{Controller, Tick, Time};

use crate::machine::Machine;
use crate::report::Ending;

/// For no longer than this a release is prepared, whatever the controller says.
const LONGEST: Duration = Duration::from_secs(12);

/// What follows the release.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum After {
    /// The loop ends: it was commanded to.
    StopCommand,
    /// What follows a failsafe.
    Failsafe,
}

/// A release that is being prepared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRelease {
    pub(crate) since: Time,
    pub(crate) after: After,
}

impl<C: Controller> Machine<C> {
    /// Releases when the controller has prepared the plant for it; at once if it
    /// does not, or if this is requested again.
    pub(crate) fn release_prepared(&mut self, after: After, tick: &Tick) {
        let is_repeated = self.prepared.is_some_and(|known| known.after == after);
        let waits = !is_repeated
            && self.state.holds_control()
            && self.controller.prepare_release(tick, &self.measurements);
        if waits {
            let since = tick.scheduled;
            self.prepared = Some(PreparedRelease { since, after });
        } else {
            self.perform_release(after, tick);
        }
    }

    /// Releases if the plant is prepared for it, or was long enough. What ended
    /// control in the meantime ended the preparation, too: a commanded stop then
    /// follows.
    pub(crate) fn follow_prepared_release(&mut self, tick: &Tick) {
        let Some(PreparedRelease { since, after }) = self.prepared else {
            return;
        };
        let is_due = self.controller.is_ready_for_release()
            || tick.scheduled.since(since) >= LONGEST
            || !self.state.holds_control();
        if is_due {
            self.perform_release(after, tick);
        }
    }

    fn perform_release(&mut self, after: After, tick: &Tick) {
        self.prepared = None;
        match after {
            After::StopCommand => self.stop_for(Ending::StopCommand, tick),
            After::Failsafe => self.end_failsafe(tick),
        }
    }
}

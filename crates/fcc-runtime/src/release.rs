//! A commanded stop, which waits until the controller has prepared the plant for
//! its release.

use std::time::Duration;

use fcc_core::framework::{Controller, Tick};

use crate::machine::Machine;
use crate::report::Ending;

/// For no longer than this a release is prepared, whatever the controller says.
const LONGEST: Duration = Duration::from_secs(12);

impl<C: Controller> Machine<C> {
    /// Stops when the controller has prepared the plant for its release; at once
    /// if it does not, or if a stop is commanded again.
    pub(crate) fn stop_by_command(&mut self, tick: &Tick) {
        let waits = self.stopping_since.is_never()
            && self.state.holds_control()
            && self.controller.prepare_release(tick, &self.measurements);
        if waits {
            self.stopping_since = tick.scheduled;
        } else {
            self.stop_for(Ending::StopCommand, tick);
        }
    }

    /// Stops if the plant is prepared, or was long enough. What ended control in
    /// the meantime ended the preparation, too, and the stop follows.
    pub(crate) fn follow_commanded_stop(&mut self, tick: &Tick) {
        if self.stopping_since.is_never() {
            return;
        }
        let is_due = self.controller.is_ready_for_release()
            || tick.scheduled.since(self.stopping_since) >= LONGEST
            || !self.state.holds_control();
        if is_due {
            self.stop_for(Ending::StopCommand, tick);
        }
    }
}

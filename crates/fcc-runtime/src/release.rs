//! A release that waits until the controller has prepared the plant for it.

use std::time::Duration;

use fcc_core::framework::{Controller, Input, State, Tick, Time};

use crate::machine::Machine;
use crate::report::Ending;

/// For no longer than this a release is prepared, whatever the controller says; what falls
/// without control is brought to the ground however long it takes.
const LONGEST: Duration = Duration::from_secs(12);

impl<C: Controller> Machine<C> {
    /// Stops when the controller has prepared the plant for its release; at once
    /// if it does not, or if a stop is commanded again.
    pub(crate) fn stop_by_command(&mut self, tick: &Tick) {
        if self.release_by.take().is_none() && !self.begins_to_release(tick) {
            self.stop_for(Ending::StopCommand, tick);
        }
    }

    /// Gives control back by an input: on the ground, if the plant falls without control.
    pub(crate) fn release_by(&mut self, input: Input, tick: &Tick) {
        let is_begun = !self.stopping_since.is_never();
        if !self.controller.releases_on_the_ground() || !self.state.holds_control() {
            self.apply_input(input, tick);
        } else if !is_begun && self.begins_to_release(tick) {
            self.release_by = Some(input);
        } else if !is_begun {
            self.apply_input(input, tick);
        }
    }

    /// Whether a release is prepared from now on.
    fn begins_to_release(&mut self, tick: &Tick) -> bool {
        let waits = self.stopping_since.is_never()
            && self.state.holds_control()
            && self.controller.prepare_release(tick, &self.measurements);
        if waits {
            self.stopping_since = tick.scheduled;
        }
        waits
    }

    /// Releases if the plant is prepared, or was long enough. What ended control in
    /// the meantime ended the preparation, too, and a stop follows.
    pub(crate) fn follow_release(&mut self, tick: &Tick) {
        if self.stopping_since.is_never() {
            return;
        }
        let too_long = !self.controller.releases_on_the_ground()
            && tick.scheduled.since(self.stopping_since) >= LONGEST;
        if !self.controller.is_ready_for_release() && !too_long && self.state.holds_control() {
            return;
        }
        self.stopping_since = Time::NEVER;
        match self.release_by.take() {
            None => self.stop_for(Ending::StopCommand, tick),
            Some(input) => {
                self.apply_input(input, tick);
                if self.state == State::Stopped {
                    self.end_by(Ending::SwitchedOff);
                }
            }
        }
    }
}

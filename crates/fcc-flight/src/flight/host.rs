//! The host program of a flight.

use std::io;
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId, Released};
use fcc_runtime::StopHandle;

/// What only the host program can do: catch signals, keep other programs from
/// the same plant, release controls when the process dies.
///
/// By default every method does nothing: `()` is a host that does none of this.
pub trait Host {
    /// A flight is about to begin, and none of its threads exists yet;
    /// `authority` is given if its plant can be held.
    ///
    /// # Errors
    /// When no flight can begin.
    fn prepare(&mut self, _authority: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        Ok(())
    }

    /// The loop exists but does not run yet; `stop` ends it, from any thread.
    ///
    /// # Errors
    /// When the program could not be stopped by the user.
    fn attach(&mut self, _stop: &StopHandle) -> io::Result<()> {
        Ok(())
    }

    /// All threads of the flight run.
    fn started(&mut self) {}

    /// Called 50 times a second in real time; `report` passes a message to the
    /// observers.
    fn poll(&mut self, _report: &mut dyn FnMut(String)) {}

    /// The plant, if another program controls it; the flight then ends.
    fn taken_by_another(&self) -> Option<PlantId> {
        None
    }

    /// Called before a command that takes control by itself.
    fn before_control(&mut self) {}

    /// What is done when the loop hangs and the program has not ended orderly
    /// in time, in the watchdog's thread; its argument is whether the controls
    /// were released.
    fn last_resort(&self) -> Box<dyn FnOnce(bool) + Send> {
        Box::new(|_| ())
    }

    /// What continues if the plant did not confirm the release of its controls,
    /// as text that is appended to a message and begins with a semicolon; may
    /// be empty.
    fn continues_release(&self) -> &'static str {
        ""
    }

    /// The same, and it continues from now on: nothing here takes control again.
    fn continue_release(&mut self) -> &'static str {
        ""
    }

    /// The flight is over, and so is the release of the controls, if they were held.
    fn end(&mut self, _released: Released) {}

    /// What ended the flight from outside, as text for users.
    fn interrupted_by(&self) -> Option<&'static str> {
        None
    }
}

impl Host for () {}

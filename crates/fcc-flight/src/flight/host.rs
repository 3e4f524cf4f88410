//! The program that a flight is flown in.

use std::io;
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_runtime::StopHandle;

/// What only the program around a flight can do: catch signals, keep other
/// programs from the same plant, give controls back when the process dies.
///
/// Every method does nothing unless it is written: `()` is a program that does
/// none of it.
pub trait Host {
    /// A flight is about to begin, and none of its threads exists; `authority`
    /// where its plant can be held.
    ///
    /// # Errors
    /// When no flight can begin here.
    fn prepare(&mut self, _authority: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        Ok(())
    }

    /// The loop is there and does not run yet; `stop` ends it, from any thread.
    ///
    /// # Errors
    /// When the program could not be told to end the flight.
    fn attach(&mut self, _stop: &StopHandle) -> io::Result<()> {
        Ok(())
    }

    /// All threads of the flight run.
    fn started(&mut self) {}

    /// Called 50 times a second in real time.
    fn poll(&mut self) {}

    /// The plant, if another program controls it: the flight ends.
    fn taken_by_another(&self) -> Option<PlantId> {
        None
    }

    /// The next command takes control by itself.
    fn before_control(&mut self) {}

    /// What is done when the loop hangs and was given time to end in good
    /// command, in the watchdog's thread; it is told whether the controls were
    /// given back.
    fn last_resort(&self) -> Box<dyn FnOnce(bool) + Send> {
        Box::new(|_| ())
    }

    /// What goes on where the plant does not show that it has its controls
    /// back, in words that follow on a comma or semicolon; may be empty.
    fn continues_release(&self) -> &'static str {
        ""
    }

    /// The flight is over, and the plant has its controls or has not.
    fn end(&mut self, _released: bool) {}

    /// Whether somebody ended the flight from outside.
    fn was_interrupted(&self) -> bool {
        false
    }
}

impl Host for () {}

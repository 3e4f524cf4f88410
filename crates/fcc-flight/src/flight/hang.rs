//! What is left to do when the loop hangs: give the controls back, save the
//! recording, end.
//!
//! The watchdog's thread cannot use the loop's actuator, which is in the hands
//! of whoever hangs. It gives the controls back by a way of its own. Then it
//! leaves the orderly end (what is in the ring, the recording, the account) to
//! the main thread, for a while: should that one hang too, on a terminal or on
//! a disk, the program ends without it.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use fcc_core::framework::ControlAuthority;
use fcc_runtime::{Hang, Link, WatchdogConfig, watch};
use fcc_timer::RealtimeGranted;

use super::pilot::Pilot;

/// How long the watchdog waits for the plant to show that it has its controls
/// back.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(1);
/// How long the main thread may take to end in good order.
const GRACE: Duration = Duration::from_secs(3);

/// A loop that hung, and what became of the controls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hung {
    /// How long it had shown no progress.
    pub(super) silent: Duration,
    /// Whether the plant shows that it has its controls back.
    pub(super) released: bool,
}

/// Learns from the watchdog that the loop hung.
pub(super) struct HangWatch {
    told: Receiver<Hung>,
}

impl HangWatch {
    /// Starts the watchdog, if one is wanted: `hang_after`. Gives also what the
    /// kernel granted it. `last_resort` ends the program if nobody else does.
    ///
    /// # Errors
    /// When there is no thread to be had.
    pub(super) fn start(
        hang_after: Option<Duration>,
        loop_priority: Option<u8>,
        link: &Link<Pilot>,
        authority: Option<Arc<dyn ControlAuthority>>,
        last_resort: Box<dyn FnOnce(bool) + Send>,
    ) -> io::Result<Option<(Self, RealtimeGranted)>> {
        let Some(hang_after) = hang_after else {
            return Ok(None);
        };
        let config = WatchdogConfig {
            hang_after,
            loop_priority,
        };
        let stop = link.stop.clone();
        let (tell, told) = mpsc::channel();
        let granted = watch(link.heartbeat.clone(), &config, move |Hang { silent }| {
            // Should it wake up once more, it lets go by itself.
            stop.stop();
            let released = authority.is_none_or(|authority| give_back(authority.as_ref()));
            // If nobody listens any more, the program is about to end.
            let _ = tell.send(Hung { silent, released });
            thread::sleep(GRACE);
            last_resort(released);
        })?;
        Ok(Some((Self { told }, granted)))
    }

    /// The hang, once the controls were given back.
    pub(super) fn hung(&self) -> Option<Hung> {
        self.told.try_recv().ok()
    }
}

/// Whether the plant has its controls, back or still.
fn give_back(authority: &dyn ControlAuthority) -> bool {
    authority.held().is_none_or(|plant| {
        authority
            .release(&plant, GIVE_BACK_WITHIN, &mut || false)
            .is_ok_and(fcc_core::framework::Released::is_over)
    })
}

//! What happens when the loop hangs: the controls are released, the recording
//! is saved, the program ends.
//!
//! The watchdog's thread cannot use the loop's actuator, which belongs to the
//! hung thread. It releases the controls independently. Then it leaves the
//! orderly end (messages in the ring, the recording, the statistics) to the
//! main thread, for a limited time: if that one hangs too, on a terminal or a
//! disk, the program ends without it.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use fcc_core::framework::ControlAuthority;
use fcc_runtime::{Hang, Link, WatchdogConfig, watch};
use fcc_timer::RealtimeGranted;

use super::pilot::Pilot;

/// How long the watchdog waits for the plant to confirm the release of its
/// controls.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(1);
/// How long the main thread may take to end orderly.
const GRACE: Duration = Duration::from_secs(3);

/// A hang of the loop, and the result of the release.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hung {
    /// How long it had made no progress.
    pub(super) silent: Duration,
    /// Whether the plant confirmed the release of its controls.
    pub(super) released: bool,
}

/// Receives a hang of the loop from the watchdog.
pub(super) struct HangWatch {
    receiver: Receiver<Hung>,
}

impl HangWatch {
    /// Starts the watchdog, if `hang_after` is given. Also returns what the
    /// kernel granted it. `last_resort` ends the program if the main thread
    /// does not.
    ///
    /// # Errors
    /// When no thread can be created.
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
        let (sender, receiver) = mpsc::channel();
        let granted = watch(link.heartbeat.clone(), &config, move |Hang { silent }| {
            // If it wakes up once more, it releases by itself.
            stop.stop();
            let released = authority.is_none_or(|authority| release_controls(authority.as_ref()));
            // If the receiver no longer exists, the program is about to end.
            let _ = sender.send(Hung { silent, released });
            thread::sleep(GRACE);
            last_resort(released);
        })?;
        Ok(Some((Self { receiver }, granted)))
    }

    /// The hang, after the release of the controls.
    pub(super) fn hung(&self) -> Option<Hung> {
        self.receiver.try_recv().ok()
    }
}

/// Releases the controls; whether they are free now.
fn release_controls(authority: &dyn ControlAuthority) -> bool {
    authority.held().is_none_or(|plant| {
        authority
            .release(&plant, GIVE_BACK_WITHIN, &mut || false)
            .is_ok_and(fcc_core::framework::Released::is_over)
    })
}

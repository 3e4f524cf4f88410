//! What happens when the loop hangs: the controls are released, the recording
//! is saved, the program ends.
//!
//! The watchdog's thread cannot use the loop's actuator, which belongs to the
//! hung thread. It releases the controls independently. Then it leaves the
//! orderly end (messages in the ring, the recording, the statistics) to the
//! main thread, for a limited time: if that one hangs too, on a terminal or a
//! disk, the program ends without it.

//!
//! The watchdog's thread may fail, too. If its release of the controls panics, it
//! counts as not confirmed; if that never returns, a further thread ends the program.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::time::Duration;
use std::{io, thread};

use fcc_core::framework::{ControlAuthority, Controller};
use fcc_runtime::{Hang, HeartbeatReading, Link, WatchdogConfig, watch};
use fcc_timer::RealtimeGranted;

use super::host::Host;

/// How long the watchdog waits for the plant to confirm the release of its
/// controls.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(1);
/// How long the main thread may take to end orderly.
const GRACE: Duration = Duration::from_secs(3);
/// After this the program ends although the release does not return.
const AT_LAST: Duration = Duration::from_secs(5);
/// The stack of the thread that ends the program then.
const STACK_BYTES: usize = 128 << 10;

/// A hang of the loop, and the result of the release.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hung {
    /// How long it had made no progress.
    pub(crate) silent: Duration,
    /// Whether the plant confirmed the release of its controls.
    pub(crate) released: bool,
}

/// Receives a hang of the loop from the watchdog.
pub(crate) struct HangWatch {
    receiver: Receiver<Hung>,
    is_over: bool,
}

impl HangWatch {
    /// Starts the watchdog. Also returns what the kernel granted it. The host's
    /// last resort ends the program if the main thread does not.
    ///
    /// # Errors
    /// When no thread can be created.
    pub(crate) fn start<C: Controller>(
        config: &WatchdogConfig,
        link: &Link<C>,
        authority: Option<Arc<dyn ControlAuthority>>,
        host: &dyn Host,
    ) -> io::Result<(Self, RealtimeGranted)> {
        let stop = link.stop.clone();
        let (last_resort, at_last) = (host.last_resort(), host.last_resort());
        let (sender, receiver) = mpsc::channel();
        let granted = watch(link.heartbeat.clone(), config, move |Hang { silent }| {
            // If it wakes up once more, it releases by itself.
            stop.stop();
            // Without that thread the release has to return.
            let _ = thread::Builder::new()
                .name("fcc-end".to_owned())
                .stack_size(STACK_BYTES)
                .spawn(move || {
                    thread::sleep(AT_LAST);
                    at_last(false);
                });
            // A panic's message may wait for a full pipe; that thread does not.
            let release = || authority.is_none_or(|authority| release_controls(authority.as_ref()));
            let released = catch_unwind(AssertUnwindSafe(release)).unwrap_or(false);
            // If the receiver no longer exists, the program is about to end.
            let _ = sender.send(Hung { silent, released });
            thread::sleep(GRACE);
            last_resort(released);
        })?;
        let is_over = false;
        Ok((Self { receiver, is_over }, granted))
    }

    /// The hang, after the release of the controls.
    pub(crate) fn look<C: Controller>(
        &mut self,
        link: &Link<C>,
        report: &mut dyn FnMut(String),
    ) -> Option<Hung> {
        match self.receiver.try_recv() {
            Ok(hung) => return Some(hung),
            // It ends with the loop.
            Err(TryRecvError::Disconnected)
                if !self.is_over && link.heartbeat.read() != HeartbeatReading::Ended =>
            {
                self.is_over = true;
                report("the watchdog has ended: a loop that hangs is not noticed".to_owned());
            }
            Err(TryRecvError::Disconnected | TryRecvError::Empty) => {}
        }
        None
    }
}

/// Releases the controls; whether they are free now.
fn release_controls(authority: &dyn ControlAuthority) -> bool {
    #[cfg(feature = "fault-injection")]
    super::injection::fail_release();
    authority.held().is_none_or(|plant| {
        authority
            .release(&plant, GIVE_BACK_WITHIN, &mut || false)
            .is_ok_and(fcc_core::framework::Released::is_over)
    })
}

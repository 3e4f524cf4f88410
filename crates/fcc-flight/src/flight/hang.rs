//! What is left to do when the loop hangs: give the controls back, save the
//! recording, end.
//!
//! The watchdog's thread cannot use the loop's actuator, which is in the hands
//! of whoever hangs. It gives X-Plane's controls back by a socket of its own,
//! as the guard process does. Then it leaves the orderly end (what is in the
//! ring, the recording, the account) to the main thread, for a while: should
//! that one hang too, on a terminal or on a disk, the process ends without it.

use std::io;
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use fcc_runtime::{Hang, Link, WatchdogConfig, watch};
use fcc_timer::RealtimeGranted;
use fcc_xplane::{Released, XPlane, XPlaneConfig, XPlaneStatus};

use super::Pilot;
use crate::config::{WatchdogSection, XPlaneSection};
use crate::exit::Exit;

/// How long the watchdog waits for X-Plane to show that it has its controls
/// back. The guard process goes on where this ends.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(1);
/// How long the main thread may take to end in good order.
const GRACE: Duration = Duration::from_secs(3);

/// A loop that hung, and what became of the controls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hung {
    /// How long it had shown no progress.
    pub(super) silent: Duration,
    /// Whether X-Plane shows that it has its controls back.
    pub(super) released: bool,
}

/// Hears of the watchdog.
pub(super) struct HangWatch {
    told: Receiver<Hung>,
}

impl HangWatch {
    /// Starts the watchdog, if one is wanted. Gives also what the kernel granted
    /// it; `at` is where controls may be held.
    ///
    /// # Errors
    /// When there is no thread to be had.
    pub(super) fn start(
        section: &WatchdogSection,
        period: Duration,
        loop_priority: Option<u8>,
        link: &Link<Pilot>,
        at: Option<(XPlaneStatus, XPlaneSection)>,
    ) -> io::Result<Option<(Self, RealtimeGranted)>> {
        if !section.enabled {
            return Ok(None);
        }
        let config = WatchdogConfig {
            hang_after: section.hang_after(period),
            loop_priority,
        };
        let stop = link.stop.clone();
        let (tell, told) = mpsc::channel();
        let granted = watch(link.heartbeat.clone(), &config, move |Hang { silent }| {
            // Should it wake up once more, it lets go by itself.
            stop.stop();
            let released = at.is_none_or(|(status, section)| give_back(&status, &section));
            // If nobody listens any more, the process is about to end.
            let _ = tell.send(Hung { silent, released });
            thread::sleep(GRACE);
            let exit = if released {
                Exit::Hung
            } else {
                Exit::NotReleased
            };
            // At once, as a crash would: what runs at an orderly exit may wait for
            // a thread that hangs, and has had its time.
            signal_hook::low_level::exit(i32::from(exit as u8));
        })?;
        Ok(Some((Self { told }, granted)))
    }

    /// The hang, once the controls were given back.
    pub(super) fn hung(&self) -> Option<Hung> {
        self.told.try_recv().ok()
    }
}

/// Whether X-Plane has its controls, back or still.
fn give_back(status: &XPlaneStatus, section: &XPlaneSection) -> bool {
    let Some(simulator) = status.held_at() else {
        return true;
    };
    let released =
        XPlane::release_and_wait(&XPlaneConfig::from(section), simulator, GIVE_BACK_WITHIN);
    matches!(released, Ok(Released::Confirmed | Released::Gone))
}

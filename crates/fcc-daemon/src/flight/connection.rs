//! The connection to X-Plane, as people see it from outside the loop.

use std::net::SocketAddrV4;
use std::time::{Duration, Instant};

use fcc_xplane::{Trouble, XPlaneStatus};

use super::guard::Guard;
use crate::config::XPlaneSection;

/// Trouble that lasts this long is worth a word: at the start, X-Plane has
/// not had the time to answer.
const PATIENCE: Duration = Duration::from_secs(1);

/// Watches the connection to X-Plane, and keeps the guard informed.
pub(super) struct Connection {
    status: XPlaneStatus,
    guard: Option<Guard>,
    trouble: Option<(Trouble, Instant)>,
    told: Option<Trouble>,
}

impl Connection {
    /// Watches from now on. Without a guard the flight goes on, and says so.
    pub(super) fn watch(status: XPlaneStatus, section: &XPlaneSection) -> Self {
        let guard = Guard::start(section)
            .inspect_err(|error| {
                eprintln!(
                    "no guard process ({error}): if this process is killed, release X-Plane's \
                     overrides by hand"
                );
            })
            .ok();
        Self {
            status,
            guard,
            trouble: None,
            told: None,
        }
    }

    /// What has changed, in words; none if there is nothing to say.
    pub(super) fn poll(&mut self) -> Option<String> {
        if let (Some(guard), Some(simulator)) = (&mut self.guard, self.status.simulator()) {
            guard.tell(simulator);
        }
        let now = self.status.trouble();
        if self.trouble.map(|(trouble, _)| trouble) != now {
            self.trouble = now.map(|trouble| (trouble, Instant::now()));
        }
        match self.trouble {
            Some((trouble, since)) if since.elapsed() >= PATIENCE && self.told != Some(trouble) => {
                self.told = Some(trouble);
                Some(trouble.to_string())
            }
            None if self.told.take().is_some() => self
                .simulator()
                .map(|simulator| format!("X-Plane at {simulator} answers")),
            _ => None,
        }
    }

    /// The flight is over; `released` says whether control was given back.
    pub(super) fn end(self, released: bool) {
        // A guard that is not dismissed sees the pipe end and releases.
        if let Some(guard) = self.guard.filter(|_| released) {
            guard.dismiss();
        }
    }

    fn simulator(&self) -> Option<SocketAddrV4> {
        self.status.simulator()
    }
}

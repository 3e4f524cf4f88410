//! What a reading program has opened: at one place, by one process.

use std::time::{Duration, Instant};

use super::WatchError;
use super::place::{Elsewhere, FoundPlace, Presence, look, look_elsewhere};
use fcc_telemetry::Instance;

/// How long a daemon that is between two publishing processes is waited for:
/// the second publishes within a second.
const BETWEEN: Duration = Duration::from_millis(1_500);
const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Ports that a process has opened.
///
/// A process that has forked leaves a copy of them in the other one. That is
/// never used there, and never dropped: it would remove the first one's files.
#[derive(Debug)]
pub(super) struct Connected<T> {
    pub(super) place: FoundPlace,
    ports: Option<T>,
    process: u32,
}

impl<T> Connected<T> {
    /// Opens the ports of a daemon.
    ///
    /// # Errors
    /// Those of `open`, unless a moment later it succeeds at another place; and
    /// when nobody publishes by this name.
    pub(super) fn open<E: From<WatchError>>(
        instance: &Instance,
        open: impl Fn(&FoundPlace) -> Result<T, E>,
    ) -> Result<Self, E> {
        let deadline = Instant::now() + BETWEEN;
        let mut last = None;
        loop {
            match look(instance) {
                Presence::Here(place) => match open(&place) {
                    Ok(ports) => return Ok(Self::at(place, ports)),
                    Err(error) if place.now() == Presence::Here(place) => return Err(error),
                    Err(error) => last = Some(error),
                },
                Presence::Between => {}
                Presence::Absent => break,
            }
            if Instant::now() > deadline {
                break;
            }
            std::thread::sleep(LOOK_EVERY);
        }
        Err(last.unwrap_or_else(|| not_running(instance).into()))
    }

    pub(super) fn at(place: FoundPlace, ports: T) -> Self {
        Self {
            place,
            ports: Some(ports),
            process: std::process::id(),
        }
    }

    /// # Errors
    /// In another process than the one that has opened them.
    pub(super) fn ports(&self) -> Result<&T, WatchError> {
        let ours = self.ports.as_ref().filter(|_| !self.is_forked());
        ours.ok_or(WatchError::Forked)
    }

    fn is_forked(&self) -> bool {
        self.process != std::process::id()
    }
}

impl<T> Drop for Connected<T> {
    fn drop(&mut self) {
        if self.is_forked() {
            std::mem::forget(self.ports.take());
        }
    }
}

/// Nobody publishes by this name; perhaps another user does.
fn not_running(instance: &Instance) -> WatchError {
    let instance = instance.clone();
    match look_elsewhere(&instance) {
        Elsewhere::User(user) => WatchError::Anothers { instance, user },
        Elsewhere::Hidden => WatchError::PerhapsAnothers(instance),
        Elsewhere::Nobody => WatchError::NotRunning(instance),
    }
}

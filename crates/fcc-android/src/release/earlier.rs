//! Releases on behalf of an earlier process.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::helper::Session;
use super::mark::NAME;

/// How many flights have begun in this process: each ends the release on behalf of an
/// earlier process, and does it itself.
static FLIGHTS: AtomicU64 = AtomicU64::new(0);

/// Locked while something is released on behalf of an earlier process.
static RELEASING: Mutex<()> = Mutex::new(());

/// A flight is about to begin: ends such a release, and its use of ports.
pub(crate) fn begin_flight() {
    FLIGHTS.fetch_add(1, Ordering::SeqCst);
    drop(releasing());
}

fn releasing() -> MutexGuard<'static, ()> {
    RELEASING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Releases what an earlier process has left held, if there is something, until a flight
/// begins here; what became of it, for users, empty if there was nothing.
pub(crate) fn release_left(folder: &Path) -> String {
    let _releasing = releasing();
    let flights = FLIGHTS.load(Ordering::SeqCst);
    let path = folder.join(NAME);
    let Ok(lines) = fs::read_to_string(&path) else {
        return String::new();
    };
    let mut session = Session::default();
    lines.lines().for_each(|line| session.line(line));
    let Some(left) = session.held() else {
        // Of another version, or damaged: it cannot be used.
        let _ = fs::remove_file(path);
        return String::new();
    };
    if !session.releases_left {
        return String::new();
    }
    let (became, is_over) = left.release(|| FLIGHTS.load(Ordering::SeqCst) != flights);
    if is_over && FLIGHTS.load(Ordering::SeqCst) == flights {
        let _ = fs::remove_file(path);
    }
    became
}

//! The functions of performance hints (`android/performance_hint.h`), and what became
//! of each session.
//!
//! A session is its number, 1 or more, in place of an address.
#![allow(unsafe_code, reason = "Android's interface is C's")]
#![allow(non_snake_case, reason = "names of functions are C's")]
#![allow(clippy::missing_safety_doc, reason = "as in the NDK")]

use std::ffi::{c_char, c_int, c_void};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{ptr, slice};

use serde::{Deserialize, Serialize};

use crate::control::listen;

/// The address of the only manager.
const MANAGER: usize = 1;

/// How performance hints are played.
#[derive(Clone, Copy, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct PlayedHints {
    /// Whether no session is created.
    refuses: bool,
    /// The time between two reports that the manager asks for; -1 of a device that has
    /// no performance hints.
    preferred_ns: i64,
    /// What a report is answered with: 0, or an error's number.
    answer: c_int,
}

impl PlayedHints {
    const USUAL: Self = Self {
        refuses: false,
        preferred_ns: 50_000_000,
        answer: 0,
    };
}

impl Default for PlayedHints {
    fn default() -> Self {
        Self::USUAL
    }
}

/// A session that was created.
#[derive(Serialize)]
struct Session {
    thread: i32,
    target_ns: i64,
    /// Reports of a positive duration.
    reports: u64,
    shortest_ns: i64,
    longest_ns: i64,
    /// Reports of none, and those after the end.
    wrong_reports: u64,
    is_closed: bool,
}

struct Hints {
    played: PlayedHints,
    sessions: Vec<Session>,
}

static HINTS: Mutex<Hints> = Mutex::new(Hints {
    played: PlayedHints::USUAL,
    sessions: Vec::new(),
});

fn hints() -> MutexGuard<'static, Hints> {
    HINTS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Hints {
    fn session(&mut self, session: *mut c_void) -> Option<&mut Session> {
        self.sessions.get_mut(session.addr().checked_sub(1)?)
    }
}

/// They are played like this from now on.
pub(crate) fn play(how: PlayedHints) {
    hints().played = how;
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn APerformanceHint_getManager() -> *mut c_void {
    listen();
    ptr::without_provenance_mut(MANAGER)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn APerformanceHint_getPreferredUpdateRateNanos(
    _manager: *mut c_void,
) -> i64 {
    hints().played.preferred_ns
}

/// For one thread of this process, as Android demands it.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn APerformanceHint_createSession(
    manager: *mut c_void,
    threads: *const i32,
    count: usize,
    target_ns: i64,
) -> *mut c_void {
    // SAFETY: so many are there.
    let threads = unsafe { slice::from_raw_parts(threads, count) };
    let mut hints = hints();
    let is_own = |thread: i32| Path::new(&format!("/proc/self/task/{thread}")).exists();
    let is_refused = hints.played.refuses || hints.played.preferred_ns <= 0 || target_ns <= 0;
    match threads {
        [thread] if manager.addr() == MANAGER && !is_refused && is_own(*thread) => {
            hints.sessions.push(Session {
                thread: *thread,
                target_ns,
                reports: 0,
                shortest_ns: i64::MAX,
                longest_ns: 0,
                wrong_reports: 0,
                is_closed: false,
            });
            ptr::without_provenance_mut(hints.sessions.len())
        }
        _ => ptr::null_mut(),
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn APerformanceHint_reportActualWorkDuration(
    session: *mut c_void,
    took_ns: i64,
) -> c_int {
    let mut hints = hints();
    let answer = hints.played.answer;
    let Some(session) = hints.session(session) else {
        return libc::EINVAL;
    };
    if took_ns <= 0 || session.is_closed {
        session.wrong_reports += 1;
        return libc::EINVAL;
    }
    session.reports += 1;
    session.shortest_ns = session.shortest_ns.min(took_ns);
    session.longest_ns = session.longest_ns.max(took_ns);
    answer
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn APerformanceHint_closeSession(session: *mut c_void) {
    if let Some(session) = hints().session(session) {
        session.is_closed = true;
    }
}

/// Writes what became of all sessions, the oldest first, as JSON that ends with 0; its
/// length, and nothing written if there is no room for it.
///
/// # Safety
/// There is room for so many bytes.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fake_libandroid_hint_sessions(
    into: *mut c_char,
    room: usize,
) -> usize {
    let text = serde_json::to_string(&hints().sessions).unwrap_or_default();
    if text.len() < room {
        // SAFETY: there is room for it and the 0.
        unsafe {
            ptr::copy_nonoverlapping(text.as_ptr().cast::<c_char>(), into, text.len());
            into.add(text.len()).write(0);
        }
    }
    text.len()
}

//! What a test in Rust calls: the library that the tested code has loaded, and not the
//! copy that is linked into the test.
#![allow(unsafe_code, reason = "a library is loaded, and its interface is C's")]
#![allow(clippy::expect_used, reason = "of tests")]

use std::ffi::{CString, c_char, c_int};
use std::sync::OnceLock;

use serde_json::Value;

type Control = unsafe extern "C" fn(*const c_char) -> c_int;
type HintSessions = unsafe extern "C" fn(*mut c_char, usize) -> usize;

/// Room for the sessions of all tests of a process.
const SESSIONS_BYTES: usize = 1 << 20;

fn library() -> &'static libloading::Library {
    static LIBRARY: OnceLock<libloading::Library> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        // SAFETY: it is this one, and not unloaded.
        let loaded = unsafe { libloading::Library::new("libandroid.so") };
        loaded.expect("cargo has built it for the test")
    })
}

/// Tells the library something, as JSON.
///
/// # Panics
/// When it is not understood.
pub fn tell(line: &Value) {
    let text = CString::new(line.to_string()).expect("JSON has no 0");
    // SAFETY: declared as in `control`.
    let obeyed = unsafe {
        let control = library().get::<Control>(b"fake_libandroid_control\0");
        control.expect("the library is this one")(text.as_ptr())
    };
    assert_eq!(obeyed, 0, "{line}");
}

/// What became of the sessions of performance hints for a thread, the oldest first.
///
/// # Panics
/// When there are too many of them.
pub fn hint_sessions(thread: i32) -> Vec<Value> {
    let mut text = vec![0_u8; SESSIONS_BYTES];
    // SAFETY: declared as in `performance_hints`, and there is so much room.
    let length = unsafe {
        let sessions = library().get::<HintSessions>(b"fake_libandroid_hint_sessions\0");
        let sessions = sessions.expect("the library is this one");
        sessions(text.as_mut_ptr().cast(), text.len())
    };
    let text = text.get(..length).expect("room for all");
    let mut all: Vec<Value> = serde_json::from_slice(text).expect("JSON");
    all.retain(|session| session.get("thread") == Some(&thread.into()));
    all
}

//! A panic in a tick is told by the report and waits for no terminal. The only
//! test of its process: panic hooks are for all threads.
//!
//! A process of its own: the hook is of the whole process.
#![allow(clippy::unwrap_used, reason = "as in any test")]

#[path = "it/bench/mod.rs"]
mod bench;

use std::panic;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use bench::{Stage, parts};
use fcc_runtime::{Ending, Loop, LoopConfig};

static PRINTED: AtomicU32 = AtomicU32::new(0);

#[test]
fn only_other_panics_reach_the_hook() {
    panic::set_hook(Box::new(|_| {
        PRINTED.fetch_add(1, Ordering::SeqCst);
    }));
    let stage = Stage::default();
    stage.set(|s| s.panic_in = Some("sample"));
    let (this, _link) = Loop::new(parts(&stage), &LoopConfig::default()).unwrap();
    let report = this.spawn().unwrap().join();
    assert!(matches!(report.ending, Ending::Panicked(_)));
    assert_eq!(PRINTED.load(Ordering::SeqCst), 0);

    let other = thread::spawn(|| panic!("elsewhere"));
    assert!(other.join().is_err());
    assert_eq!(PRINTED.load(Ordering::SeqCst), 1);
}

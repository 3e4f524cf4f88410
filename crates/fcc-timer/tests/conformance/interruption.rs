//! Interrupts a waiting thread by signals, as a debugger, a profiler or a
//! child's end does.
#![allow(unsafe_code)]

use nix::sys::pthread::{pthread_kill, pthread_self};
use nix::sys::signal::{SaFlags, SigAction, SigHandler, SigSet, Signal, sigaction};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

const SIGNAL: Signal = Signal::SIGUSR1;

thread_local! {
    static HANDLED: Cell<u64> = const { Cell::new(0) };
}

extern "C" fn count(_: libc::c_int) {
    HANDLED.set(HANDLED.get() + 1);
}

struct OnDrop<F: Fn()>(F);

impl<F: Fn()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// How many signals the calling thread handles while `work` runs, which can ask
/// how many there were so far. Without `SA_RESTART`, each of them ends a system
/// call with EINTR.
pub(crate) fn of_this_thread_during(work: impl FnOnce(&dyn Fn() -> u64)) -> u64 {
    let action = SigAction::new(
        SigHandler::Handler(count),
        SaFlags::empty(),
        SigSet::empty(),
    );
    // SAFETY: the handler touches nothing but a number of its own thread.
    unsafe { sigaction(SIGNAL, &action) }.unwrap();

    let before = HANDLED.get();
    let target = pthread_self();
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Acquire) {
                pthread_kill(target, SIGNAL).unwrap();
                thread::sleep(Duration::from_millis(3));
            }
        });
        // Also when the work panics, or the scope would wait for ever.
        let _stop = OnDrop(|| done.store(true, Ordering::Release));
        work(&|| HANDLED.get() - before);
    });
    HANDLED.get() - before
}

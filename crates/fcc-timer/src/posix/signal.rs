//! The real-time signal that a POSIX timer sends: taken for one timer, blocked
//! in its thread, and waited for.
#![allow(unsafe_code)]

use nix::errno::Errno;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread::{self, ThreadId};

use crate::TimerError;
use crate::deadlines::os_error;

/// Which signals belong to a timer now, bit `n - 1` for signal `n`.
static TAKEN: AtomicU64 = AtomicU64::new(0);
/// Marks the signals of one timer: see [`TimerSignal::token`].
static NEXT_TOKEN: AtomicUsize = AtomicUsize::new(1);

/// A real-time signal that belongs to one timer and is blocked in the thread
/// that made this value.
#[derive(Debug)]
pub(super) struct TimerSignal {
    claim: Claim,
    token: usize,
    thread: ThreadId,
    /// Whether the thread let the signal through before.
    was_open: bool,
}

impl TimerSignal {
    /// Takes a free signal and blocks it in the calling thread, where it would
    /// end the process otherwise.
    pub(super) fn block() -> Result<Self, TimerError> {
        let claim = Claim::highest_free().ok_or(TimerError::NoSignal)?;
        let was_open = change_mask(libc::SIG_BLOCK, claim.0)?;
        Ok(Self {
            claim,
            token: NEXT_TOKEN.fetch_add(1, Ordering::Relaxed),
            thread: thread::current().id(),
            was_open,
        })
    }

    pub(super) const fn number(&self) -> libc::c_int {
        self.claim.0
    }

    /// What the timer's signals carry, so that a signal that somebody else
    /// sends, or that a timer long gone left behind, is not taken for an expiry.
    pub(super) const fn token(&self) -> usize {
        self.token
    }

    /// Waits for a signal of the timer.
    pub(super) fn wait(&self) -> Result<(), TimerError> {
        let awaited = only(self.claim.0);
        loop {
            let mut info = MaybeUninit::<libc::siginfo_t>::zeroed();
            // SAFETY: both pointers are to live values of the types called for, and
            // without a time the call waits until there is a signal: that is
            // sigwaitinfo, which libc does not have for Android.
            let answer =
                unsafe { libc::sigtimedwait(&raw const awaited, info.as_mut_ptr(), ptr::null()) };
            match Errno::result(answer) {
                Ok(_) => {}
                Err(Errno::EINTR) => continue,
                Err(errno) => return Err(os_error("sigtimedwait")(errno)),
            }
            // SAFETY: plain data, zeroed above and filled in by the call.
            let info = unsafe { info.assume_init() };
            if info.si_code != libc::SI_TIMER {
                continue;
            }
            // SAFETY: a signal of a timer carries a value.
            let token = unsafe { info.si_value() }.sival_ptr.addr();
            if token == self.token {
                return Ok(());
            }
        }
    }
}

impl Drop for TimerSignal {
    fn drop(&mut self) {
        // Another thread's mask is out of reach: there the signal stays blocked.
        if !self.was_open || thread::current().id() != self.thread {
            return;
        }
        let mine = only(self.claim.0);
        let at_once = libc::timespec {
            tv_sec: 0,
            tv_nsec: 0,
        };
        // SAFETY: the set and the time are live; a null pointer says that the
        // signal's details are not wanted.
        let take_queued =
            || unsafe { libc::sigtimedwait(&raw const mine, ptr::null_mut(), &raw const at_once) };
        // One that is still queued would end the process when let through.
        while take_queued() > 0 {}
        // Blocking it succeeded, with the same arguments: so does this.
        let _ = change_mask(libc::SIG_UNBLOCK, self.claim.0);
    }
}

/// The right to use a signal. Given back when dropped.
#[derive(Debug)]
struct Claim(libc::c_int);

impl Claim {
    fn highest_free() -> Option<Self> {
        (libc::SIGRTMIN()..=libc::SIGRTMAX())
            .rev()
            .find(|&signal| TAKEN.fetch_or(bit(signal), Ordering::AcqRel) & bit(signal) == 0)
            .map(Self)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        TAKEN.fetch_and(!bit(self.0), Ordering::AcqRel);
    }
}

const fn bit(signal: libc::c_int) -> u64 {
    1 << (signal - 1)
}

/// The set of this one signal.
fn only(signal: libc::c_int) -> libc::sigset_t {
    let mut set = MaybeUninit::<libc::sigset_t>::zeroed();
    // SAFETY: the set is live, and `sigemptyset` makes it a valid one. The
    // signal is between SIGRTMIN and SIGRTMAX, so that neither call can fail.
    unsafe {
        libc::sigemptyset(set.as_mut_ptr());
        libc::sigaddset(set.as_mut_ptr(), signal);
        set.assume_init()
    }
}

/// Blocks a signal in the calling thread, or lets it through; tells whether it
/// was let through before.
fn change_mask(how: libc::c_int, signal: libc::c_int) -> Result<bool, TimerError> {
    let changed = only(signal);
    let mut before = changed;
    // SAFETY: both sets are live.
    let errno = unsafe { libc::pthread_sigmask(how, &raw const changed, &raw mut before) };
    if errno != 0 {
        return Err(os_error("pthread_sigmask")(Errno::from_raw(errno)));
    }
    // SAFETY: the set is live, and the signal one that a set can hold.
    Ok(unsafe { libc::sigismember(&raw const before, signal) } == 0)
}

//! The kernel's side of a POSIX timer. nix knows no real-time signals, and its
//! timer may panic when dropped: hence libc.
#![allow(unsafe_code)]

use nix::errno::Errno;
use nix::unistd::gettid;
use std::mem::MaybeUninit;
use std::ptr;

use super::signal::TimerSignal;
use crate::TimerError;
use crate::deadlines::{os_error, timespec};

/// A timer of the kernel that sends a signal to the thread that made it.
#[derive(Debug)]
pub(super) struct IntervalTimer(libc::timer_t);

// SAFETY: the value is the name of a timer in the kernel, good in every thread
// of the process; nothing is reached through it but by system calls.
unsafe impl Send for IntervalTimer {}

impl IntervalTimer {
    pub(super) fn new(signal: &TimerSignal) -> Result<Self, TimerError> {
        // SAFETY: `sigevent` is plain data, for which all zeros is a value.
        let mut event: libc::sigevent = unsafe { MaybeUninit::zeroed().assume_init() };
        event.sigev_notify = libc::SIGEV_THREAD_ID;
        event.sigev_signo = signal.number();
        event.sigev_notify_thread_id = gettid().as_raw();
        event.sigev_value.sival_ptr = ptr::without_provenance_mut(signal.token());
        let mut timer: libc::timer_t = ptr::null_mut();
        // SAFETY: both pointers are to live values of the types called for.
        let answer =
            unsafe { libc::timer_create(libc::CLOCK_MONOTONIC, &raw mut event, &raw mut timer) };
        Errno::result(answer).map_err(os_error("timer_create"))?;
        Ok(Self(timer))
    }

    /// Expires at `first_ns` on `CLOCK_MONOTONIC` and every `interval_ns` after.
    pub(super) fn set(&mut self, first_ns: i64, interval_ns: i64) -> Result<(), TimerError> {
        let times = libc::itimerspec {
            it_value: *timespec(first_ns).as_ref(),
            it_interval: *timespec(interval_ns).as_ref(),
        };
        // SAFETY: the timer is this value's own until dropped; the new times
        // are live, and a null pointer says that the old are not wanted.
        let answer = unsafe {
            libc::timer_settime(
                self.0,
                libc::TIMER_ABSTIME,
                &raw const times,
                ptr::null_mut(),
            )
        };
        Errno::result(answer).map_err(os_error("timer_settime"))?;
        Ok(())
    }
}

impl Drop for IntervalTimer {
    fn drop(&mut self) {
        // SAFETY: the timer is this value's own, and not used after.
        unsafe { libc::timer_delete(self.0) };
    }
}

//! Monitors the loop's progress from a thread of its own.
//!
//! A part that never returns (a controller in an endless loop, a sensor whose
//! read blocks) cannot be stopped from inside, because the loop's thread is
//! executing it. So this thread, at a higher real-time priority than the loop's,
//! reads the loop's [`Heartbeat`]. If it does not advance for too long, this
//! thread takes the loop's real-time priority away, so that the rest of the
//! process can run even on one core, and calls the configured function.

use std::sync::mpsc;
use std::time::{Duration, Instant};
use std::{io, thread};

use fcc_timer::{RealtimeGranted, RealtimeRequest, not_started, realtime};

use crate::heartbeat::{Heartbeat, HeartbeatReading};

/// The name of the watchdog's thread.
const THREAD_NAME: &str = "fcc-watchdog";
/// Size of the thread's stack. With locked memory all of it is resident, so it is
/// kept small; unoptimised code needs larger stack frames.
const STACK_BYTES: usize = if cfg!(debug_assertions) {
    4 << 20
} else {
    256 << 10
};

/// How often the heartbeat is read within the time limit: the watchdog is late by
/// at most this share of it.
const LOOKS: u32 = 10;

/// `SCHED_FIFO` has no higher priority.
const HIGHEST_PRIORITY: u8 = 99;

/// The configuration of a watchdog.
#[derive(Clone, Debug)]
pub struct WatchdogConfig {
    /// A loop without progress for this long hangs.
    pub hang_after: Duration,
    /// The loop's real-time priority; the watchdog requests the next higher.
    /// `None` for the ordinary scheduler.
    pub loop_priority: Option<u8>,
}

/// A loop that hangs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Hang {
    /// How long it has made no progress.
    pub silent: Duration,
}

/// Monitors a loop until it ends; if it hangs, `on_hang` is called in the
/// watchdog's thread. Returns what the kernel granted that thread.
///
/// # Errors
/// When no thread can be created.
pub fn watch(
    heartbeat: Heartbeat,
    config: &WatchdogConfig,
    on_hang: impl FnOnce(Hang) + Send + 'static,
) -> io::Result<RealtimeGranted> {
    let hang_after = config.hang_after;
    let request = RealtimeRequest {
        priority: config
            .loop_priority
            .map(|priority| priority.saturating_add(1).min(HIGHEST_PRIORITY)),
        ..RealtimeRequest::default()
    };
    let (sender, receiver) = mpsc::sync_channel(1);
    thread::Builder::new()
        .name(THREAD_NAME.to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            // Nothing is strict here, so this is never an error.
            let granted = request.apply().unwrap_or_else(|refused| *refused.granted);
            // The receiver waits below.
            let _ = sender.send(granted);
            if let Some(hang) = wait_for_hang(&heartbeat, hang_after) {
                // If this fails, the rest is attempted anyway.
                let _ = realtime::take_priority_from(heartbeat.thread());
                on_hang(hang);
            }
        })
        .map_err(not_started)?;
    receiver
        .recv()
        .map_err(|_| io::Error::other("the watchdog's thread ended before it began to watch"))
}

/// Returns when the loop hangs, or `None` when it has ended.
///
/// Only time in which this thread itself ran counts: a process that is stopped
/// and continued, or a suspended machine, stops both threads and is not a hang.
fn wait_for_hang(heartbeat: &Heartbeat, hang_after: Duration) -> Option<Hang> {
    let look_every = hang_after / LOOKS;
    let mut last = heartbeat.read();
    let mut silent = Duration::ZERO;
    let mut looked = Instant::now();
    loop {
        thread::sleep(look_every);
        let passed = looked.elapsed();
        looked = Instant::now();
        match heartbeat.read() {
            HeartbeatReading::Ended => return None,
            HeartbeatReading::Beat(count) if last == HeartbeatReading::Beat(count) => {
                silent += passed.min(2 * look_every);
                if silent >= hang_after {
                    return Some(Hang { silent });
                }
            }
            felt => {
                last = felt;
                silent = Duration::ZERO;
            }
        }
    }
}

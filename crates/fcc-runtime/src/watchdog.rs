//! Watches, from a thread of its own, that the loop makes progress.
//!
//! A part that never returns (a controller in an endless loop, a sensor whose
//! read blocks) cannot be caught from inside: the loop's own objects are in its
//! hands. So this thread, at a higher real-time priority than the loop's, feels
//! the loop's [`Heartbeat`]. When it stands still for too long, the thread takes
//! the loop's real-time priority away, so that on one core too the rest of the
//! process can run again, and does what it was told to do then.

use std::sync::mpsc;
use std::time::{Duration, Instant};
use std::{io, thread};

use fcc_timer::{RealtimeGranted, RealtimeRequest, realtime};

use crate::heartbeat::{Heartbeat, HeartbeatReading};

/// The name of the watchdog's thread.
const THREAD_NAME: &str = "fcc-watchdog";

/// How often the heartbeat is felt while it may stand still: the watchdog is late
/// by at most this share of the time, and costs ten wake-ups a second at most
/// settings.
const LOOKS: u32 = 10;

/// `SCHED_FIFO` has no higher priority.
const HIGHEST_PRIORITY: u8 = 99;

/// How a watchdog watches.
#[derive(Clone, Debug)]
pub struct WatchdogConfig {
    /// A loop without progress for so long hangs.
    pub hang_after: Duration,
    /// The loop's real-time priority; the watchdog wishes for the next higher.
    /// `None` for the ordinary scheduler.
    pub loop_priority: Option<u8>,
}

/// A loop that hangs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Hang {
    /// How long it has shown no progress.
    pub silent: Duration,
}

/// Watches a loop until it is over; `on_hang` is called in the watchdog's
/// thread should it hang. Gives what the kernel granted that thread.
///
/// # Errors
/// When there is no thread to be had.
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
        .spawn(move || {
            // Nothing is strict here, so nothing is an error.
            let granted = request.apply().unwrap_or_else(|refused| refused.granted);
            // The receiver waits below.
            let _ = sender.send(granted);
            if let Some(hang) = wait_for_hang(&heartbeat, hang_after) {
                // A refusal leaves it as it is; what follows is tried anyway.
                let _ = realtime::take_priority_from(heartbeat.thread());
                on_hang(hang);
            }
        })?;
    receiver
        .recv()
        .map_err(|_| io::Error::other("the watchdog's thread ended before it began to watch"))
}

/// Returns when the loop hangs, or with none when it is over.
///
/// Only time in which this thread itself could look counts: a process that is
/// stopped and continued, or a machine that stands still, stops both threads
/// alike and is no hang.
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

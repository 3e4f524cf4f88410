//! The publishing daemon and its layouts.

use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize};

use super::{Event, LAYOUT, Status, Text};

/// The publishing daemon, its layouts and its conditions.
///
/// This layout never changes: a program of any version reads it first to know
/// whether it can read the rest.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[repr(C)]
pub struct Info {
    /// The version of all other layouts: [`LAYOUT`].
    pub layout: u32,
    /// Size of a record, which depends on the plant.
    pub record_bytes: u32,
    /// Size of an event.
    pub event_bytes: u32,
    /// Size of a status.
    pub status_bytes: u32,
    /// The daemon's process.
    pub process_id: u32,
    /// Priority of the loop's thread under `SCHED_FIFO`; 0 otherwise.
    pub priority: i32,
    /// 1 if all of the daemon's memory is locked, else 0.
    pub memory_locked: u32,
    /// How many real-time requests the kernel denied.
    pub requests_denied: u32,
    /// When publishing began, ns since 1970, UTC.
    pub started_unix_ns: i64,
    /// The same instant on the loop's clock, ns: the difference converts the
    /// times of records to wall-clock time.
    pub started_ns: i64,
    /// Nominal ticks per second.
    pub rate_hz: f64,
    /// Version of the daemon.
    pub software: Text<32>,
    /// The commit it was built from; empty if unknown.
    pub commit: Text<48>,
    /// The loop's timer: `timerfd`, `posix`, `nanosleep`.
    pub timer: Text<16>,
    /// Scheduling policy of the loop's thread: `SCHED_FIFO`, `SCHED_OTHER`.
    pub policy: Text<16>,
    /// The name of the plant.
    pub plant: Text<64>,
    /// The denied requests, as text.
    pub refusals: Text<280>,
}

impl Default for Info {
    /// The layout of this version; everything else unknown.
    fn default() -> Self {
        Self {
            layout: LAYOUT,
            record_bytes: 0,
            event_bytes: size_of::<Event>() as u32,
            status_bytes: size_of::<Status>() as u32,
            process_id: 0,
            priority: 0,
            memory_locked: 0,
            requests_denied: 0,
            started_unix_ns: 0,
            started_ns: 0,
            rate_hz: 0.0,
            software: Text::default(),
            commit: Text::default(),
            timer: Text::default(),
            policy: Text::default(),
            plant: Text::default(),
            refusals: Text::default(),
        }
    }
}

impl Info {
    /// This process at the start of publishing: process, time and layout.
    pub fn of_this_process() -> Self {
        let now_ns = |clock| clock_gettime(clock).map_or(0, |now| now.num_nanoseconds());
        Self {
            process_id: std::process::id(),
            started_unix_ns: now_ns(ClockId::CLOCK_REALTIME),
            started_ns: now_ns(ClockId::CLOCK_MONOTONIC),
            ..Self::default()
        }
    }

    /// Whether this program has the same layouts of events and status, and the
    /// same rules for records.
    pub fn is_understood(&self) -> bool {
        let own = Self::default();
        (self.layout, self.event_bytes, self.status_bytes)
            == (own.layout, own.event_bytes, own.status_bytes)
    }
}

//! Who publishes, and in which layout.

use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};

use super::{Event, LAYOUT, Status, Text};

/// Who publishes, in which layout, and under which conditions.
///
/// This layout is for all time: it is what a program of any version reads first
/// to know whether it understands the rest.
#[derive(Clone, Copy, PartialEq, Debug)]
#[repr(C)]
pub struct Info {
    /// The version of all other layouts: [`LAYOUT`].
    pub layout: u32,
    /// Size of a record, which the plant's types say.
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
    /// How many real-time wishes the kernel refused.
    pub requests_denied: u32,
    /// When the daemon began to publish, ns since 1970, UTC.
    pub started_unix_ns: i64,
    /// The same instant on the loop's clock, ns: the difference turns the times
    /// of records into times of day.
    pub started_ns: i64,
    /// Ticks a second, nominal.
    pub rate_hz: f64,
    /// Version of the daemon.
    pub software: Text<32>,
    /// The commit it was built from; empty if unknown.
    pub commit: Text<48>,
    /// What wakes the loop: `timerfd`, `posix`, `nanosleep`.
    pub timer: Text<16>,
    /// Scheduling of the loop's thread: `SCHED_FIFO`, `SCHED_OTHER`.
    pub policy: Text<16>,
    /// What is flown, in words.
    pub aircraft: Text<64>,
    /// The refused wishes, in words.
    pub refusals: Text<280>,
}

impl Default for Info {
    /// The layout of this version; all else unknown.
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
            aircraft: Text::default(),
            refusals: Text::default(),
        }
    }
}

impl Info {
    /// This process as it begins to publish: process, time and layout.
    pub fn of_this_process() -> Self {
        let now_ns = |clock| clock_gettime(clock).map_or(0, |now| now.num_nanoseconds());
        Self {
            process_id: std::process::id(),
            started_unix_ns: now_ns(ClockId::CLOCK_REALTIME),
            started_ns: now_ns(ClockId::CLOCK_MONOTONIC),
            ..Self::default()
        }
    }

    /// Whether events and status are laid out as this program knows them, and
    /// records by the same rules.
    pub fn is_understood(&self) -> bool {
        let own = Self::default();
        (self.layout, self.event_bytes, self.status_bytes)
            == (own.layout, own.event_bytes, own.status_bytes)
    }
}

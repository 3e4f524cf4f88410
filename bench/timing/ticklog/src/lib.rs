//! The log of every peer: the times of its ticks.
//!
//! A peer creates a [`TickLog`], calls [`TickLog::tick`] first in each tick,
//! and prints the log when that returns false. The harness evaluates the
//! output: one [`Ticks`] as JSON. The peer in Python prints the same fields.

use std::io::Write as _;
use std::time::Duration;

use fcc_timer::{RealtimeRequest, usage};
use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize};

/// The harness' arguments for every peer.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Run {
    /// Ticks per second, 1..=1000000.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub rate: u32,
    /// How long to run, s.
    #[arg(long)]
    pub seconds: f64,
}

impl Run {
    /// The time between ticks.
    #[must_use]
    pub fn period(&self) -> Duration {
        Duration::from_secs(1) / self.rate
    }
}

/// A peer's output: times in ns on `CLOCK_MONOTONIC`.
#[derive(Serialize, Deserialize, Clone, Debug, Default)]
pub struct Ticks {
    /// The scheduling policy that the kernel reads back.
    pub policy: String,
    /// Its priority.
    pub priority: i32,
    /// Origin of the deadlines: tick k is due at `origin_ns + k * period`.
    /// `None` if the peer does not report it.
    pub origin_ns: Option<i64>,
    /// CPU time of the process from the first tick to the last.
    pub cpu_ns: i64,
    /// The time of each tick.
    pub ticks_ns: Vec<i64>,
}

/// Now on `CLOCK_MONOTONIC`, ns; no system call.
#[must_use]
pub fn monotonic_ns() -> i64 {
    // Linux always has this clock.
    clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(0, |now| now.num_nanoseconds())
}

/// The times of the ticks, in memory allocated before the first.
#[derive(Debug)]
pub struct TickLog {
    log: Ticks,
    length: usize,
    run_ns: i64,
    ends_ns: i64,
}

impl TickLog {
    /// Allocates for the run, locks memory, and reads the thread's scheduling.
    /// The harness sets that from outside, in the same way for all.
    ///
    /// # Errors
    /// When the kernel denies something required.
    pub fn new(run: Run) -> anyhow::Result<Self> {
        let run_ns = (run.seconds * 1e9) as i64;
        // A peer that ticks too often fills the log and ends.
        let room = (f64::from(run.rate) * run.seconds * 2.0) as usize + 1_000;
        let ticks_ns = vec![0; room];
        let granted = RealtimeRequest {
            lock_memory: true,
            timer_slack_ns: Some(1),
            ..RealtimeRequest::default()
        }
        .apply()?;
        for denied in &granted.denied {
            eprintln!("{denied}");
        }
        Ok(Self {
            log: Ticks {
                policy: granted.policy.to_owned(),
                priority: granted.priority,
                ticks_ns,
                ..Ticks::default()
            },
            length: 0,
            run_ns,
            ends_ns: 0,
        })
    }

    /// Sets the origin of the deadlines, if the peer knows it.
    pub fn set_origin(&mut self, origin_ns: i64) {
        self.log.origin_ns = Some(origin_ns);
    }

    /// Logs a tick now; returns whether to continue.
    #[inline]
    pub fn tick(&mut self) -> bool {
        match self.stamp() {
            Some(now_ns) => self.keep(now_ns),
            None => self.end(),
        }
    }

    /// The first part of a tick: writes the time into the slot of the next
    /// tick. It has no effect unless it is kept, so a loop may do it in a
    /// warm-up. `None` when the log is full.
    #[inline(never)]
    pub fn stamp(&mut self) -> Option<i64> {
        let now_ns = monotonic_ns();
        let slot = self.log.ticks_ns.get_mut(self.length)?;
        *slot = now_ns;
        Some(now_ns)
    }

    /// Keeps the time last written; returns whether to continue.
    pub fn keep(&mut self, now_ns: i64) -> bool {
        self.length += 1;
        if self.length == 1 {
            self.ends_ns = now_ns + self.run_ns;
            self.log.cpu_ns = usage::process_cpu_ns();
        }
        now_ns < self.ends_ns || self.end()
    }

    fn end(&mut self) -> bool {
        self.log.cpu_ns = usage::process_cpu_ns() - self.log.cpu_ns;
        false
    }

    /// Prints the log for the harness.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn print(mut self) -> anyhow::Result<()> {
        self.log.ticks_ns.truncate(self.length);
        let mut out = std::io::stdout().lock();
        serde_json::to_writer(&mut out, &self.log)?;
        Ok(writeln!(out)?)
    }
}

//! Runs one peer: `peer timerfd --rate 40 --seconds 5`.
//!
//! Each is used as documented, and configured to keep its phase and to skip
//! missed ticks, if it offers that.

use anyhow::Context as _;
use clap::{Args, Parser, Subcommand};
use fcc_timer::{EarlyWake, TimerKind, Wake};
use rtsc::time::{Interval, MissedTickBehavior};
use ticklog::{Run, TickLog, monotonic_ns};
use tokio::time::{self, MissedTickBehavior as TokioMissed};

#[derive(Parser)]
#[command(about = "A periodic loop that logs when it ticked")]
struct Cli {
    #[command(subcommand)]
    peer: Peer,
}

#[derive(Subcommand)]
enum Peer {
    /// Our timerfd.
    Timerfd(Ours),
    /// Our POSIX timer.
    Posix(Ours),
    /// Our `clock_nanosleep`.
    Nanosleep(Ours),
    /// The interval of `rtsc`.
    Rtsc(Run),
    /// The interval of `tokio`, in a runtime of one thread.
    Tokio(Run),
}

#[derive(Args)]
struct Ours {
    #[command(flatten)]
    run: Run,
    /// Wake early and spin to the deadline
    #[arg(long)]
    spin: bool,
}

fn main() -> anyhow::Result<()> {
    match Cli::parse().peer {
        Peer::Timerfd(ours) => ours.tick(TimerKind::Timerfd),
        Peer::Posix(ours) => ours.tick(TimerKind::Posix),
        Peer::Nanosleep(ours) => ours.tick(TimerKind::Nanosleep),
        Peer::Rtsc(run) => rtsc(run),
        Peer::Tokio(run) => tokio(run),
    }
}

impl Ours {
    /// As in the daemon, with its defaults.
    fn tick(self, kind: TimerKind) -> anyhow::Result<()> {
        let period = self.run.period();
        let mut timer = if self.spin {
            kind.build_early(period, &EarlyWake::default())?
        } else {
            kind.build(period)?
        };
        let mut log = TickLog::new(self.run)?;
        timer.start()?;
        let first = timer.wait()?;
        log.set_origin(first.scheduled_ns - period.as_nanos() as i64);
        log.tick();
        loop {
            let wake = timer.wait_or_warm_up()?;
            // The same for a warm-up, without storing the time.
            let now_ns = log.stamp();
            if matches!(wake, Wake::Deadline(_)) && !now_ns.is_some_and(|at| log.keep(at)) {
                return log.print();
            }
        }
    }
}

fn rtsc(run: Run) -> anyhow::Result<()> {
    let mut interval =
        Interval::new(run.period()).set_missing_tick_behavior(MissedTickBehavior::Skip);
    let mut log = TickLog::new(run)?;
    // It counts from its first tick, which does not wait.
    log.set_origin(monotonic_ns());
    interval.tick();
    while log.tick() {
        interval.tick();
    }
    log.print()
}

fn tokio(run: Run) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()
        .context("no runtime")?;
    let log = TickLog::new(run)?;
    runtime.block_on(async {
        let mut log = log;
        log.set_origin(monotonic_ns());
        let mut interval = time::interval(run.period());
        interval.set_missed_tick_behavior(TokioMissed::Skip);
        interval.tick().await;
        while log.tick() {
            interval.tick().await;
        }
        log.print()
    })
}

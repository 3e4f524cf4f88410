//! The peers, and how each is started.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use serde::{Deserialize, Serialize};

/// How long a peer may take beyond twice its run, s.
const PATIENCE_S: f64 = 10.0;

const PYTHON_LOOP: &str = include_str!("../../peers/loop.py");

/// A clock or a peer.
#[derive(clap::ValueEnum, Serialize, Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Peer {
    /// Our timerfd that wakes early and spins.
    TimerfdSpin,
    /// Our POSIX timer that wakes early and spins.
    PosixSpin,
    /// Our `clock_nanosleep` that wakes early and spins.
    NanosleepSpin,
    /// Our timerfd.
    Timerfd,
    /// Our POSIX timer.
    Posix,
    /// Our `clock_nanosleep`.
    Nanosleep,
    /// cyclictest of rt-tests: the best that the kernel achieves.
    Cyclictest,
    /// copper's loop with its high-precision limiter.
    CopperPrecise,
    /// copper's loop.
    Copper,
    /// rtsc's interval.
    Rtsc,
    /// tokio's interval.
    Tokio,
    /// A loop in Python.
    Python,
}

/// The conditions, the same for every peer.
#[derive(Clone, Copy)]
pub(crate) struct Conditions {
    pub(crate) rate_hz: u32,
    /// From the first tick to the last, s.
    pub(crate) seconds: f64,
    /// `SCHED_FIFO` with this priority, where it is granted.
    pub(crate) priority: Option<u8>,
    pub(crate) cpu: usize,
}

impl Peer {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::TimerfdSpin => "fccd timerfd, spin",
            Self::PosixSpin => "fccd posix, spin",
            Self::NanosleepSpin => "fccd nanosleep, spin",
            Self::Timerfd => "fccd timerfd",
            Self::Posix => "fccd posix",
            Self::Nanosleep => "fccd nanosleep",
            Self::Cyclictest => "cyclictest",
            Self::CopperPrecise => "copper, high precision",
            Self::Copper => "copper",
            Self::Rtsc => "rtsc",
            Self::Tokio => "tokio",
            Self::Python => "Python",
        }
    }

    /// Whether it is one of ours.
    pub(crate) const fn is_ours(self) -> bool {
        matches!(self, Self::Timerfd | Self::Posix | Self::Nanosleep) || self.spins()
    }

    /// Whether it is one of ours that spins.
    pub(crate) const fn spins(self) -> bool {
        matches!(
            self,
            Self::TimerfdSpin | Self::PosixSpin | Self::NanosleepSpin
        )
    }

    /// The command under these conditions.
    pub(crate) fn command(self, under: Conditions) -> anyhow::Result<Command> {
        let rate = under.rate_hz.to_string();
        let seconds = under.seconds.to_string();
        let run = ["--rate", &rate, "--seconds", &seconds];
        let ours = |timer: &str| -> anyhow::Result<Vec<String>> {
            let mut words = words(&sibling("peer")?, &[timer]);
            words.extend(run.map(str::to_owned));
            if self.spins() {
                words.push("--spin".to_owned());
            }
            Ok(words)
        };
        let words = match self {
            Self::TimerfdSpin | Self::Timerfd => ours("timerfd")?,
            Self::PosixSpin | Self::Posix => ours("posix")?,
            Self::NanosleepSpin | Self::Nanosleep => ours("nanosleep")?,
            Self::Rtsc => ours("rtsc")?,
            Self::Tokio => ours("tokio")?,
            Self::CopperPrecise => words(&sibling("peer-copper-precise")?, &run),
            Self::Copper => words(&sibling("peer-copper")?, &run),
            Self::Python => words(Path::new("python3"), &["-c", PYTHON_LOOP, &rate, &seconds]),
            Self::Cyclictest => return Ok(cyclictest(under)),
        };
        let mut command = bounded(under);
        command.args(["taskset", "--cpu-list", &under.cpu.to_string()]);
        if let Some(priority) = under.priority {
            command.args(["chrt", "--fifo", &priority.to_string()]);
        }
        command.args(words);
        Ok(command)
    }
}

/// Ends a peer that does not end by itself, long after it should have.
fn bounded(under: Conditions) -> Command {
    let seconds = PATIENCE_S + 2.0 * under.seconds;
    let mut command = Command::new("timeout");
    command.args(["--kill-after=1", &seconds.to_string()]);
    command
}

fn words(program: &Path, arguments: &[&str]) -> Vec<String> {
    let mut words = vec![program.to_string_lossy().into_owned()];
    words.extend(arguments.iter().map(|&argument| argument.to_owned()));
    words
}

/// Only its measuring thread gets the priority and the CPU: the other one only
/// prints, and no other peer prints while it ticks.
fn cyclictest(under: Conditions) -> Command {
    let interval_us = 1_000_000 / under.rate_hz;
    let ticks = (f64::from(under.rate_hz) * under.seconds) as u64;
    let mut command = bounded(under);
    command
        .args([
            "cyclictest",
            "--mlockall",
            "--nsecs",
            "--verbose",
            "--quiet",
            "--threads=1",
        ])
        .arg(format!("--affinity={}", under.cpu))
        .arg(format!("--interval={interval_us}"))
        .arg(format!("--loops={ticks}"));
    if let Some(priority) = under.priority {
        command.arg(format!("--priority={priority}"));
    }
    command
}

/// A program built together with this one.
fn sibling(name: &str) -> anyhow::Result<PathBuf> {
    let path = env::current_exe()?.with_file_name(name);
    path.exists()
        .then_some(path)
        .with_context(|| format!("{name} is not built: use `make bench-timing`"))
}

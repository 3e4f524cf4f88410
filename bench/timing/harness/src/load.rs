//! The load of the machine: none, or `stress-ng`.

use std::process::{Child, Command, Stdio};
use std::thread::{self, available_parallelism};
use std::time::Duration;

use anyhow::Context as _;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde::{Deserialize, Serialize};

/// Memory that is written repeatedly. More would displace what is measured from
/// a small board's memory.
const VM_BYTES: &str = "128M";
/// Time until all stressors run.
const SETTLE: Duration = Duration::from_secs(1);

/// The load of the machine.
#[derive(clap::ValueEnum, Serialize, Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Load {
    /// Nothing.
    Idle,
    /// All of the three below at once.
    Stress,
    /// Arithmetic on every CPU.
    Cpu,
    /// `sync` without end.
    Io,
    /// Mapping, writing and unmapping memory.
    Vm,
}

impl Load {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Stress => "stress",
            Self::Cpu => "cpu",
            Self::Io => "io",
            Self::Vm => "vm",
        }
    }

    /// Begins; it ends when what is returned is dropped.
    pub(crate) fn begin(self) -> anyhow::Result<Stress> {
        let cpus = available_parallelism()?.to_string();
        let cpu = ["--cpu", &cpus];
        let io = ["--io", "1"];
        let vm = ["--vm", "1", "--vm-bytes", VM_BYTES];
        let words = match self {
            Self::Idle => return Ok(Stress(None)),
            Self::Stress => [&cpu[..], &io, &vm].concat(),
            Self::Cpu => cpu.to_vec(),
            Self::Io => io.to_vec(),
            Self::Vm => vm.to_vec(),
        };
        let child = Command::new("stress-ng")
            .args(words)
            .args(["--quiet", "--timeout", "0"])
            .stdin(Stdio::null())
            .spawn()
            .context("stress-ng does not start: apt-get install stress-ng")?;
        thread::sleep(SETTLE);
        Ok(Stress(Some(child)))
    }
}

/// A load that lasts as long as this.
pub(crate) struct Stress(Option<Child>);

impl Drop for Stress {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            // A signal and not a kill, so that it ends its stressors.
            let asked = kill(Pid::from_raw(child.id() as i32), Signal::SIGTERM);
            if asked.is_err() {
                let _ = child.kill();
            }
            let _ = child.wait();
        }
    }
}

//! Time that goes on while no program runs, and that nobody can set.

use std::fs;
use std::time::Duration;

use nix::time::{ClockId, clock_gettime};

/// The kernel's name for the time since it was last started.
const BOOT_ID: &str = "/proc/sys/kernel/random/boot_id";

/// An instant that another process of the same boot can compare with its own.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct BootInstant {
    /// Which boot.
    pub(super) boot: String,
    /// Since then, suspended time included, ns.
    pub(super) ns: u64,
}

impl BootInstant {
    /// Now; none where the kernel does not say.
    pub(super) fn now() -> Option<Self> {
        let boot = fs::read_to_string(BOOT_ID).ok()?;
        Self {
            boot: boot.trim().to_owned(),
            ns: 0,
        }
        .again()
    }

    /// Now, in the same boot: no process outlives one.
    pub(super) fn again(&self) -> Option<Self> {
        let since = Duration::from(clock_gettime(ClockId::CLOCK_BOOTTIME).ok()?);
        Some(Self {
            boot: self.boot.clone(),
            ns: u64::try_from(since.as_nanos()).ok()?,
        })
    }

    /// How long after `earlier` this is; none across a reboot, and for what is
    /// later.
    pub(super) fn since(&self, earlier: &Self) -> Option<Duration> {
        let ns = self.ns.checked_sub(earlier.ns)?;
        (self.boot == earlier.boot).then(|| Duration::from_nanos(ns))
    }
}

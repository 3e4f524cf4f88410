//! Time that continues while no program runs, and that cannot be set.

use std::fs;
use std::time::Duration;

use nix::time::{ClockId, clock_gettime};

/// The kernel's identifier of the present boot.
const BOOT_ID: &str = "/proc/sys/kernel/random/boot_id";

/// An instant that can be compared across processes of the same boot.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct BootInstant {
    /// The identifier of the boot.
    pub(super) boot: String,
    /// The time since the boot, suspended time included, ns.
    pub(super) ns: u64,
}

impl BootInstant {
    /// Now; none if the kernel does not provide it.
    pub(super) fn now() -> Option<Self> {
        let boot = fs::read_to_string(BOOT_ID).ok()?;
        Self {
            boot: boot.trim().to_owned(),
            ns: 0,
        }
        .again()
    }

    /// Now, in the same boot, since a process cannot outlive a boot.
    pub(super) fn again(&self) -> Option<Self> {
        let since = Duration::from(clock_gettime(ClockId::CLOCK_BOOTTIME).ok()?);
        Some(Self {
            boot: self.boot.clone(),
            ns: u64::try_from(since.as_nanos()).ok()?,
        })
    }

    /// The time since `earlier`; none across a reboot, and if `earlier` is
    /// later.
    pub(super) fn since(&self, earlier: &Self) -> Option<Duration> {
        let ns = self.ns.checked_sub(earlier.ns)?;
        (self.boot == earlier.boot).then(|| Duration::from_nanos(ns))
    }
}

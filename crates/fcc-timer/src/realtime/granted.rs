//! What was granted and what was refused.

use nix::errno::Errno;
use std::fmt;

use super::LatencyLimit;

/// What a thread has, as read back from the kernel.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RealtimeGranted {
    /// `SCHED_FIFO`, `SCHED_OTHER` or another of the kernel's policies.
    pub policy: &'static str,
    /// Priority under `SCHED_FIFO`, 1..=99; 0 under `SCHED_OTHER`.
    pub priority: i32,
    /// The CPU, if the thread may run on one only.
    pub cpu: Option<usize>,
    /// Why this CPU, or why none; empty if none was asked for.
    pub cpu_reason: String,
    /// How long CPUs may take to wake, if that was asked for and granted.
    pub cpu_latency: Option<LatencyLimit>,
    /// Whether all memory of the process that is in use is locked.
    pub memory_locked: bool,
    /// Whether the stack asked for is in memory: touching it again faults no
    /// page.
    pub stack_prefaulted: bool,
    /// How late the kernel may make a sleep of the thread, ns.
    pub timer_slack_ns: Option<u64>,
    /// The wishes that were refused.
    pub denied: Vec<DeniedRequest>,
}

/// A wish that was refused.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeniedRequest {
    /// What was asked for: `SCHED_FIFO priority 80`.
    pub request: String,
    /// What the kernel said, or why it was not asked: `EPERM`.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl DeniedRequest {
    /// A denied by the kernel.
    pub(super) fn by_kernel(request: String, errno: Errno, remedy: String) -> Self {
        Self {
            request,
            reason: format!("{errno:?}"),
            remedy,
        }
    }
}

impl fmt::Display for DeniedRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} refused ({}): {}",
            self.request, self.reason, self.remedy
        )
    }
}

/// Something was refused that was asked for strictly.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RealtimeDenied {
    /// What the thread has now; never without a denied.
    pub granted: RealtimeGranted,
}

impl fmt::Display for RealtimeDenied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, denied) in self.granted.denied.iter().enumerate() {
            let separator = if index == 0 { "" } else { "; " };
            write!(f, "{separator}{denied}")?;
        }
        Ok(())
    }
}

impl std::error::Error for RealtimeDenied {}

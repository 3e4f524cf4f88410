//! What was granted and what was denied.

use nix::errno::Errno;
use std::fmt;

use super::LatencyLimit;

/// What a thread has, as read back from the kernel.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RealtimeGranted {
    /// The thread, as the kernel numbers it; 0 if it is not known.
    pub thread: i32,
    /// `SCHED_FIFO`, `SCHED_OTHER` or another of the kernel's policies.
    pub policy: &'static str,
    /// Priority under `SCHED_FIFO`, 1..=99; 0 under `SCHED_OTHER`.
    pub priority: i32,
    /// Nice value, -20..=19; without effect under `SCHED_FIFO`.
    pub nice: i8,
    /// For how long the thread runs at a time beside others under `SCHED_OTHER`, ns,
    /// where the kernel says it (Linux 6.12).
    pub slice_ns: Option<u64>,
    /// The CPU, if the thread may run on one only.
    pub cpu: Option<usize>,
    /// Why this CPU, or why none; empty if none was requested.
    pub cpu_reason: String,
    /// How long CPUs may take to leave an idle state, if that was requested and
    /// granted.
    pub cpu_latency: Option<LatencyLimit>,
    /// Whether all memory of the process that is in use is locked.
    pub memory_locked: bool,
    /// Whether the requested stack is in memory: touching it again causes no page
    /// fault.
    pub stack_prefaulted: bool,
    /// How much the kernel may delay a wake-up of the thread, ns.
    pub timer_slack_ns: Option<u64>,
    /// The requests that were denied.
    pub denied: Vec<DeniedRequest>,
}

/// A request that was denied.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeniedRequest {
    /// The request: `SCHED_FIFO priority 80`.
    pub request: String,
    /// The kernel's error, or another reason: `EPERM`.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl DeniedRequest {
    /// A denial by the kernel.
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
            "{} denied ({}): {}",
            self.request, self.reason, self.remedy
        )
    }
}

/// A request that must be granted was denied.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RealtimeDenied {
    /// The thread's settings now; at least one request was denied.
    pub granted: Box<RealtimeGranted>,
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

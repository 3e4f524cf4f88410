//! What a real-time thread requests of the kernel, and what is granted.
//!
//! [`RealtimeRequest::apply`] is called once, by the loop's own thread, after
//! everything the loop needs has been allocated and before its timer starts.
//! Each request is granted or denied independently; [`RealtimeGranted`] is read
//! back from the kernel, so that a report shows the actual settings.
//!
//! Scheduling, CPU and timer slack are set for the calling thread alone, and
//! threads it creates later return to `SCHED_OTHER` (they do inherit the CPU).
//! Locked memory always concerns the whole process: see
//! [`RealtimeRequest::lock_memory`].

pub mod cpus;
mod granted;
mod latency;
mod memory;
mod nice;
mod scheduling;
mod slack;
mod slice;
mod stack;

use std::path::Path;

use cpus::Cpus;
pub use granted::{DeniedRequest, RealtimeDenied, RealtimeGranted};
pub use latency::LatencyLimit;
pub use scheduling::{take_priority_from, this_thread};

/// What a thread requests.
///
/// ```
/// use fcc_timer::RealtimeRequest;
///
/// let request = RealtimeRequest {
///     priority: Some(80),
///     timer_slack_ns: Some(1),
///     ..RealtimeRequest::default()
/// };
/// let granted = request.apply()?;
/// println!("{} {}", granted.policy, granted.priority);
/// for denied in &granted.denied {
///     eprintln!("{denied}");
/// }
/// # Ok::<(), fcc_timer::RealtimeDenied>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RealtimeRequest {
    /// `SCHED_FIFO` with this priority, 1..=99. The kernel's own interrupt
    /// threads are at 50. Where it is refused, the ordinary scheduler is asked for its
    /// shortest slice, as with `nice`, so that the thread waits for others no longer
    /// than it must; Linux before 6.12 ignores that.
    pub priority: Option<u8>,
    /// The nice value if the thread does not get `SCHED_FIFO`, -20..=19; where
    /// the kernel refuses it, the nearest that it permits.
    pub nice: Option<i8>,
    /// The CPU to run on.
    pub cpu: Option<CpuRequest>,
    /// Whether to keep all pages of the process in memory. Pages mapped now are
    /// loaded and stay, except those of this thread's stack that
    /// `stack_prefault_bytes` does not contain; they, and pages mapped later, stay
    /// once they are first touched, so that they cost memory only where they are
    /// used. This concerns all threads.
    ///
    /// Under a limit (`RLIMIT_MEMLOCK`) that is not "unlimited", locking may
    /// succeed now and make an allocation fail later, in any thread, when the
    /// limit is reached. So the request is denied then, unless the process may
    /// exceed the limit (`CAP_IPC_LOCK`).
    pub lock_memory: bool,
    /// Bytes of the thread's stack, below the frame of `apply`, to have in
    /// memory before they are needed. 0: none.
    pub stack_prefault_bytes: usize,
    /// How much the kernel may delay a wake-up of this thread to combine several,
    /// ns, 1 or more. The kernel's default is 50 µs; threads
    /// under `SCHED_FIFO` have none.
    pub timer_slack_ns: Option<u64>,
    /// How long a CPU may take to leave its idle state, µs, 2 147 483 647 at
    /// most; 0 prevents idle states. In force until the [`RealtimeGranted`] is
    /// dropped.
    pub cpu_dma_latency_us: Option<u32>,
    /// What a denied request means.
    pub strictness: Strictness,
}

/// Which CPU.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CpuRequest {
    /// The best one: an isolated one, or else one that handles few interrupts. If
    /// none is better than the others, the thread is not bound; that is not a
    /// denial.
    Auto,
    /// This one, counted from 0.
    Number(usize),
}

/// What a denied request means.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Strictness {
    /// It is reported in [`RealtimeGranted::denied`].
    #[default]
    Warn,
    /// It is an error.
    Strict,
}

impl RealtimeRequest {
    /// Makes each request and reads back the settings of the calling thread.
    /// Without any request it only reads. Allocates and reads files: not for use
    /// in a tick.
    ///
    /// # Errors
    /// When anything was denied under [`Strictness::Strict`]. What was granted
    /// stays in force.
    pub fn apply(&self) -> Result<RealtimeGranted, RealtimeDenied> {
        let mut denied = Vec::new();
        // The slack before the scheduling: a thread under SCHED_FIFO has none,
        // but has the requested one if it leaves SCHED_FIFO. The scheduling
        // last: locking memory takes long, and other threads may run meanwhile.
        if let Some(slack_ns) = self.timer_slack_ns {
            denied.extend(slack::set(slack_ns).err());
        }
        let mut cpu_reason = String::new();
        match self.cpu {
            Some(CpuRequest::Number(cpu)) => match scheduling::pin_to(cpu) {
                Ok(()) => "it was requested".clone_into(&mut cpu_reason),
                Err(request) => denied.push(request),
            },
            Some(CpuRequest::Auto) => cpu_reason = bind_to_best(),
            None => {}
        }
        let mut cpu_latency = None;
        if let Some(requested_us) = self.cpu_dma_latency_us {
            match latency::limit(requested_us) {
                Ok(limit) => cpu_latency = Some(limit),
                Err(request) => denied.push(request),
            }
        }
        if self.lock_memory {
            // Without a request for the stack all of it is loaded.
            let stack = match self.stack_prefault_bytes {
                0 => 0..0,
                _ => stack::range().unwrap_or_default(),
            };
            denied.extend(memory::lock(&stack).err());
        }
        let mut stack_prefaulted = false;
        if self.stack_prefault_bytes > 0 {
            match stack::prefault(self.stack_prefault_bytes) {
                Ok(()) => stack_prefaulted = true,
                Err(request) => denied.push(request),
            }
        }
        if let Some(priority) = self.priority {
            denied.extend(scheduling::become_fifo(priority).err());
        }
        if let Some(nice) = self.nice
            && scheduling::policy() == "SCHED_OTHER"
        {
            denied.extend(nice::set_nearest(nice).err());
        }
        if (self.priority.is_some() || self.nice.is_some()) && scheduling::policy() == "SCHED_OTHER"
        {
            slice::shorten();
        }

        let granted = RealtimeGranted {
            thread: this_thread(),
            policy: scheduling::policy(),
            priority: scheduling::static_priority(),
            nice: nice::get(),
            slice_ns: slice::get(),
            cpu: scheduling::only_cpu(),
            cpu_reason,
            cpu_latency,
            memory_locked: memory::is_locked(),
            stack_prefaulted,
            timer_slack_ns: slack::get(),
            denied,
        };
        if self.strictness == Strictness::Strict && !granted.denied.is_empty() {
            return Err(RealtimeDenied {
                granted: Box::new(granted),
            });
        }
        Ok(granted)
    }
}

/// Binds the calling thread to the best CPU, if there is one; returns the
/// reason.
fn bind_to_best() -> String {
    let allowed = scheduling::allowed_cpus();
    // Binding to a CPU is how to find out whether it may be used.
    let choice = Cpus::read(Path::new("/")).best(&allowed, |cpu| scheduling::pin_to(cpu).is_ok());
    match choice {
        Ok(choice) => match scheduling::pin_to(choice.cpu) {
            Ok(()) => choice.because,
            Err(denied) => format!("not bound: {denied}"),
        },
        Err(why) => format!("not bound: {why}"),
    }
}

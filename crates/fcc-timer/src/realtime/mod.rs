//! What a real-time thread asks of the kernel, and what it gets.
//!
//! [`RealtimeRequest::apply`] is called once, by the loop's own thread, after
//! everything the loop needs has been allocated and before its timer starts.
//! Every wish is granted or refused by itself; the [`RealtimeGranted`] are read
//! back from the kernel, so that a report shows what is and not what was asked.
//!
//! Scheduling, CPU and timer slack are set for the calling thread alone, and
//! threads it makes later go back to `SCHED_OTHER` (they do inherit the CPU).
//! Locked memory is the process' affair and there is no other way: see
//! [`RealtimeRequest::lock_memory`].

pub mod cpus;
mod granted;
mod latency;
mod memory;
mod scheduling;
mod slack;
mod stack;

use std::path::Path;

use cpus::Cpus;
pub use granted::{DeniedRequest, RealtimeDenied, RealtimeGranted};
pub use latency::LatencyLimit;
pub use scheduling::{take_priority_from, this_thread};

/// What a thread would like to have.
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
    /// threads are at 50.
    pub priority: Option<u8>,
    /// To run on one CPU only.
    pub cpu: Option<CpuRequest>,
    /// To have no page of the process swapped out or dropped. What is mapped
    /// now is fetched and stays; what is mapped later stays from when it is
    /// first touched, so that a thread's stack or a large file mapped by
    /// others costs memory only where it is used. This concerns all threads.
    ///
    /// Under a limit (`RLIMIT_MEMLOCK`) that is not "unlimited", locking may
    /// succeed now and make an allocation fail later, in any thread, when the
    /// limit is reached. So this wish is refused then, unless the process may
    /// exceed it (`CAP_IPC_LOCK`): all or nothing.
    pub lock_memory: bool,
    /// Bytes of the thread's stack, below the frame of `apply`, to have in
    /// memory before they are needed. 0: none.
    pub stack_prefault_bytes: usize,
    /// How late the kernel may make a sleep of this thread so as to wake
    /// several at once, ns, 1 or more. The kernel's default is 50 µs; threads
    /// under `SCHED_FIFO` have none.
    pub timer_slack_ns: Option<u64>,
    /// How long a CPU may take to wake from its sleep, µs, 2 147 483 647 at
    /// most; 0 keeps all CPUs from sleeping. In force as long as the granted.
    pub cpu_dma_latency_us: Option<u32>,
    /// What a denied means.
    pub strictness: Strictness,
}

/// Which CPU.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CpuRequest {
    /// The best there is: an isolated one, or else one that stays off the
    /// interrupts. Where none is better than the others, the thread is not
    /// bound; that is no denied.
    Auto,
    /// This one, counted from 0.
    Number(usize),
}

/// What a refused wish means.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Strictness {
    /// It is reported among the granted.
    #[default]
    Warn,
    /// It is an error.
    Strict,
}

impl RealtimeRequest {
    /// Asks for each wish and reads back what the calling thread has now.
    /// Without any wish it only reads. Allocates and reads files: not for use
    /// in a tick.
    ///
    /// # Errors
    /// When anything was refused under [`Strictness::Strict`]. What was
    /// granted stays granted.
    pub fn apply(&self) -> Result<RealtimeGranted, RealtimeDenied> {
        let mut denied = Vec::new();
        // The slack before the scheduling: a thread under SCHED_FIFO has none,
        // but shall have the one asked for should it ever leave it. The
        // scheduling last: fetching memory takes long, and others may run.
        if let Some(slack_ns) = self.timer_slack_ns {
            denied.extend(slack::set(slack_ns).err());
        }
        let mut cpu_reason = String::new();
        match self.cpu {
            Some(CpuRequest::Number(cpu)) => match scheduling::pin_to(cpu) {
                Ok(()) => "it was asked for".clone_into(&mut cpu_reason),
                Err(request) => denied.push(request),
            },
            Some(CpuRequest::Auto) => cpu_reason = bind_to_best(),
            None => {}
        }
        let mut cpu_latency = None;
        if let Some(wished_us) = self.cpu_dma_latency_us {
            match latency::limit(wished_us) {
                Ok(limit) => cpu_latency = Some(limit),
                Err(request) => denied.push(request),
            }
        }
        if self.lock_memory {
            denied.extend(memory::lock().err());
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

        let granted = RealtimeGranted {
            policy: scheduling::policy(),
            priority: scheduling::static_priority(),
            cpu: scheduling::only_cpu(),
            cpu_reason,
            cpu_latency,
            memory_locked: memory::is_locked(),
            stack_prefaulted,
            timer_slack_ns: slack::get(),
            denied,
        };
        if self.strictness == Strictness::Strict && !granted.denied.is_empty() {
            return Err(RealtimeDenied { granted });
        }
        Ok(granted)
    }
}

/// Binds the calling thread to the best CPU, if there is one; says why.
fn bind_to_best() -> String {
    let allowed = scheduling::allowed_cpus();
    // To ask whether a CPU may be used is to be moved there.
    let choice = Cpus::read(Path::new("/")).best(&allowed, |cpu| scheduling::pin_to(cpu).is_ok());
    match choice {
        Ok(choice) => match scheduling::pin_to(choice.cpu) {
            Ok(()) => choice.because,
            Err(denied) => format!("not bound: {denied}"),
        },
        Err(why) => format!("not bound: {why}"),
    }
}

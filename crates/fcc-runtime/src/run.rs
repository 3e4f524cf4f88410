//! Runs the loop in this thread or in one of its own.

use std::sync::mpsc::{self, SyncSender};
use std::thread::{self, JoinHandle};
use std::{io, panic};

use fcc_core::framework::{Controller, State};
use fcc_timer::{
    DeniedRequest, RealtimeDenied, RealtimeGranted, RealtimeRequest, TimerError, not_started,
};

use crate::config::{LoopConfig, Parts};
use crate::link::{Link, StopHandle};
use crate::machine::Machine;
use crate::panics;
use crate::report::LoopReport;

/// The name of a loop's own thread, as `top -H` and panic messages show it.
pub const THREAD_NAME: &str = "fcc-loop";
/// Given explicitly, so that `RUST_MIN_STACK` does not change it. With locked memory all
/// of it is resident; without optimization every function takes more.
const STACK_BYTES: usize = if cfg!(debug_assertions) {
    2 << 20
} else {
    1 << 20
};

/// A loop that has not started.
///
/// Once one runs, a panic in a tick is not printed by the process' panic hook,
/// which may wait for a terminal or a pipe before the actuators are released;
/// its message and its location are in the [`LoopReport`]. Other panics are
/// printed as before.
pub struct Loop<C: Controller> {
    machine: Machine<C>,
    realtime: RealtimeRequest,
    early_wake_needs_priority: bool,
    stop: StopHandle,
}

impl<C: Controller> Loop<C> {
    /// Puts the parts together.
    ///
    /// # Errors
    /// When the timer's period cannot be kept statistics of.
    pub fn new(parts: Parts<C>, config: &LoopConfig) -> Result<(Self, Link<C>), TimerError> {
        let (machine, link) = Machine::new(parts, config)?;
        let this = Self {
            machine,
            realtime: config.realtime.clone(),
            early_wake_needs_priority: config.early_wake_needs_priority,
            stop: link.stop.clone(),
        };
        Ok((this, link))
    }

    /// Runs in a thread of its own. Returns when the kernel has granted or denied
    /// each real-time request and the timer has started.
    ///
    /// # Errors
    /// When no thread can be created, when a request that must be granted was
    /// denied, or when the timer does not start. Nothing runs then.
    pub fn spawn(self) -> Result<LoopHandle, SpawnError>
    where
        C: 'static,
    {
        panics::keep_quiet();
        let (started, start) = mpsc::sync_channel(1);
        let stop = self.stop.clone();
        let thread = thread::Builder::new()
            .name(THREAD_NAME.to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || self.run_there(&started))
            .map_err(|error| SpawnError::Thread(not_started(error)))?;
        match start.recv() {
            Ok(Ok(granted)) => Ok(LoopHandle {
                granted,
                stop,
                thread: Some(thread),
            }),
            Ok(Err(refused)) => Err(refused),
            Err(mpsc::RecvError) => Err(SpawnError::Thread(io::Error::other(
                "the loop's thread ended before it started the timer",
            ))),
        }
    }

    fn run_there(mut self, started: &SyncSender<Started>) -> LoopReport {
        let ready = self
            .realtime
            .apply()
            .map_err(SpawnError::Realtime)
            .and_then(|mut granted| {
                self.decide_early_wake(&mut granted);
                self.machine.start().map_err(SpawnError::Timer)?;
                Ok(granted)
            });
        let granted = ready.as_ref().ok().cloned();
        // The receiver waits in `spawn`.
        let _ = started.send(ready);
        if granted.is_none() {
            return self.machine.finish();
        }
        run(&mut self.machine);
        LoopReport {
            granted,
            ..self.machine.finish()
        }
    }
}

impl<C: Controller> Loop<C> {
    /// Disables early wake if the thread has no real-time priority and that is
    /// required; reported as denied if the priority was requested.
    fn decide_early_wake(&mut self, granted: &mut RealtimeGranted) {
        if !self.early_wake_needs_priority || granted.priority > 0 {
            return;
        }
        self.machine.timer.disable_early_wake();
        if self.realtime.priority.is_some() {
            granted.denied.push(DeniedRequest {
                request: "early wake".to_owned(),
                reason: "the loop's thread has no real-time priority".to_owned(),
                remedy: "see SCHED_FIFO above; without it the kernel's lateness of 30 to 100 µs \
                         remains"
                    .to_owned(),
            });
        }
    }
}

type Started = Result<RealtimeGranted, SpawnError>;

/// Where it is: a copy on the stack, which may be larger than the part of it that was touched,
/// would not be in memory at the first tick.
fn run<C: Controller>(machine: &mut Machine<C>) {
    machine.count_page_faults();
    while machine.state() != State::Stopped {
        machine.step();
    }
}

/// A loop that runs in a thread of its own. Dropping it stops the loop and waits
/// for it, one period at most, so that none keeps control without a handle.
#[derive(Debug)]
pub struct LoopHandle {
    granted: RealtimeGranted,
    stop: StopHandle,
    thread: Option<JoinHandle<LoopReport>>,
}

impl LoopHandle {
    /// What the kernel granted the loop's thread.
    pub const fn granted(&self) -> &RealtimeGranted {
        &self.granted
    }

    /// Whether the loop has ended.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Requests the loop to end at its next tick.
    pub fn stop(&self) {
        self.stop.stop();
    }

    /// Detaches the loop's thread: for one that hangs, for which waiting would
    /// not end.
    pub fn abandon(mut self) {
        drop(self.thread.take());
    }

    /// Waits until the loop has ended; does not stop it.
    ///
    /// # Panics
    /// With a panic of this crate's own; one of a part is in the report.
    #[expect(
        clippy::expect_used,
        reason = "the thread is taken here or in drop, and each ends the handle"
    )]
    pub fn join(mut self) -> LoopReport {
        let thread = self.thread.take().expect("a handle joins once");
        match thread.join() {
            Ok(report) => report,
            // Panics of parts are caught; this one is a defect of this crate.
            Err(payload) => panic::resume_unwind(payload),
        }
    }
}

impl Drop for LoopHandle {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            self.stop.stop();
            // Its report is lost with the handle.
            let _ = thread.join();
        }
    }
}

/// Why a loop could not start in its own thread.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum SpawnError {
    /// No thread could be created.
    #[error("no thread for the loop: {0}")]
    Thread(#[source] io::Error),
    /// A real-time request that must be granted was denied.
    #[error(transparent)]
    Realtime(RealtimeDenied),
    /// The timer did not start.
    #[error("the loop's timer did not start: {0}")]
    Timer(#[source] TimerError),
}

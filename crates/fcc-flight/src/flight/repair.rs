//! Repairs the recording that a killed program left, while the flight goes on.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_record::{RecoverError, Recovered, recover_while};

use super::observer::Reports;

/// A repair, in its own thread.
pub(super) struct Repair {
    thread: JoinHandle<Result<Recovered, RecoverError>>,
    is_stopped: Arc<AtomicBool>,
    path: PathBuf,
}

/// How long the end waits for it.
const PATIENCE: Duration = Duration::from_secs(5);
const POLL: Duration = Duration::from_millis(5);

impl Repair {
    /// Begins it. Without a thread, the file is left to `fccd recover`.
    pub(super) fn begin(path: PathBuf) -> Option<Self> {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&is_stopped);
        let repaired = path.clone();
        let thread = thread::Builder::new()
            .name("fcc-repair".to_owned())
            // With locked memory, all of a stack is resident.
            .stack_size(512 << 10)
            .spawn(move || recover_while(&repaired, |_| !stop.load(Ordering::Relaxed)))
            .ok()?;
        Some(Self {
            thread,
            is_stopped,
            path,
        })
    }

    pub(super) fn is_over(&self) -> bool {
        self.thread.is_finished()
    }

    /// Ends it if it is not over, and reports the result.
    pub(super) fn end(self, reports: &mut Reports) {
        self.is_stopped.store(true, Ordering::Relaxed);
        let began = Instant::now();
        while !self.thread.is_finished() {
            // A damaged file of terabytes, or a disk that hangs, must not keep the daemon.
            if began.elapsed() > PATIENCE {
                let path = self.path.display();
                reports.remark(format!(
                    "{path}: its repair has not ended within {} s and is left: fccd recover \
                     repairs it",
                    PATIENCE.as_secs()
                ));
                return;
            }
            thread::sleep(POLL);
        }
        match self.thread.join() {
            Ok(Ok(done)) if done.was_whole => {}
            Ok(Ok(done)) => reports.mention(format!(
                "{}: was unfinished, repaired: {} ticks",
                done.path.display(),
                done.ticks
            )),
            Ok(Err(error)) => {
                reports.remark(format!("the last recording was not repaired: {error}"));
            }
            Err(_) => {
                reports.remark("the last recording was not repaired: it panicked");
            }
        }
    }
}

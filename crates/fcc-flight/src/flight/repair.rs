//! Repairs the recording that a killed program left, while the flight goes on.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_record::{RecoverError, Recovered, last_unfinished, recover_while};

use super::observer::Reports;

/// A repair, in its own thread.
pub(super) struct Repair {
    thread: JoinHandle<Option<Result<Recovered, RecoverError>>>,
    is_stopped: Arc<AtomicBool>,
    folder: PathBuf,
}

/// How long the end waits for it.
const PATIENCE: Duration = Duration::from_secs(5);
const POLL: Duration = Duration::from_millis(5);

impl Repair {
    /// Looks for the recording that the flight before this one left, and repairs it.
    /// Without a thread, it is left to `fccd recover`.
    pub(super) fn begin(folder: &Path, started_unix_ns: u64, clock_offset_ns: i64) -> Option<Self> {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&is_stopped);
        let folder = folder.to_owned();
        let looked_in = folder.clone();
        let thread = thread::Builder::new()
            .name("fcc-repair".to_owned())
            // With locked memory, all of a stack is resident.
            .stack_size(512 << 10)
            .spawn(move || {
                let path = last_unfinished(&looked_in, started_unix_ns, clock_offset_ns)?;
                Some(recover_while(&path, |_| !stop.load(Ordering::Relaxed)))
            })
            .ok()?;
        Some(Self {
            thread,
            is_stopped,
            folder,
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
                let folder = self.folder.display();
                reports.remark(format!(
                    "{folder}: the repair of its last recording has not ended within {} s and is \
                     left: fccd recover repairs it",
                    PATIENCE.as_secs()
                ));
                return;
            }
            thread::sleep(POLL);
        }
        match self.thread.join() {
            Ok(None) => {}
            Ok(Some(Ok(done))) if done.was_whole => {}
            Ok(Some(Ok(done))) => reports.mention(format!(
                "{}: was unfinished, repaired: {} ticks",
                done.path.display(),
                done.ticks
            )),
            Ok(Some(Err(error))) => {
                reports.remark(format!("the last recording was not repaired: {error}"));
            }
            Err(_) => {
                reports.remark("the last recording was not repaired: it panicked");
            }
        }
    }
}

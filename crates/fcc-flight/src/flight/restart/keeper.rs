//! Writes the state file in a thread that may wait for the disk.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{io, thread};

use super::saved::Saved;
use super::state_file;

/// How long the end of a flight waits for the disk.
const PATIENCE: Duration = Duration::from_secs(2);

/// Writes the state file. Of several requests while the disk is busy, only the
/// last is executed.
pub(super) struct Keeper {
    desk: Arc<Requests>,
    trouble: Receiver<String>,
}

#[derive(Default)]
struct Requests {
    slot: Mutex<Slot>,
    filled: Condvar,
}

#[derive(Default)]
struct Slot {
    requested: Option<DiskRequest>,
    is_over: bool,
}

enum DiskRequest {
    Keep(Box<Saved>),
    Clear,
}

impl Keeper {
    /// Starts the thread.
    ///
    /// # Errors
    /// When no thread can be created.
    pub(super) fn start(path: PathBuf) -> io::Result<Self> {
        let desk = Arc::<Requests>::default();
        let theirs = Arc::clone(&desk);
        // A lasting problem is reported once; the channel has no room for more.
        let (say, trouble) = mpsc::sync_channel(1);
        thread::Builder::new()
            .name("fcc-state".to_owned())
            .spawn(move || {
                let mut failing = false;
                while let Some(requested) = theirs.next() {
                    let done = match requested {
                        DiskRequest::Keep(saved) => state_file::write(&path, &saved),
                        DiskRequest::Clear => state_file::remove(&path),
                    };
                    if let Err(error) = &done
                        && !failing
                    {
                        let words = format!(
                            "{}: cannot be written, so a restart would not know of this flight: \
                             {error}",
                            path.display()
                        );
                        let _ = say.try_send(words);
                    }
                    failing = done.is_err();
                }
            })?;
        Ok(Self { desk, trouble })
    }

    /// Stores this state, replacing the previous one.
    pub(super) fn keep(&self, saved: Saved) {
        self.desk.request(DiskRequest::Keep(Box::new(saved)));
    }

    /// Removes the stored state.
    pub(super) fn clear(&self) {
        self.desk.request(DiskRequest::Clear);
    }

    /// A description of a new problem; none if there is none.
    pub(super) fn trouble(&self) -> Option<String> {
        self.trouble.try_recv().ok()
    }

    /// Waits, for a limited time, until everything is on the disk.
    pub(super) fn end(self) {
        self.desk.slot().is_over = true;
        self.desk.filled.notify_one();
        // The thread's end of the channel is dropped with the thread.
        while !matches!(
            self.trouble.recv_timeout(PATIENCE),
            Err(RecvTimeoutError::Disconnected | RecvTimeoutError::Timeout)
        ) {}
    }
}

impl Requests {
    fn slot(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn request(&self, requested: DiskRequest) {
        self.slot().requested = Some(requested);
        self.filled.notify_one();
    }

    /// Waits for the next request; none at the end.
    fn next(&self) -> Option<DiskRequest> {
        let mut slot = self.slot();
        loop {
            if let Some(requested) = slot.requested.take() {
                return Some(requested);
            }
            if slot.is_over {
                return None;
            }
            slot = self
                .filled
                .wait(slot)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

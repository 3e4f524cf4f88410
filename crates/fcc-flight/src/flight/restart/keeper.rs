//! Writes the state file in a thread that may wait for the disk.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, TryRecvError};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{io, thread};

use super::saved::Saved;
use super::{kept_plan, state_file};
use crate::config::PreparedPlan;

/// How long the end of a flight waits for the disk.
const PATIENCE: Duration = Duration::from_secs(2);
/// Given explicitly, so that `RUST_MIN_STACK` does not change it.
pub(super) const STACK_BYTES: usize = 2 << 20;

/// Writes the state file. Of several requests while the disk is busy, only the
/// last is executed.
pub(super) struct Keeper {
    path: PathBuf,
    desk: Arc<Requests>,
    trouble: Receiver<String>,
    is_over: bool,
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
    /// A state, and the plan that it needs beside it.
    Keep(Box<Saved>, Option<Arc<PreparedPlan>>),
    Clear,
}

impl DiskRequest {
    /// `plan` is the hash of the plan that is beside the state.
    fn execute(&self, path: &Path, plan: &mut Option<u64>) -> io::Result<()> {
        match self {
            Self::Keep(saved, kept) => {
                let hash = kept.as_ref().map(|kept| kept.replacement.plan_hash);
                if let Some(kept) = kept.as_ref().filter(|_| hash != *plan) {
                    kept_plan::write(path, &kept.content)?;
                    *plan = hash;
                }
                state_file::write(path, saved)
            }
            Self::Clear => {
                *plan = None;
                state_file::remove(path).and(kept_plan::remove(path))
            }
        }
    }
}

impl Keeper {
    /// Starts the thread.
    ///
    /// # Errors
    /// When no thread can be created.
    pub(super) fn start(path: PathBuf) -> io::Result<Self> {
        let desk = Arc::<Requests>::default();
        let trouble = start_thread(path.clone(), Arc::clone(&desk))?;
        Ok(Self {
            path,
            desk,
            trouble,
            is_over: false,
        })
    }

    /// Stores this state, replacing the previous one, with the plan that replaced the
    /// configuration's.
    pub(super) fn keep(&self, saved: Saved, plan: Option<Arc<PreparedPlan>>) {
        self.desk.request(DiskRequest::Keep(Box::new(saved), plan));
    }

    /// Removes the stored state.
    pub(super) fn clear(&self) {
        self.desk.request(DiskRequest::Clear);
    }

    /// A description of a new problem; none if there is none.
    pub(super) fn trouble(&mut self) -> Option<String> {
        match self.trouble.try_recv() {
            Ok(words) => Some(words),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) if std::mem::replace(&mut self.is_over, true) => None,
            Err(TryRecvError::Disconnected) => Some(format!(
                "{}: its thread has ended, so a restart would not know of this flight",
                self.path.display()
            )),
        }
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

fn start_thread(path: PathBuf, desk: Arc<Requests>) -> io::Result<Receiver<String>> {
    // A lasting problem is reported once; the channel has no room for more.
    let (say, trouble) = mpsc::sync_channel(1);
    thread::Builder::new()
        .name("fcc-state".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            let (mut failing, mut plan) = (false, None);
            while let Some(requested) = desk.next() {
                let done = requested.execute(&path, &mut plan);
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
    Ok(trouble)
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

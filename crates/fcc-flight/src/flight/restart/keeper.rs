//! Keeps the state file as it is wanted, in a thread that may wait for the
//! disk.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{io, thread};

use super::state_file::{self, Saved};

/// How long the end of a flight waits for the disk.
const PATIENCE: Duration = Duration::from_secs(2);

/// Keeps the state file. Of what is asked while the disk is busy, only the last
/// counts.
pub(super) struct Keeper {
    desk: Arc<CommandServer>,
    trouble: Receiver<String>,
}

#[derive(Default)]
struct CommandServer {
    slot: Mutex<Slot>,
    filled: Condvar,
}

#[derive(Default)]
struct Slot {
    asked: Option<Asked>,
    is_over: bool,
}

enum Asked {
    Keep(Saved),
    Clear,
}

impl Keeper {
    /// Starts the thread.
    ///
    /// # Errors
    /// When there is none to be had.
    pub(super) fn start(path: PathBuf) -> io::Result<Self> {
        let desk = Arc::<CommandServer>::default();
        let theirs = Arc::clone(&desk);
        // Trouble that lasts is said once; more of it finds no room.
        let (say, trouble) = mpsc::sync_channel(1);
        thread::Builder::new()
            .name("fcc-state".to_owned())
            .spawn(move || {
                let mut failing = false;
                while let Some(asked) = theirs.next() {
                    let done = match asked {
                        Asked::Keep(saved) => state_file::write(&path, &saved),
                        Asked::Clear => state_file::remove(&path),
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

    /// Keeps this, instead of what was kept before.
    pub(super) fn keep(&self, saved: Saved) {
        self.desk.ask(Asked::Keep(saved));
    }

    /// Keeps nothing.
    pub(super) fn clear(&self) {
        self.desk.ask(Asked::Clear);
    }

    /// What went wrong, in words; none if nothing new did.
    pub(super) fn trouble(&self) -> Option<String> {
        self.trouble.try_recv().ok()
    }

    /// Waits, for a while, until all is on the disk.
    pub(super) fn end(self) {
        self.desk.slot().is_over = true;
        self.desk.filled.notify_one();
        // The thread's end of the channel goes with the thread.
        while !matches!(
            self.trouble.recv_timeout(PATIENCE),
            Err(RecvTimeoutError::Disconnected | RecvTimeoutError::Timeout)
        ) {}
    }
}

impl CommandServer {
    fn slot(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn ask(&self, asked: Asked) {
        self.slot().asked = Some(asked);
        self.filled.notify_one();
    }

    /// Waits for what is asked next; none at the end.
    fn next(&self) -> Option<Asked> {
        let mut slot = self.slot();
        loop {
            if let Some(asked) = slot.asked.take() {
                return Some(asked);
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

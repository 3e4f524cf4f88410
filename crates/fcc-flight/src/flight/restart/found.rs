//! What the last flight left, looked for in a thread: a disk may hang, and the
//! flight goes on meanwhile.

use std::fs::{self, File};
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use super::boot_clock::BootInstant;
use super::keeper::STACK_BYTES;
use super::kept_plan;
use super::recovery::Recovery;
use super::saved::Saved;
use super::state_file::{self, StateFileError};
use super::{MAX_RECOVERIES, RestartRequest};
use crate::config::RestartMode;

/// How long the beginning waits for the disk: one that works answers at once.
const AT_ONCE: Duration = Duration::from_millis(500);
/// A disk that has not answered for this long is reported.
const LATE_AFTER: Duration = Duration::from_secs(2);

/// What the last flight left, and the lock of the file.
pub(super) struct Found {
    /// None if another user prevents it.
    pub(super) lock: Option<File>,
    pub(super) recovery: Option<Recovery>,
    /// A flight of this plant is not recovered: what it held is to be released.
    pub(super) left: bool,
    pub(super) message: Option<String>,
}

/// What was found, or why the file cannot be used.
pub(super) type Looked = Result<Found, String>;

/// The thread that looks.
#[derive(Debug)]
pub(super) struct Search {
    found: Receiver<Looked>,
    began: Instant,
    is_late: bool,
}

impl Search {
    /// Begins to look; what a disk gives that works, or the search that goes on.
    ///
    /// # Errors
    /// When no thread can be created.
    pub(super) fn begin(
        look: impl FnOnce() -> Looked + Send + 'static,
    ) -> io::Result<Result<Looked, Self>> {
        let (tell, found) = sync_channel(1);
        thread::Builder::new()
            .name("fcc-restart".to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || {
                let _ = tell.send(look());
            })?;
        Ok(match found.recv_timeout(AT_ONCE) {
            Ok(looked) => Ok(looked),
            Err(RecvTimeoutError::Disconnected) => Ok(Err(ENDED.to_owned())),
            Err(RecvTimeoutError::Timeout) => Err(Self {
                found,
                began: Instant::now(),
                is_late: false,
            }),
        })
    }

    /// What was found; none yet.
    pub(super) fn poll(&self) -> Option<Looked> {
        match self.found.try_recv() {
            Ok(looked) => Some(looked),
            Err(TryRecvError::Disconnected) => Some(Err(ENDED.to_owned())),
            Err(TryRecvError::Empty) => None,
        }
    }

    /// Once, that the disk is late.
    pub(super) fn late(&mut self, path: &Path) -> Option<String> {
        if self.is_late || self.began.elapsed() + AT_ONCE < LATE_AFTER {
            return None;
        }
        self.is_late = true;
        Some(format!(
            "{}: its disk has not answered for {} s: an interrupted flight is continued only when \
             it does; fly by hand until then, look at the disk (`dmesg`), and choose a \
             restart.state_file on another one",
            path.display(),
            LATE_AFTER.as_secs()
        ))
    }
}

const ENDED: &str =
    "the thread that looks for an interrupted flight has ended, so none is recovered";

/// Evaluates the state left by the last flight.
///
/// # Errors
/// Why the file cannot be used.
pub(super) fn look(request: &RestartRequest) -> Looked {
    let (lock, foreign) = prepare(&request.path)?;
    let read = state_file::read(&request.path);
    if let Err(error @ (StateFileError::Foreign | StateFileError::Unreadable(_))) = &read {
        return Err(format!("{}: {error}", request.path.display()));
    }
    let of_this_plant = matches!(&read, Ok(Some(saved)) if saved.config == request.fingerprint);
    let (recovery, message) = evaluate(request, read, BootInstant::now().as_ref());
    let message = match (foreign, message) {
        (Some(foreign), Some(message)) => Some(format!("{foreign}; {message}")),
        (foreign, message) => foreign.or(message),
    };
    Ok(Found {
        lock,
        left: of_this_plant && recovery.is_none(),
        recovery,
        message,
    })
}

/// Creates the folder, and ensures that no other daemon uses the same file. A message beside
/// the lock if another user prevents it: that one may, without any daemon.
fn prepare(path: &Path) -> Result<(Option<File>, Option<String>), String> {
    let message = |doing: &str, error: &dyn std::fmt::Display| {
        format!(
            "{}: {doing}, so this flight cannot be recovered after a restart: {error}",
            path.display()
        )
    };
    if let Some(folder) = path.parent()
        && !folder.as_os_str().is_empty()
    {
        fcc_record::create_folder(folder)
            .map_err(|error| message("its folder cannot be created", &error))?;
    }
    let lock_path = path.with_extension("flight.lock");
    let opened = fcc_record::open_lock(&lock_path);
    let refused = match opened.and_then(|lock| {
        let is_free = fcc_telemetry::file_lock::try_lock(&lock)?;
        Ok((lock, is_free))
    }) {
        Ok((lock, true)) => return Ok((Some(lock), None)),
        Ok((_, false)) => message(
            "another fccd uses it",
            &"give this one another restart.state_file",
        ),
        Err(error) => message("cannot be locked", &error),
    };
    let user = other_user(&lock_path).ok_or(refused)?;
    let foreign = format!(
        "{}: belongs to the user {user}, and cannot be locked here: it is ignored; use a \
         restart.state_file in a folder of this user",
        lock_path.display()
    );
    Ok((None, Some(foreign)))
}

/// The user of a file, or of a link, if that is neither this process' nor root.
fn other_user(path: &Path) -> Option<u32> {
    let user = fs::symlink_metadata(path).ok()?.uid();
    (user != 0 && user != nix::unistd::geteuid().as_raw()).then_some(user)
}

/// What to do with the state that was found, and the message about it.
fn evaluate(
    request: &RestartRequest,
    read: Result<Option<Saved>, StateFileError>,
    now: Option<&BootInstant>,
) -> (Option<Recovery>, Option<String>) {
    let stands_by = |why: &str| {
        let message = format!("{}: {why}; staying in standby", request.path.display());
        (None, Some(message))
    };
    let saved = match read {
        Ok(Some(saved)) => saved,
        Ok(None) => return (None, None),
        Err(error) => return stands_by(&error.to_string()),
    };
    let Some(age) = now.and_then(|now| now.since(&saved.at)) else {
        return stands_by("a flight was interrupted before this machine was last started");
    };
    let interrupted = format!("a flight was interrupted {:.1} s ago", age.as_secs_f64());
    if request.mode == RestartMode::Cold {
        return stands_by(&format!("{interrupted}, and restart.mode is \"cold\""));
    }
    if age > request.max_age {
        return stands_by(&format!(
            "{interrupted}, longer than restart.max_age_s, {} s",
            request.max_age.as_secs_f64()
        ));
    }
    if saved.config != request.fingerprint {
        return stands_by(&format!(
            "{interrupted}, and flown with another configuration"
        ));
    }
    if saved.recoveries >= MAX_RECOVERIES {
        return stands_by(&format!(
            "{interrupted}, and recovered {} times in a row before",
            saved.recoveries
        ));
    }
    let plan = match kept_plan::restore(&request.path, saved.plan, &request.config) {
        Ok(plan) => plan.map(Arc::new),
        Err(why) => return stands_by(&format!("{interrupted}, and {why}")),
    };
    let message = format!("{}: {interrupted}; recovering it", request.path.display());
    (Some(Recovery::new(saved, plan)), Some(message))
}

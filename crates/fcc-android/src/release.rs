//! Releasing the controls when the app is killed.
//!
//! A second process of the app, Android's own (`android:process`), waits at the end of
//! a pipe, as `fccd release-helper` does, and releases what was held when the pipe
//! closes. If that one is killed, too, a file in the folder of recordings, the mark,
//! says what was held, and the next start of the app releases it. Pipe and mark have
//! the same lines: the configuration, and those of [`fcc_flight::release`].

mod earlier;
mod helper;
mod mark;

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::{ControlAuthority, PlantId, Released, TakeoverNotice};
use fcc_flight::config::Config;
use fcc_flight::release::{HelperPipes, Line, in_one_line};

pub(crate) use earlier::{begin_flight, release_left};
pub(crate) use helper::serve;
use mark::Mark;

/// The second process has so long to begin, before the user is told that it is missing.
const HELPER_WITHIN: Duration = Duration::from_secs(10);

/// What the loop's threads of this process pass on: a loop that hangs outlives its
/// flight.
static NOTICE: Notice = Notice {
    taken: AtomicU64::new(0),
    released: AtomicU64::new(0),
    helpers: HelperPipes::new(),
};

/// A pipe to a second process that has begun, until a flight takes it.
static ARRIVED: Mutex<Option<OwnedFd>> = Mutex::new(None);

/// The pipe to a second process: from now on it is told.
pub(crate) fn add_helper(pipe: OwnedFd) {
    *ARRIVED.lock().unwrap_or_else(PoisonError::into_inner) = Some(pipe);
}

/// Whether a flight of this process can hold a plant: the second process and the mark
/// know of one.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// The turn of the one flight that can hold a plant, until it is over.
#[derive(Debug)]
struct Turn;

impl Turn {
    /// # Errors
    /// When another flight has it.
    fn take() -> io::Result<Self> {
        if IS_TAKEN.swap(true, Ordering::SeqCst) {
            return Err(io::Error::other(
                "another flight of this app goes on, and if the app is killed only one of them is \
                 released: stop it first",
            ));
        }
        Ok(Self)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        IS_TAKEN.store(false, Ordering::SeqCst);
    }
}

#[derive(Debug)]
struct Notice {
    /// The number of the last takeover, and of the last whose release is confirmed.
    taken: AtomicU64,
    released: AtomicU64,
    helpers: HelperPipes,
}

impl TakeoverNotice for Notice {
    fn taking(&self, plant: &PlantId) {
        let number = self.taken.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        self.helpers.send(&Line::Held(number, *plant));
    }
}

/// What of a flight outlives its process.
pub(crate) struct Outliving {
    authority: Arc<dyn ControlAuthority>,
    /// In one line.
    config: String,
    mark: Mark,
    /// What an earlier process has left held, until it is being released.
    left: bool,
    /// Until when a second process may take to begin; none once there is one, or it was
    /// said that there is none.
    due: Option<Instant>,
    answers: Option<(PlantId, u16)>,
    was_held: bool,
    _turn: Turn,
}

impl Outliving {
    /// Of a flight that is about to begin; the mark is in `folder`.
    ///
    /// # Errors
    /// When the configuration cannot be passed on, or another flight goes on.
    pub(crate) fn new(
        authority: &Arc<dyn ControlAuthority>,
        config: &Config,
        folder: &Path,
    ) -> io::Result<Self> {
        let turn = Turn::take()?;
        authority.notify(&NOTICE);
        let mark = Mark::in_folder(folder);
        let mut this = Self {
            authority: Arc::clone(authority),
            config: in_one_line(config)?,
            left: mark.is_there() && config.restart.release_left_held,
            mark,
            due: Some(Instant::now() + HELPER_WITHIN),
            answers: None,
            was_held: false,
            _turn: turn,
        };
        if let Some(pipe) = NOTICE.helpers.last() {
            let mut pipe = File::from(pipe.try_clone_to_owned()?);
            if write_config(&mut pipe, &this.config).is_ok() {
                this.due = None;
            }
        }
        this.take_arrived(None);
        Ok(this)
    }

    /// Follows what is held; 50 times a second.
    pub(crate) fn poll(&mut self, report: &mut dyn FnMut(String)) {
        // In this order: a takeover in between is then not counted as released.
        let number = NOTICE.taken.load(Ordering::SeqCst);
        let held = self.authority.held();
        match held {
            // What an earlier process left is being released.
            Some(plant) if NOTICE.released.load(Ordering::SeqCst) == number => {
                NOTICE.taking(&plant);
            }
            Some(_) => {}
            None => self.released(number),
        }
        self.take_arrived(held);
        if let Some(plant) = held.filter(|_| !self.was_held) {
            self.authority.prepare_release(&plant);
            if let Err(error) = self.mark.set(&self.config, &plant) {
                report(format!(
                    "that {plant} is held cannot be stored ({error}): if the app's processes are \
                     all ended, release the controls by hand"
                ));
            }
        }
        self.was_held = held.is_some();
        if self.left && self.authority.plant().is_some() {
            self.left = false;
            self.authority.release_left();
            report(
                "an earlier flight was cut off and may have left the controls held; they are \
                 released"
                    .to_owned(),
            );
        }
        let found = held
            .or_else(|| self.authority.plant())
            .zip(self.authority.answers_from());
        if let Some((plant, from)) = found.filter(|_| found != self.answers) {
            self.answers = found;
            NOTICE.helpers.send(&Line::Answers(from, plant));
        }
        if self.due.take_if(|due| *due < Instant::now()).is_some() {
            let by_hand = self.authority.by_hand();
            report(format!(
                "no second process: if the app is killed, the controls stay held until its next \
                 start, or {by_hand}"
            ));
        }
    }

    /// The flight is over, and so is the release.
    pub(crate) fn end(&mut self, released: Released) {
        if released == Released::Confirmed {
            self.released(NOTICE.taken.load(Ordering::SeqCst));
        }
    }

    /// What is still held is the second process' to release, from now on; whether there
    /// is one.
    pub(crate) fn hand_over(&self) -> bool {
        NOTICE.helpers.send(&Line::Over);
        self.due.is_none() && NOTICE.helpers.last().is_some()
    }

    /// The release after this takeover is confirmed.
    fn released(&mut self, number: u64) {
        if NOTICE.released.swap(number, Ordering::SeqCst) != number {
            NOTICE.helpers.send(&Line::Free(number));
            self.mark.remove();
        }
    }

    /// A second process that has begun meanwhile.
    fn take_arrived(&mut self, held: Option<PlantId>) {
        let arrived = ARRIVED
            .try_lock()
            .ok()
            .and_then(|mut arrived| arrived.take());
        let Some(pipe) = arrived else {
            return;
        };
        let mut pipe = File::from(pipe);
        // The new pipe has room for it.
        let is_told = write_config(&mut pipe, &self.config).is_ok();
        if is_told && NOTICE.helpers.add(pipe.into()).is_ok() {
            self.due = None;
            self.answers = None;
            if let Some(plant) = held {
                let number = NOTICE.taken.load(Ordering::SeqCst);
                NOTICE.helpers.send(&Line::Held(number, plant));
            }
        }
    }
}

fn write_config(pipe: &mut File, config: &str) -> io::Result<()> {
    pipe.write_all(format!("{config}\n").as_bytes())
}

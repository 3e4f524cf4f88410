//! What outlives this process learns of a takeover before anything is written
//! to the plant: the release helper, through its pipe, and the plant's file.

use std::fmt::Debug;
use std::io::{self, Cursor, Write};
use std::os::fd::AsFd;
use std::process::ChildStdin;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use fcc_core::framework::{PlantId, TakeoverNotice};
use nix::fcntl::{FcntlArg, OFlag, fcntl};

use super::plant_file::PlantFile;

/// Begins a line that gives the number of a takeover and the plant.
pub(super) const HELD: &str = "held ";
/// Begins a line that gives the number of a takeover whose release is
/// confirmed.
pub(super) const FREE: &str = "free ";

/// Room for helpers that are started again, for plants that beacons name, and
/// for files that were removed.
const ROOM: usize = 8;
/// Room for a line with a plant's name.
const LINE_BYTES: usize = 128;

/// A list to which one thread adds while others read it without waiting.
#[derive(Debug)]
struct Growing<T>([OnceLock<T>; ROOM]);

impl<T> Growing<T> {
    const fn new() -> Self {
        Self([const { OnceLock::new() }; ROOM])
    }

    /// Whether there was room.
    fn add(&self, mut value: T) -> bool {
        for place in &self.0 {
            match place.set(value) {
                Ok(()) => return true,
                Err(back) => value = back,
            }
        }
        false
    }

    fn iter(&self) -> impl DoubleEndedIterator<Item = &T> {
        self.0.iter().filter_map(OnceLock::get)
    }
}

/// Passes on that control is taken, from the loop's thread, and that it was
/// released, from the main thread. Each takeover has a number, so that a
/// release which is passed on late does not cover the next takeover.
#[derive(Debug)]
pub(crate) struct Notice {
    taken: AtomicU64,
    /// The last takeover whose release is confirmed.
    released: AtomicU64,
    helpers: Growing<ChildStdin>,
    files: Growing<(PlantId, PlantFile)>,
}

impl Notice {
    /// For the rest of the process: the loop's thread may outlive a flight.
    pub(crate) fn of_this_process() -> &'static Self {
        Box::leak(Box::new(Self {
            taken: AtomicU64::new(0),
            released: AtomicU64::new(0),
            helpers: Growing::new(),
            files: Growing::new(),
        }))
    }

    /// Adds a plant's file. Not while control is held.
    pub(super) fn add_file(&self, plant: PlantId, file: PlantFile) {
        let before = self.taken.fetch_max(file.taken(), Ordering::SeqCst);
        self.released
            .store(before.max(file.taken()), Ordering::SeqCst);
        if !self.files.iter().any(|(known, _)| *known == plant) {
            self.files.add((plant, file));
        }
    }

    /// A plant's file in place of one that was removed, with the same content;
    /// `held` is what is held. Returns whether there was room.
    pub(super) fn replace_file(
        &self,
        plant: PlantId,
        file: PlantFile,
        held: Option<PlantId>,
    ) -> bool {
        if !self.files.add((plant, file)) {
            return false;
        }
        let Some((_, file)) = self.files.iter().next_back() else {
            return false;
        };
        // A takeover meanwhile writes to it, too.
        loop {
            let (number, is_released) = (self.number(), self.is_released());
            file.take(number);
            if is_released {
                file.release(number);
            }
            if number == self.number() {
                break;
            }
        }
        if let Some(plant) = held {
            // The helper makes its lock anew.
            self.send(format_args!("{HELD}{} {plant}\n", self.number()));
        }
        true
    }

    /// From now on this helper is told, whose pipe never waits.
    ///
    /// # Errors
    /// When there were too many already.
    pub(super) fn add_helper(&self, pipe: ChildStdin, held: Option<PlantId>) -> io::Result<()> {
        let flags = OFlag::from_bits_truncate(fcntl(pipe.as_fd(), FcntlArg::F_GETFL)?);
        fcntl(&pipe, FcntlArg::F_SETFL(flags | OFlag::O_NONBLOCK))?;
        if !self.helpers.add(pipe) {
            return Err(io::Error::other("it was started too often"));
        }
        // A takeover meanwhile is told twice, with different numbers.
        if let Some(plant) = held {
            self.send(format_args!("{HELD}{} {plant}\n", self.number()));
        }
        Ok(())
    }

    /// The number of the last takeover; to be read before
    /// [`held`](fcc_core::framework::ControlAuthority::held).
    pub(crate) fn number(&self) -> u64 {
        self.taken.load(Ordering::SeqCst)
    }

    /// Whether the release after the last takeover is confirmed.
    pub(super) fn is_released(&self) -> bool {
        self.number() == self.released.load(Ordering::SeqCst)
    }

    /// Passes on that the release after this takeover is confirmed.
    pub(crate) fn release(&self, number: u64) {
        if self.released.swap(number, Ordering::SeqCst) == number {
            return;
        }
        for (_, file) in self.files.iter() {
            file.release(number);
        }
        self.send(format_args!("{FREE}{number}\n"));
    }

    /// To the last helper: the others have ended. A pipe that is full belongs
    /// to one that is stopped.
    fn send(&self, line: std::fmt::Arguments<'_>) {
        let mut bytes = Cursor::new([0; LINE_BYTES]);
        if bytes.write_fmt(line).is_err() {
            return;
        }
        let length = bytes.position() as usize;
        if let Some(mut pipe) = self.helpers.iter().next_back()
            && let Some(line) = bytes.get_ref().get(..length)
        {
            let _ = pipe.write(line);
        }
    }
}

impl TakeoverNotice for Notice {
    fn taking(&self, plant: &PlantId) {
        let number = self.taken.fetch_add(1, Ordering::SeqCst) + 1;
        let mut files = self.files.iter();
        let file = files.rfind(|(known, _)| known == plant);
        if let Some((_, file)) = file {
            file.take(number);
        }
        self.send(format_args!("{HELD}{number} {plant}\n"));
    }
}

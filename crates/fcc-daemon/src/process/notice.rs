//! What outlives this process learns of a takeover before anything is written
//! to the plant: the release helper, through its pipe, and the plant's file.

use std::io;
use std::process::ChildStdin;
use std::sync::atomic::{AtomicU64, Ordering};

use fcc_core::framework::{PlantId, TakeoverNotice};
use fcc_flight::release::{Growing, HelperPipes, Line};

use super::plant_file::PlantFile;

/// Passes on that control is taken, from the loop's thread, and that it was
/// released, from the main thread. Each takeover has a number, so that a
/// release which is passed on late does not cover the next takeover.
#[derive(Default, Debug)]
pub(crate) struct Notice {
    taken: AtomicU64,
    /// The last takeover whose release is confirmed.
    released: AtomicU64,
    helpers: HelperPipes,
    files: Growing<(PlantId, PlantFile)>,
}

impl Notice {
    /// For the rest of the process: the loop's thread may outlive a flight.
    pub(crate) fn of_this_process() -> &'static Self {
        Box::leak(Box::default())
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
            self.helpers.send(&Line::Held(self.number(), plant));
        }
        true
    }

    /// Stores once more that this plant is held, if another program has overwritten it.
    pub(super) fn store_again(&self, plant: &PlantId) {
        let file = self.files.iter().rfind(|(known, _)| known == plant);
        if let Some((_, file)) = file.filter(|(_, file)| !self.is_released() && !file.is_held()) {
            file.take(self.number());
        }
    }

    /// From now on this helper is told, whose pipe never waits.
    ///
    /// # Errors
    /// When there were too many already.
    pub(super) fn add_helper(&self, pipe: ChildStdin, held: Option<PlantId>) -> io::Result<()> {
        self.helpers.add(pipe.into())?;
        // A takeover meanwhile is told twice, with different numbers.
        if let Some(plant) = held {
            self.helpers.send(&Line::Held(self.number(), plant));
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
        self.helpers.send(&Line::Free(number));
    }

    /// Passes on by what the answers of a plant are known. A helper that was
    /// started again does not know it.
    pub(super) fn answers(&self, plant: PlantId, from: u16) {
        self.helpers.send(&Line::Answers(from, plant));
    }

    /// Passes on that the flight is over: what is still held is the helper's to
    /// release, from now on.
    pub(super) fn end(&self) {
        self.helpers.send(&Line::Over);
    }

    /// Whether the last helper has read all that it was told.
    pub(super) fn is_read(&self) -> bool {
        let unread = self.helpers.last().map(rustix::io::ioctl_fionread);
        !unread.is_some_and(|bytes| bytes.is_ok_and(|bytes| bytes > 0))
    }
}

impl TakeoverNotice for Notice {
    fn taking(&self, plant: &PlantId) {
        let number = self.taken.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        let mut files = self.files.iter();
        let file = files.rfind(|(known, _)| known == plant);
        if let Some((_, file)) = file {
            file.take(number);
        }
        self.helpers.send(&Line::Held(number, *plant));
    }
}

/// Uses a plant's file with this content as daemons do, one after another.
///
/// # Panics
/// When what is taken does not count as held, or what is released does.
#[cfg(fuzzing)]
pub fn use_plant_file(folder: &fcc_telemetry::RunFolder, content: &[u8], steps: &[u8]) {
    let plant = PlantId::new(format_args!("fuzz")).expect("it is short");
    let open = || PlantFile::open(folder, &plant).expect("a folder of this user");
    open().contain(content).expect("a folder of this user");
    let start = || {
        let locked = PlantFile::locked(folder, &plant).expect("a folder of this user");
        let notice = Notice::default();
        notice.add_file(plant, open());
        (locked.expect("the one before has ended"), notice)
    };
    let (mut locked, mut notice) = start();
    let mut held = locked.is_held();
    for step in steps {
        match step % 5 {
            0 => {
                notice.taking(&plant);
                held = true;
            }
            1 => {
                // As while a daemon releases what an earlier one has left held.
                if held && notice.is_released() {
                    notice.taking(&plant);
                }
                notice.release(notice.number());
                held = false;
            }
            2 if !notice.is_released() => notice.release(notice.number().wrapping_sub(1)),
            3 => {
                locked.remove_if_released();
                drop(locked);
                (locked, notice) = start();
            }
            _ => open().remove_if_released(),
        }
        assert_eq!(locked.is_held(), held);
    }
}

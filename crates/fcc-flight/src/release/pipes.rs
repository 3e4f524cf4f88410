//! Pipes to release helpers: written in a tick, so nothing here waits or allocates.

use std::fs::File;
use std::io::{self, Cursor, Write};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::OnceLock;

use nix::fcntl::{FcntlArg, OFlag, fcntl};

use super::Line;

/// Room for helpers that are started again, for plants that beacons name, and
/// for files that were removed.
const ROOM: usize = 8;
/// Room for a line with a plant's name.
const LINE_BYTES: usize = 128;

/// A list to which one thread adds while others read it without waiting.
#[derive(Debug)]
pub struct Growing<T>([OnceLock<T>; ROOM]);

impl<T> Default for Growing<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Growing<T> {
    /// An empty one.
    pub const fn new() -> Self {
        Self([const { OnceLock::new() }; ROOM])
    }

    /// Adds a value; returns whether there was room.
    pub fn add(&self, mut value: T) -> bool {
        for place in &self.0 {
            match place.set(value) {
                Ok(()) => return true,
                Err(back) => value = back,
            }
        }
        false
    }

    /// What was added, in its order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &T> {
        self.0.iter().filter_map(OnceLock::get)
    }
}

/// The pipes to the release helpers of a process, of which the last one is told:
/// those before have ended.
#[derive(Debug, Default)]
pub struct HelperPipes(Growing<File>);

impl HelperPipes {
    /// None yet.
    pub const fn new() -> Self {
        Self(Growing::new())
    }

    /// From now on the helper at the end of this pipe is told; nobody waits for it.
    ///
    /// # Errors
    /// When there were too many already.
    pub fn add(&self, pipe: OwnedFd) -> io::Result<()> {
        let flags = OFlag::from_bits_truncate(fcntl(&pipe, FcntlArg::F_GETFL)?);
        fcntl(&pipe, FcntlArg::F_SETFL(flags | OFlag::O_NONBLOCK))?;
        if self.0.add(pipe.into()) {
            Ok(())
        } else {
            Err(io::Error::other("it was started too often"))
        }
    }

    /// The pipe to the last helper.
    pub fn last(&self) -> Option<BorrowedFd<'_>> {
        self.0.iter().next_back().map(AsFd::as_fd)
    }

    /// Tells it a line. A pipe that is full belongs to a helper that is stopped.
    pub fn send(&self, line: &Line) {
        let mut bytes = Cursor::new([0; LINE_BYTES]);
        if writeln!(bytes, "{line}").is_err() {
            return;
        }
        let length = bytes.position() as usize;
        if let Some(mut pipe) = self.0.iter().next_back()
            && let Some(line) = bytes.get_ref().get(..length)
        {
            let _ = pipe.write(line);
        }
    }
}

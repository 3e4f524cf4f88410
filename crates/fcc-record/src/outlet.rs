//! From the writer of MCAP to the disk: in one write for each commit, so that
//! a file never ends inside a record, and cut back to the last commit when the
//! disk fails.

use std::cell::RefCell;
use std::io::{self, Write};
use std::mem;
use std::rc::Rc;

use super::disk::DiskFile;

/// The way to the disk; shared with the writer of MCAP, which keeps what it
/// writes to.
#[derive(Clone)]
pub(super) struct Outlet(Rc<RefCell<OutletState>>);

struct OutletState {
    file: Box<dyn DiskFile>,
    waiting: Vec<u8>,
    written: u64,
    synced: u64,
    abandoned: bool,
}

impl Outlet {
    pub(super) fn new(file: Box<dyn DiskFile>) -> Self {
        Self(Rc::new(RefCell::new(OutletState {
            file,
            waiting: Vec::new(),
            written: 0,
            synced: 0,
            abandoned: false,
        })))
    }

    /// Passes on what waits, and waits until it is safe.
    pub(super) fn sync(&self) -> io::Result<()> {
        let state = &mut *self.0.borrow_mut();
        state.pass_on()?;
        state.file.sync()?;
        state.synced = state.written;
        Ok(())
    }

    /// Bytes that are safe.
    pub(super) fn synced_bytes(&self) -> u64 {
        self.0.borrow().synced
    }

    /// Cuts off what is not known to be whole, and writes no more.
    pub(super) fn abandon(&self) {
        let state = &mut *self.0.borrow_mut();
        if !mem::replace(&mut state.abandoned, true) {
            // On a disk that failed, this may fail too; readers cope.
            let _ = state.file.cut_to(state.synced);
            let _ = state.file.sync();
        }
    }
}

impl OutletState {
    fn pass_on(&mut self) -> io::Result<()> {
        if !self.abandoned {
            self.file.write_all(&self.waiting)?;
            self.written += self.waiting.len() as u64;
        }
        self.waiting.clear();
        Ok(())
    }
}

impl Write for Outlet {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().waiting.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        // Passed on when it is synced: a flush alone makes nothing safe.
        Ok(())
    }
}

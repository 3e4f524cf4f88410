//! Between the MCAP writer and the disk: one write per commit, so that a file
//! always ends at the end of a record. When the disk fails, the file is
//! truncated to the last commit.

use std::cell::RefCell;
use std::io::{self, Write};
use std::mem;
use std::path::Path;
use std::rc::Rc;

use super::disk::DiskFile;

/// The output; shared with the MCAP writer, which owns its sink.
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

    /// Writes the buffered bytes and syncs.
    pub(super) fn sync(&self) -> io::Result<()> {
        let state = &mut *self.0.borrow_mut();
        state.pass_on()?;
        state.file.sync()?;
        state.synced = state.written;
        Ok(())
    }

    /// Bytes synced.
    pub(super) fn synced_bytes(&self) -> u64 {
        self.0.borrow().synced
    }

    /// What another program did to the file; see [`DiskFile::change`].
    pub(super) fn change(&self, path: &Path) -> Option<String> {
        let state = self.0.borrow();
        state.file.change(path, state.written)
    }

    /// Truncates to the last commit, and writes no more.
    pub(super) fn abandon(&self) {
        let state = &mut *self.0.borrow_mut();
        if !mem::replace(&mut state.abandoned, true) {
            // On a failed disk this may fail too. Readers handle that.
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
        // Written at the next sync: a flush alone guarantees nothing.
        Ok(())
    }
}

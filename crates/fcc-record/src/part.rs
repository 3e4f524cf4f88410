//! A part of a recording that is being written: its file, and what of it a
//! disk that fails would lose.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use fcc_core::framework::MessageOf;

use super::file::RecordingFile;
use super::lost::Lost;
use crate::recorded::Recorded;

/// A part of a recording that is being written.
pub(super) struct Part<C: Recorded> {
    file: RecordingFile<C>,
    /// Records that are committed.
    committed_ticks: u64,
    /// Messages given to the file since.
    uncommitted: Lost,
    /// Gaps told in the file since: the messages in them are lost already.
    gaps: Lost,
    /// Remarks made in the file since.
    remarks: Vec<String>,
}

/// What is left of a part when the disk has failed.
pub(super) struct Abandoned {
    pub(super) path: PathBuf,
    /// Whether there is a record in it; else the file is gone.
    pub(super) kept: bool,
    pub(super) ticks: u64,
    pub(super) bytes: u64,
    /// Gaps that were told in it, and are not.
    pub(super) gaps: Lost,
    /// Messages that were given to it, and are lost.
    pub(super) lost: Lost,
    /// Remarks that were made in it, and are not.
    pub(super) remarks: Vec<String>,
}

impl<C: Recorded> Part<C> {
    pub(super) fn new(file: RecordingFile<C>) -> Self {
        Self {
            file,
            committed_ticks: 0,
            uncommitted: Lost::default(),
            gaps: Lost::default(),
            remarks: Vec::new(),
        }
    }

    /// Takes a record or an event.
    pub(super) fn take(&mut self, message: &MessageOf<C>) -> io::Result<()> {
        match Lost::told_by(message) {
            Some(gap) => self.gaps.join(gap),
            None => self.uncommitted.widen(message),
        }
        self.file.take(message)
    }

    /// Takes words that are not an event of the loop.
    pub(super) fn remark(&mut self, text: String) -> io::Result<()> {
        self.remarks.push(text.clone());
        self.file.remark(text)
    }

    /// Writes what has gathered and waits until it is safe from a loss of
    /// power.
    pub(super) fn commit(&mut self) -> io::Result<()> {
        self.file.commit()?;
        self.committed_ticks = self.file.ticks();
        self.uncommitted = Lost::default();
        self.gaps = Lost::default();
        self.remarks.clear();
        Ok(())
    }

    /// Ends the file as it should end.
    pub(super) fn finish(self, ending: &str) -> io::Result<()> {
        self.file.finish(ending)
    }

    /// Leaves the file as it was when last committed, or deletes one without a
    /// record: nobody needs a file that says nothing.
    pub(super) fn abandon(self) -> Abandoned {
        let kept = self.committed_ticks > 0;
        let path = self.file.path().to_owned();
        let bytes = if kept { self.file.bytes() } else { 0 };
        self.file.abandon();
        if !kept {
            let _ = fs::remove_file(&path);
        }
        Abandoned {
            path,
            kept,
            ticks: self.committed_ticks,
            bytes,
            gaps: self.gaps,
            lost: self.uncommitted,
            remarks: self.remarks,
        }
    }

    pub(super) fn path(&self) -> &Path {
        self.file.path()
    }

    /// Records that are safe on the disk.
    pub(super) fn ticks(&self) -> u64 {
        self.committed_ticks
    }

    /// Bytes that are safe on the disk.
    pub(super) fn bytes(&self) -> u64 {
        self.file.bytes()
    }

    /// Bytes that have gathered since, before they are compressed.
    pub(super) fn gathered_bytes(&self) -> u64 {
        self.file.gathered_bytes()
    }

    /// How much of a flight the file covers, ns.
    pub(super) fn span_ns(&self) -> u64 {
        self.file.span_ns()
    }

    /// What was lost before, and what of it is told in the file.
    pub(super) fn gaps(&self) -> Lost {
        self.gaps
    }
}

//! A part of a recording being written: its file, and what a failing disk would
//! lose of it.

use std::fs;
use std::io;
use std::mem;
use std::path::{Path, PathBuf};

use fcc_core::framework::MessageOf;

use super::document::Document;
use super::file::RecordingFile;
use super::lost::Lost;
use crate::recorded::Recorded;

/// A part of a recording being written.
pub(super) struct Part<C: Recorded> {
    file: RecordingFile<C>,
    /// Records committed.
    committed_ticks: u64,
    /// Messages committed.
    committed: Lost,
    /// Messages not committed yet.
    uncommitted: Lost,
    /// Gaps reported in the file and not committed yet: the messages in them
    /// are already lost.
    gaps: Lost,
    /// Remarks not committed yet.
    remarks: Vec<String>,
}

/// The rest of a part after the disk failed.
pub(super) struct Abandoned {
    pub(super) path: PathBuf,
    /// Whether it contains a record; otherwise the file is deleted.
    pub(super) kept: bool,
    pub(super) ticks: u64,
    pub(super) bytes: u64,
    /// Gaps whose report is lost.
    pub(super) gaps: Lost,
    /// Messages that are lost.
    pub(super) lost: Lost,
    /// Remarks that are lost.
    pub(super) remarks: Vec<String>,
}

impl<C: Recorded> Part<C> {
    pub(super) fn new(file: RecordingFile<C>) -> Self {
        Self {
            file,
            committed_ticks: 0,
            committed: Lost::default(),
            uncommitted: Lost::default(),
            gaps: Lost::default(),
            remarks: Vec::new(),
        }
    }

    /// Takes a record or an event.
    pub(super) fn take(&mut self, message: &MessageOf<C>) -> io::Result<()> {
        match Lost::reported_by(message) {
            Some(gap) => self.gaps.join(gap),
            None => self.uncommitted.widen(message),
        }
        self.file.take(message)
    }

    /// Takes text that is not an event of the loop.
    pub(super) fn remark(&mut self, text: String) -> io::Result<()> {
        self.remarks.push(text.clone());
        self.file.remark(text)
    }

    /// Takes a document.
    pub(super) fn document(&mut self, document: &Document) -> io::Result<()> {
        self.file.document(document)
    }

    /// Writes the buffered messages and waits until they survive a loss of
    /// power.
    pub(super) fn commit(&mut self) -> io::Result<()> {
        self.file.commit()?;
        self.committed_ticks = self.file.ticks();
        self.committed.join(mem::take(&mut self.uncommitted));
        self.gaps = Lost::default();
        self.remarks.clear();
        Ok(())
    }

    /// What another program did to the file, and the committed messages that
    /// are lost by that; none if nothing is known.
    pub(super) fn change(&self) -> Option<(String, Lost)> {
        self.file.change().map(|what| (what, self.committed))
    }

    /// Finishes the file.
    pub(super) fn finish(self, ending: &str) -> io::Result<()> {
        self.file.finish(ending)
    }

    /// Leaves the file as it was when last committed, or deletes it if it
    /// contains no record.
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

    /// Records synced to the disk.
    pub(super) fn ticks(&self) -> u64 {
        self.committed_ticks
    }

    /// Bytes synced to the disk.
    pub(super) fn bytes(&self) -> u64 {
        self.file.bytes()
    }

    /// Bytes buffered since, before compression.
    pub(super) fn gathered_bytes(&self) -> u64 {
        self.file.gathered_bytes()
    }

    /// Duration of the flight in the file, ns.
    pub(super) fn span_ns(&self) -> u64 {
        self.file.span_ns()
    }

    /// Gaps reported in the file and not committed yet.
    pub(super) fn gaps(&self) -> Lost {
        self.gaps
    }
}

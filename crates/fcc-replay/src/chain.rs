//! The files of a recording as one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use fcc_core::framework::{Controller, Message, MessageOf, RecordOf};
use fcc_record::{About, Item, Items, OpenError, Recording};
use serde::Serialize;

use crate::run::{Documents, Replay, Run, run};

/// The files of one recording, oldest first: several if it is in parts.
#[derive(Debug)]
pub struct Chain {
    first: Recording,
    others: Vec<Recording>,
}

/// Reason why files cannot be replayed as one recording.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum ChainError {
    /// No file is given.
    #[error("no recording is given: name at least one file")]
    Empty,
    /// One cannot be read or is not a recording.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// Two are of different runs.
    #[error(
        "{file}: belongs to another run than {first}: give the parts of one recording, or one \
         recording at a time"
    )]
    AnotherRun {
        /// The file.
        file: PathBuf,
        /// The first file.
        first: PathBuf,
    },
    /// They are not in order.
    #[error("{file}: is part {part}, and follows part {after}: give the parts oldest first")]
    OutOfOrder {
        /// The file.
        file: PathBuf,
        /// Its part number.
        part: u32,
        /// Number of the previous part.
        after: u32,
    },
    /// The configuration is not in the file.
    #[error(
        "{file}: contains no configuration, so it is not known what was run: if another program \
         copied it, copy it with its attachments and metadata"
    )]
    NoConfig {
        /// The file.
        file: PathBuf,
    },
}

impl Chain {
    /// Opens the files of a recording of this controller's loop.
    ///
    /// # Errors
    /// When they are not the parts of one recording in their order, or are of
    /// another plant.
    pub fn open<C: Controller>(files: &[PathBuf]) -> Result<Self, ChainError> {
        let mut recordings = files.iter().map(Recording::open_as::<MessageOf<C>>);
        let first = recordings.next().ok_or(ChainError::Empty)??;
        let others = recordings.collect::<Result<Vec<_>, _>>()?;
        let mut before = &first;
        for next in &others {
            follows(before, next)?;
            before = next;
        }
        if first.about().config.trim().is_empty() {
            return Err(ChainError::NoConfig {
                file: first.path().to_owned(),
            });
        }
        Ok(Self { first, others })
    }

    /// Information on the run, from the first file.
    pub const fn about(&self) -> &About {
        self.first.about()
    }

    /// The name of the configuration in the first file, for messages.
    pub fn config_name(&self) -> String {
        format!("{}: config.toml", self.first.path().display())
    }

    /// Total size of the files.
    pub fn bytes(&self) -> u64 {
        self.files().map(Recording::bytes).sum()
    }

    fn files(&self) -> impl Iterator<Item = &Recording> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Replays the recording as far as possible: gives `compare` each tick as
    /// recorded and as replayed, and `progress` from time to time the number of
    /// [`bytes`](Self::bytes) read.
    pub fn replay<C: Controller>(
        &self,
        replay: &mut Replay<C>,
        compare: impl FnMut(&RecordOf<C>, &RecordOf<C>),
        progress: impl FnMut(u64),
    ) -> Replayed {
        let mut messages = ChainMessages::<C, _, _> {
            documents: replay.documents.take(),
            waiting: self.files(),
            present: None,
            bytes_before: 0,
            read: 0,
            progress,
            cuts: Vec::new(),
            damages: Vec::new(),
        };
        let run = run(replay, &mut messages, compare);
        let (cuts, damages) = (messages.cuts, messages.damages);
        replay.documents = messages.documents;
        Replayed { run, cuts, damages }
    }
}

/// Result of a replay.
#[derive(Clone, Debug, Serialize)]
pub struct Replayed {
    /// The replayed part.
    #[serde(flatten)]
    pub run: Run,
    /// Where and why files ended before their recording did.
    pub cuts: Vec<String>,
    /// Damages of the files.
    pub damages: Vec<String>,
}

impl Replayed {
    /// Whether every tick of the recording was replayed, and there was one.
    pub const fn is_complete(&self) -> bool {
        self.run.ticks > 0 && self.run.unflown.is_none() && self.cuts.is_empty()
    }

    /// Text on the part that was not replayed; empty if there is none.
    pub fn missing(&self) -> String {
        let mut text = String::new();
        if self.run.ticks == 0 && self.run.unflown.is_none() {
            text.push_str("\n\nnothing was compared: no tick was replayed");
        }
        if let Some(unflown) = &self.run.unflown {
            let which = match (unflown.first, unflown.last) {
                (Some(first), Some(last)) => format!("{} ticks, {first} to {last}", unflown.ticks),
                _ => "what follows".to_owned(),
            };
            let compared = self.run.last_tick.map_or_else(
                || "nothing was compared".to_owned(),
                |last| format!("compared up to tick {last}"),
            );
            let _ = write!(
                text,
                "\n\nNOT replayed: {which}: {}; {compared}",
                unflown.why
            );
        }
        for damage in self.cuts.iter().chain(&self.damages) {
            let _ = write!(text, "\n\nthe recording is incomplete: {damage}");
        }
        text
    }
}

fn follows(before: &Recording, next: &Recording) -> Result<(), ChainError> {
    let (was, is) = (before.about(), next.about());
    if was.clock_offset_ns != is.clock_offset_ns || was.config != is.config {
        return Err(ChainError::AnotherRun {
            file: next.path().to_owned(),
            first: before.path().to_owned(),
        });
    }
    if is.part <= was.part {
        return Err(ChainError::OutOfOrder {
            file: next.path().to_owned(),
            part: is.part,
            after: was.part,
        });
    }
    Ok(())
}

/// Messages between two reports of progress.
const REPORT_EVERY: u64 = 4_096;

/// All records and events of a recording, file by file.
struct ChainMessages<'a, C: Controller, W, P> {
    documents: Documents,
    waiting: W,
    present: Option<(&'a Path, Items<MessageOf<C>>)>,
    bytes_before: u64,
    read: u64,
    progress: P,
    cuts: Vec<String>,
    damages: Vec<String>,
}

impl<C: Controller, W, P> ChainMessages<'_, C, W, P> {
    fn leave(&mut self) {
        if let Some((path, items)) = self.present.take() {
            self.bytes_before += items.bytes_read();
            if let Some(cut) = items.cut() {
                self.cuts.push(format!("{}: {cut}", path.display()));
            }
        }
    }
}

impl<'a, C: Controller, W: Iterator<Item = &'a Recording>, P: FnMut(u64)> Iterator
    for ChainMessages<'a, C, W, P>
{
    type Item = MessageOf<C>;

    fn next(&mut self) -> Option<MessageOf<C>> {
        self.read += 1;
        if self.read.is_multiple_of(REPORT_EVERY) {
            let present = self.present.as_ref();
            let bytes_present = present.map_or(0, |(_, items)| items.bytes_read());
            (self.progress)(self.bytes_before + bytes_present);
        }
        loop {
            while let Some((path, items)) = &mut self.present
                && let Some(item) = items.next()
            {
                match item {
                    Item::Message(message) => return Some(message),
                    Item::Remark(_) => {}
                    Item::Document(document) => {
                        if let Some(take) = &mut self.documents {
                            take(&document);
                        }
                    }
                    Item::Damage(damage) => {
                        self.damages.push(format!("{}: {damage}", path.display()));
                        // A loss there counts as a loss in the recording.
                        if let Some(gap) = damage.event() {
                            return Some(Message::Event(gap));
                        }
                    }
                }
            }
            self.leave();
            let recording = self.waiting.next()?;
            match recording.items() {
                Ok(items) => self.present = Some((recording.path(), items)),
                Err(error) => self.cuts.push(error.to_string()),
            }
        }
    }
}

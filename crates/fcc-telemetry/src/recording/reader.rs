//! Reads recordings back.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use fcc_core::framework::Message;
use mcap::records::Record;
use prost::Message as _;

use super::about::About;
use super::end::{END, End, Tally};
use super::parse::parse;
use super::raw::RawReader;
use super::schema::{self, Topic};
use super::wire::{self, fcc};
use crate::FlightMessage;

/// A recording, opened: what is known of the flight, and its messages.
///
/// ```no_run
/// use fcc_core::framework::Message;
/// use fcc_telemetry::recording::Recording;
///
/// let recording = Recording::open("recordings/2026-11-20T04-21-33.512Z-built-in-01.mcap")?;
/// println!("{} at {} Hz", recording.about().aircraft, recording.about().rate_hz);
/// let mut messages = recording.messages()?;
/// for message in &mut messages {
///     if let Message::Tick(record) = message {
///         println!("{} {}", record.tick.number, record.outputs.elevator);
///     }
/// }
/// if let Some(cut) = messages.cut() {
///     println!("the recording is not whole: {cut}");
/// }
/// # Ok::<(), fcc_telemetry::recording::OpenError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Recording {
    path: PathBuf,
    bytes: u64,
    about: About,
    whole: bool,
    end: Option<End>,
}

/// Why a file cannot be read as a recording.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum OpenError {
    /// The system refused.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is something else, or cut before it said what it is.
    #[error("{path}: is no recording of fccd: {why}")]
    NotARecording {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

impl Recording {
    /// Opens a recording, whole or cut.
    ///
    /// # Errors
    /// When it cannot be read or is something else.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, OpenError> {
        let path = path.as_ref().to_owned();
        let refused = |source| OpenError::Io {
            path: path.clone(),
            source,
        };
        let mut file = File::open(&path).map_err(refused)?;
        let bytes = file.metadata().map_err(refused)?.len();
        let index = read_footer(&mut file, bytes);
        let end = index.as_ref().and_then(|at| read_end(&mut file, at));
        file.seek(SeekFrom::Start(0)).map_err(refused)?;
        let raw = RawReader::new(file).map_err(refused)?;
        let about = read_about(raw).map_err(|why| OpenError::NotARecording {
            path: path.clone(),
            why,
        })?;
        Ok(Self {
            path,
            bytes,
            about,
            whole: index.is_some(),
            end,
        })
    }

    /// What is known of the flight: the machine, the loop, the configuration.
    pub const fn about(&self) -> &About {
        &self.about
    }

    /// Whether the file ends as it should. If not, the recorder was killed, the
    /// power was lost or the disk was full: see [`recover`](super::recover).
    pub const fn is_whole(&self) -> bool {
        self.whole
    }

    /// The account at the end of the file; none where it is cut. See
    /// [`account`](Self::account).
    pub const fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// The account of what the file holds: its own, or counted from its
    /// messages where it is cut.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn account(&self) -> Result<End, OpenError> {
        if let Some(end) = &self.end {
            return Ok(end.clone());
        }
        let mut tally = Tally::default();
        let mut messages = self.messages()?;
        for message in &mut messages {
            if let Message::Tick(record) = message {
                tally.count(&record);
            }
        }
        Ok(tally.end(messages.cut().unwrap_or("")))
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How long the file is; with [`Messages::bytes_read`] for who shows
    /// progress.
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Records and events from the first, in the order of their log time.
    ///
    /// # Errors
    /// When the file cannot be opened any more.
    pub fn messages(&self) -> Result<Messages, OpenError> {
        File::open(&self.path)
            .and_then(RawReader::new)
            .map(Messages::new)
            .map_err(|source| OpenError::Io {
                path: self.path.clone(),
                source,
            })
    }
}

/// The records and events of a recording, read one by one: memory does not
/// grow with the file.
pub struct Messages {
    raw: RawReader,
    channels: Channels,
    over: bool,
    cut: Option<String>,
}

impl Messages {
    fn new(raw: RawReader) -> Self {
        Self {
            raw,
            channels: Channels::default(),
            over: false,
            cut: None,
        }
    }

    /// Where and why reading ended before the recording did; none while there
    /// is more to read, and after a whole file.
    pub fn cut(&self) -> Option<&str> {
        self.cut.as_deref()
    }

    /// Bytes read so far, of [`Recording::bytes`].
    pub const fn bytes_read(&self) -> u64 {
        self.raw.bytes_read()
    }

    fn read(&mut self) -> Result<Option<FlightMessage>, String> {
        loop {
            let channels = &mut self.channels;
            match self.raw.next(|record| channels.message(&record))? {
                None => return Ok(None),
                Some(Some(message)) => return message.map(Some),
                Some(None) => {}
            }
        }
    }
}

impl Iterator for Messages {
    type Item = FlightMessage;

    fn next(&mut self) -> Option<FlightMessage> {
        if self.over {
            return None;
        }
        let message = self.read().unwrap_or_else(|cut| {
            self.cut = Some(cut);
            None
        });
        self.over = message.is_none();
        message
    }
}

/// Which channels of a file carry what.
#[derive(Default)]
pub(super) struct Channels {
    record: Option<u16>,
    event: Option<u16>,
}

impl Channels {
    /// The message in a record, if it is one of ours.
    pub(super) fn message(&mut self, record: &Record<'_>) -> Option<Result<FlightMessage, String>> {
        match record {
            Record::Channel(channel) if channel.message_encoding == schema::ENCODING => {
                if channel.topic == Topic::Record.name() {
                    self.record = Some(channel.id);
                } else if channel.topic == Topic::Event.name() {
                    self.event = Some(channel.id);
                }
                None
            }
            Record::Message { header, data } => {
                let id = Some(header.channel_id);
                if id == self.record {
                    Some(decode_record(data))
                } else if id == self.event {
                    Some(decode_event(data))
                } else {
                    None
                }
            }
            _ => None,
        }
    }
}

fn decode_record(data: &[u8]) -> Result<FlightMessage, String> {
    let wire = fcc::Record::decode(data).map_err(|e| format!("a record is damaged: {e}"))?;
    wire::decode_record(&wire)
        .map(Message::Tick)
        .map_err(|e| format!("a record cannot be understood: {e}"))
}

fn decode_event(data: &[u8]) -> Result<FlightMessage, String> {
    let wire = fcc::Event::decode(data).map_err(|e| format!("an event is damaged: {e}"))?;
    wire::decode_event(&wire)
        .map(Message::Event)
        .map_err(|e| format!("an event cannot be understood: {e}"))
}

/// Reads what stands before the first message.
fn read_about(mut raw: RawReader) -> Result<About, String> {
    enum Found {
        Header(bool),
        Metadata(bool),
        Other,
        Messages,
    }
    let mut about = About::default();
    let mut known = false;
    loop {
        let found = raw.next(|record| match record {
            Record::Header(header) => Found::Header(header.profile == schema::PROFILE),
            Record::Metadata(metadata) => {
                Found::Metadata(about.take_metadata(&metadata.name, metadata.metadata))
            }
            Record::Attachment { header, data, .. } => {
                about.take_attachment(&header.name, &data);
                Found::Other
            }
            Record::Schema { .. } | Record::Channel(_) | Record::Message { .. } => Found::Messages,
            _ => Found::Other,
        })?;
        match found {
            Some(Found::Header(false)) => {
                return Err("another program wrote it".to_owned());
            }
            Some(Found::Metadata(taken)) => known |= taken,
            Some(Found::Header(true) | Found::Other) => {}
            Some(Found::Messages) | None if known => return Ok(about),
            Some(Found::Messages) | None => {
                return Err("it does not say what flew".to_owned());
            }
        }
    }
}

/// The magic number that begins and ends a file.
const MAGIC_BYTES: u64 = mcap::MAGIC.len() as u64;
/// Opcode, length, two offsets and a checksum.
const FOOTER_BYTES: u64 = 1 + 8 + 8 + 8 + 4;
/// No summary of ours is longer: an hour's is 400 kB.
const MAX_SUMMARY_BYTES: u64 = 64 << 20;
/// Nor an account.
const MAX_METADATA_BYTES: u64 = 1 << 20;

/// Where the index of a whole file is; none if the file is cut.
fn read_footer(file: &mut File, bytes: u64) -> Option<Range<u64>> {
    let footer_at = bytes.checked_sub(FOOTER_BYTES + MAGIC_BYTES)?;
    let tail = read_at(file, footer_at, FOOTER_BYTES + MAGIC_BYTES)?;
    let (footer, magic) = tail.split_at_checked(FOOTER_BYTES as usize)?;
    if magic != mcap::MAGIC {
        return None;
    }
    let Some((Some(Record::Footer(footer)), _)) = split_record(footer) else {
        return None;
    };
    Some(footer.summary_start..footer_at)
}

/// The account that an index points to.
fn read_end(file: &mut File, index: &Range<u64>) -> Option<End> {
    let length = index.end.checked_sub(index.start)?;
    if index.start == 0 || length > MAX_SUMMARY_BYTES {
        return None;
    }
    let summary = read_at(file, index.start, length)?;
    let mut rest = summary.as_slice();
    let index = loop {
        let (record, after) = split_record(rest)?;
        match record {
            Some(Record::MetadataIndex(index)) if index.name == END => break index,
            _ => rest = after,
        }
    };
    if index.length > MAX_METADATA_BYTES {
        return None;
    }
    match split_record(&read_at(file, index.offset, index.length)?)?.0 {
        Some(Record::Metadata(metadata)) => Some(End::from_fields(&metadata.metadata)),
        _ => None,
    }
}

/// The record that bytes begin with, if it can be understood, and what follows
/// it.
fn split_record(bytes: &[u8]) -> Option<(Option<Record<'_>>, &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (body, after) = rest.split_at_checked(length)?;
    Some((parse(*opcode, body).ok(), after))
}

fn read_at(file: &mut File, offset: u64, length: u64) -> Option<Vec<u8>> {
    file.seek(SeekFrom::Start(offset)).ok()?;
    let mut bytes = Vec::new();
    let read = file.take(length).read_to_end(&mut bytes).ok()?;
    (read as u64 == length).then_some(bytes)
}

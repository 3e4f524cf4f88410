//! Finishes a file that is unfinished or damaged.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::mem;
use std::path::{Path, PathBuf};

use mcap::records::{Channel, MessageHeader, Metadata, Record};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError};
use prost::Message as _;
use serde::Serialize;

use super::any_plant::AnyMessage;
use super::channels::Channels;
use super::damage::Damage;
use super::end::{END, End, RunStatistics};
use super::file::options;
use super::foxglove;
use super::item::Item;
use super::name::{self, damaged, unfinished};
use super::raw::{Cut, Next, RawReader};
use super::reader::{OpenError, Recording, Verified};
use super::schema::{ENCODING, Topic, encode_event, undeclared};
use super::settings::Compression;
use super::wire::log::Level;
use super::{disk, opening};

/// The result of recovering a file.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Recovered {
    /// The file, under its own name.
    #[serde(serialize_with = "name::serialize")]
    pub path: PathBuf,
    /// Whether it was already finished and undamaged; then nothing was done.
    pub was_whole: bool,
    /// Records in it.
    pub ticks: u64,
    /// Where and why it was cut off; none if it was finished.
    pub cut: Option<String>,
    /// The damage in it, and what is missing because of it.
    pub damages: Vec<Damage>,
    /// The path of the original file, kept if it was damaged or no tick of it can be
    /// read; none if the recovered one contains all of it.
    #[serde(serialize_with = "name::serialize_option")]
    pub kept: Option<PathBuf>,
}

/// Why a file could not be recovered. The file is then unchanged.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum RecoverError {
    /// It cannot be read, or is not a recording.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A program is writing or recovering it.
    #[error("{0}: is being written or recovered by another program: wait until it has ended")]
    BeingWritten(PathBuf),
    /// The finished file could not be written.
    #[error("{path}: cannot be written: {source}. The recording is unchanged")]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// It is a link, which would be replaced instead of the recording.
    #[error("{path}: is a link: recover the recording itself, {target}")]
    Link {
        /// The link.
        path: PathBuf,
        /// The recording.
        target: PathBuf,
    },
}

/// Finishes a file that is unfinished or damaged: it then contains all messages
/// that can be read, the statistics and the index. An event reports missing
/// ticks. `progress` is called with the number of bytes read.
///
/// The finished file is written beside the original and replaces it in one step
/// after it is synced: at no time is there less data than before. A damaged
/// original is kept, see [`kept`](Recovered::kept). A file that is already
/// finished and undamaged is unchanged, and so is one that the system cannot
/// read to its end.
///
/// # Errors
/// When it cannot be read or written. The file is then unchanged.
pub fn recover(
    path: impl AsRef<Path>,
    mut progress: impl FnMut(u64),
) -> Result<Recovered, RecoverError> {
    let path = path.as_ref();
    let unread = |source| OpenError::Io {
        path: path.to_owned(),
        source,
    };
    // No other program may recover it meanwhile: both would write the same
    // temporary file.
    let lock = disk::lock(path).map_err(unread)?;
    // Checked by name: another program may just have recovered it.
    let recording = Recording::open_which(path, lock.is_none())?;
    if lock.is_none() && !recording.is_whole() {
        return Err(RecoverError::BeingWritten(path.to_owned()));
    }
    // It is read twice.
    let Verified {
        account,
        damages,
        cut,
    } = recording.verify_with(|read| progress(read / 2))?;
    if damages.is_empty() && cut.is_none() {
        return Ok(Recovered {
            path: path.to_owned(),
            was_whole: true,
            ticks: account.ticks,
            cut,
            damages,
            kept: None,
        });
    }
    if lock.is_none() {
        return Err(RecoverError::BeingWritten(path.to_owned()));
    }
    if path.is_symlink() {
        return Err(RecoverError::Link {
            path: path.to_owned(),
            target: fs::canonicalize(path).map_err(unread)?,
        });
    }
    let beside = unfinished(path);
    let failed = |source| RecoverError::Write {
        path: beside.clone(),
        source,
    };
    let half = recording.bytes() / 2;
    let rewritten = rewrite(path, &beside, &damages, |read| progress(half + read / 2));
    let result = match rewritten {
        Ok(Rewritten::Whole { ticks }) => replace(path, &beside, !damages.is_empty() || ticks == 0)
            .map_err(failed)
            .map(|kept| Recovered {
                path: path.to_owned(),
                was_whole: false,
                ticks,
                cut,
                damages,
                kept,
            }),
        Ok(Rewritten::Unreadable(source)) => Err(unread(source).into()),
        Err(error) => Err(failed(error)),
    };
    if result.is_err() {
        let _ = fs::remove_file(&beside);
    }
    result
}

/// Replaces a file; returns the path under which the original is kept, if it
/// is.
fn replace(path: &Path, finished: &Path, keep: bool) -> io::Result<Option<PathBuf>> {
    let kept = keep.then(|| damaged(path));
    if let Some(kept) = &kept {
        // Without hard links the name is missing for a moment; the data never
        // is.
        fs::hard_link(path, kept).or_else(|_| fs::rename(path, kept))?;
    }
    fs::rename(finished, path)?;
    disk::sync_folder_of(path)?;
    Ok(kept)
}

/// The result of writing the finished file.
enum Rewritten {
    Whole { ticks: u64 },
    Unreadable(io::Error),
}

/// Writes a finished file with all records that can be read; `damages` are the
/// gaps. `progress` is called with the number of bytes read.
fn rewrite(
    from: &Path,
    to: &Path,
    damages: &[Damage],
    mut progress: impl FnMut(u64),
) -> io::Result<Rewritten> {
    let mut raw = RawReader::new(opening::open(from)?)?;
    let mut copy = Copy::begin(opening::create_recording_anew(to)?).map_err(to_io)?;
    let mut damages = damages.iter().peekable();
    let ending = loop {
        let damaged_at = match raw.next(|record| copy.take(&record)) {
            Ok(Next::Record(taken)) => {
                let understood = taken.map_err(to_io)?;
                (!understood).then(|| raw.last_bytes().start)
            }
            Ok(Next::Damage(damaged)) => Some(damaged.bytes.start),
            Ok(Next::End) => break "not known: the recording was damaged".to_owned(),
            Err(Cut::Unreadable { source, .. }) => return Ok(Rewritten::Unreadable(source)),
            Err(cut) => break format!("not known: the recording was {cut}"),
        };
        // Several damages may be joined.
        if let Some(at) = damaged_at
            && let Some(damage) = damages.next_if(|damage| damage.from_byte <= at)
        {
            copy.gaps.push(damage.clone());
        }
        if copy.records % CHECK_EVERY == 0 {
            progress(raw.bytes_read());
        }
    };
    let ticks = copy.run_statistics.ticks();
    copy.finish(&ending)?;
    Ok(Rewritten::Whole { ticks })
}

/// Records copied between two reports of progress.
const CHECK_EVERY: u64 = 1_024;

type Output = NoSeek<BufWriter<File>>;

/// The finished file while it is written.
struct Copy {
    writer: mcap::Writer<Output>,
    channels: Channels,
    run_statistics: RunStatistics,
    records: u64,
    /// Gaps before the next message: its channel may be declared between.
    gaps: Vec<Damage>,
    /// Why the recording ended, if known.
    ending: Option<String>,
    last: MessageHeader,
}

impl Copy {
    fn begin(file: File) -> Result<Self, McapError> {
        let writer = options(Compression::default()).create(NoSeek::new(BufWriter::new(file)))?;
        Ok(Self {
            writer,
            channels: Channels::default(),
            run_statistics: RunStatistics::default(),
            records: 0,
            gaps: Vec::new(),
            ending: None,
            last: MessageHeader {
                channel_id: 0,
                sequence: 0,
                log_time: 0,
                publish_time: 0,
            },
        })
    }

    /// Copies a record, unless it is a message that cannot be decoded; true if
    /// copied.
    fn take(&mut self, record: &Record<'_>) -> Result<bool, McapError> {
        self.records += 1;
        match self.channels.item::<AnyMessage>(record, 0) {
            Some(Ok(Item::Message(message))) => self.run_statistics.take(&message),
            Some(Err(_)) => return Ok(false),
            _ => {}
        }
        self.copy(record).map(|()| true)
    }

    fn copy(&mut self, record: &Record<'_>) -> Result<(), McapError> {
        match record {
            // Written anew, from the messages that are there.
            Record::Metadata(metadata) if metadata.name == END => {
                self.ending = Some(End::from_fields(&metadata.metadata).ending);
                Ok(())
            }
            Record::Metadata(metadata) => self.writer.write_metadata(metadata),
            Record::Attachment { header, data, .. } => self.writer.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name.clone(),
                media_type: header.media_type.clone(),
                data: data.clone(),
            }),
            Record::Schema { header, data } => self
                .writer
                .add_schema_with_id(header.id, &header.name, &header.encoding, data)
                .map(drop),
            Record::Channel(channel) => self
                .writer
                .add_channel_with_id(
                    channel.id,
                    channel.schema_id,
                    &channel.topic,
                    &channel.message_encoding,
                    &channel.metadata,
                )
                .map(drop),
            Record::Message { header, data } => {
                self.last = *header;
                self.report_gaps()?;
                self.message(header, data)
            }
            _ => Ok(()),
        }
    }

    /// Writes a message. If the declaration of its channel is damaged, it is
    /// declared as the recorder does; without that it is of no use.
    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), McapError> {
        let id = header.channel_id;
        if !self.channels.is_declared(id) {
            let undeclared = undeclared(id, data).filter(|_| !self.channels.are_renumbered());
            let Some((name, message, descriptors)) = undeclared else {
                return Ok(());
            };
            let schema_id = match message.as_str() {
                "" => 0,
                _ => self.writer.add_schema(&message, ENCODING, &descriptors)?,
            };
            let channel = Channel {
                id,
                schema_id,
                topic: name.to_owned(),
                message_encoding: ENCODING.to_owned(),
                metadata: BTreeMap::new(),
            };
            self.channels.declare(&channel);
            self.copy(&Record::Channel(channel))?;
        }
        self.writer.write_to_known_channel(header, data)
    }

    /// Reports each gap: as an event, and as a line of the log. Another program may
    /// declare their channels later.
    fn report_gaps(&mut self) -> Result<(), McapError> {
        let [event_channel, log_channel] =
            [Topic::Event, Topic::Log].map(|topic| self.channels.of_topic(topic));
        let (Some(event_channel), Some(log_channel)) = (event_channel, log_channel) else {
            return Ok(());
        };
        for damage in mem::take(&mut self.gaps) {
            if let Some(event) = damage.event() {
                self.run_statistics.take(&AnyMessage::Event(event));
                let text = damage.event_text();
                let mut bytes = Vec::new();
                encode_event(&event, &text, &mut bytes);
                self.write(event_channel, &bytes)?;
            }
            let text = damage.remark().text;
            let line = foxglove::line(foxglove::REMARK, text, Level::Warning, self.last.log_time);
            self.write(log_channel, &line.encode_to_vec())?;
        }
        Ok(())
    }

    fn write(&mut self, channel_id: u16, message: &[u8]) -> Result<(), McapError> {
        let header = MessageHeader {
            channel_id,
            ..self.last
        };
        self.message(&header, message)
    }

    fn finish(mut self, ending: &str) -> io::Result<()> {
        self.report_gaps().map_err(to_io)?;
        let ending = self.ending.as_deref().unwrap_or(ending);
        let metadata: BTreeMap<_, _> = self.run_statistics.end(ending).to_fields();
        let end = Metadata {
            name: END.to_owned(),
            metadata,
        };
        self.writer.write_metadata(&end).map_err(to_io)?;
        self.writer.finish().map_err(to_io)?;
        let mut buffered = self.writer.into_inner().into_inner();
        buffered.flush()?;
        buffered.get_ref().sync_all()
    }
}

fn to_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

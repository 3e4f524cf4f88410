//! Makes a finished file of one that was cut off.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, Message};
use mcap::records::{Metadata, Record};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError};
use serde::Serialize;

use super::disk;
use super::end::{END, Tally};
use super::file::options;
use super::name::unfinished;
use super::raw::RawReader;
use super::reader::{Channels, OpenError, Recording};
use super::settings::Compression;

/// What came of recovering a file.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Recovered {
    /// The file, under its own name.
    pub path: PathBuf,
    /// Whether it was whole already; then nothing was done.
    pub was_whole: bool,
    /// Records in it.
    pub ticks: u64,
    /// Where and why it was cut; none if it was whole.
    pub cut: Option<String>,
}

/// Why a file could not be recovered; it is as it was.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum RecoverError {
    /// It cannot be read, or is no recording.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// Somebody is writing it.
    #[error("{0}: is being written right now: end that flight first")]
    BeingWritten(PathBuf),
    /// The finished file could not be written.
    #[error("{path}: cannot be written: {source}. The recording is as it was")]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It takes longer than it may.
    #[error("{0}: is too long to be recovered now: run `fccd recover` on it")]
    TooLong(PathBuf),
}

/// Makes a finished file of one that was cut off: all of its messages, and the
/// account and index that it lacks. `progress` is told how many of its bytes
/// are read.
///
/// The finished file is put together beside the cut one and takes its place in
/// one step once it is safe on the disk: at no moment is there less than
/// before. A whole file is left alone.
///
/// # Errors
/// When it cannot be read or written; it is as it was then.
pub fn recover(
    path: impl AsRef<Path>,
    progress: impl FnMut(u64),
) -> Result<Recovered, RecoverError> {
    attempt(path.as_ref(), None, progress)
}

/// As [`recover`], but gives up after a while.
pub(super) fn recover_within(path: &Path, limit: Duration) -> Result<Recovered, RecoverError> {
    attempt(path, Some(Instant::now() + limit), |_| {})
}

fn attempt(
    path: &Path,
    deadline: Option<Instant>,
    mut progress: impl FnMut(u64),
) -> Result<Recovered, RecoverError> {
    let recording = Recording::open(path)?;
    if recording.is_whole() {
        return Ok(Recovered {
            path: path.to_owned(),
            was_whole: true,
            ticks: recording.account()?.ticks,
            cut: None,
        });
    }
    if disk::is_being_written(path) {
        return Err(RecoverError::BeingWritten(path.to_owned()));
    }
    let beside = unfinished(path);
    let failed = |source| RecoverError::Write {
        path: beside.clone(),
        source,
    };
    let rewritten = rewrite(path, &beside, |read| {
        progress(read);
        deadline.is_none_or(|deadline| Instant::now() < deadline)
    });
    let result = match rewritten {
        Ok(Some(Rewritten { ticks, cut })) => fs::rename(&beside, path)
            .and_then(|()| sync_folder(path))
            .map_err(failed)
            .map(|()| Recovered {
                path: path.to_owned(),
                was_whole: false,
                ticks,
                cut: Some(cut),
            }),
        Ok(None) => Err(RecoverError::TooLong(path.to_owned())),
        Err(error) => Err(failed(error)),
    };
    if result.is_err() {
        let _ = fs::remove_file(&beside);
    }
    result
}

struct Rewritten {
    ticks: u64,
    cut: String,
}

/// Copies record after record until `go_on` says no, which gives none.
fn rewrite(
    from: &Path,
    to: &Path,
    mut go_on: impl FnMut(u64) -> bool,
) -> io::Result<Option<Rewritten>> {
    let mut raw = RawReader::new(File::open(from)?)?;
    let mut copy = Copy::begin(File::create(to)?).map_err(to_io)?;
    let cut = loop {
        match raw.next(|record| copy.take(&record)) {
            Ok(Some(copied)) => copied.map_err(to_io)?,
            Ok(None) => break "its end was damaged".to_owned(),
            Err(cut) => break cut,
        }
        if copy.records % CHECK_EVERY == 0 && !go_on(raw.bytes_read()) {
            return Ok(None);
        }
    };
    let ticks = copy.tally.ticks();
    copy.finish(&format!("not known: the recording was {cut}"))?;
    Ok(Some(Rewritten { ticks, cut }))
}

/// Records copied between two looks at the clock.
const CHECK_EVERY: u64 = 1_024;

type Output = NoSeek<BufWriter<File>>;

/// The finished file while it is put together.
struct Copy {
    writer: mcap::Writer<Output>,
    channels: Channels,
    tally: Tally,
    records: u64,
}

impl Copy {
    fn begin(file: File) -> Result<Self, McapError> {
        let writer = options(Compression::default()).create(NoSeek::new(BufWriter::new(file)))?;
        Ok(Self {
            writer,
            channels: Channels::default(),
            tally: Tally::default(),
            records: 0,
        })
    }

    fn take(&mut self, record: &Record<'_>) -> Result<(), McapError> {
        self.records += 1;
        match self.channels.message(record) {
            Some(Ok(Message::Tick(record))) => self.tally.count(&record),
            Some(Ok(Message::Event(event))) => {
                if let EventKind::NotRecorded { count, .. } = event.kind {
                    self.tally.lose(count);
                }
            }
            Some(Err(_)) | None => {}
        }
        match record {
            Record::Metadata(metadata) if metadata.name != END => {
                self.writer.write_metadata(metadata)
            }
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
            Record::Message { header, data } => self.writer.write_to_known_channel(header, data),
            _ => Ok(()),
        }
    }

    fn finish(mut self, ending: &str) -> io::Result<()> {
        let metadata: BTreeMap<_, _> = self.tally.end(ending).to_fields();
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

fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}

fn to_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

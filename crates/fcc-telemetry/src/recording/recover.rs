//! Makes a finished file of one that was cut off.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mcap::records::{Metadata, Record};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError};
use serde::Serialize;

use super::disk;
use super::end::{END, RunStatistics};
use super::file::options;
use super::items::{Channels, Item};
use super::name::{damaged, unfinished};
use super::raw::{Cut, RawReader};
use super::reader::{OpenError, Recording};
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
    /// Where the file as it was is kept, if it was damaged; none if all that
    /// was in it is in the recovered one.
    pub kept: Option<PathBuf>,
}

/// Why a file could not be recovered; it is as it was.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum RecoverError {
    /// It cannot be read, or is no recording.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// Somebody is writing or recovering it.
    #[error("{0}: is being written right now: end that flight first, or wait for who recovers it")]
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
/// before. A file that is damaged before its end is kept beside it, as
/// [`kept`](Recovered::kept) says: behind the damage there may be more. A whole
/// file is left alone, and so is one that cannot be read to its end.
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
    let unread = |source| OpenError::Io {
        path: path.to_owned(),
        source,
    };
    // Nobody else may recover it meanwhile: two would write one file beside it.
    let _lock = match disk::lock(path).map_err(unread)? {
        Some(lock) => lock,
        None if Recording::open(path)?.is_whole() => return was_whole(path),
        None => return Err(RecoverError::BeingWritten(path.to_owned())),
    };
    // By its name, as another may just have recovered it.
    if Recording::open(path)?.is_whole() {
        return was_whole(path);
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
        Ok(Some(Rewritten {
            cut: Cut::Unreadable { source, .. },
            ..
        })) => Err(unread(source).into()),
        Ok(Some(Rewritten { ticks, cut })) => {
            replace(path, &beside, &cut)
                .map_err(failed)
                .map(|kept| Recovered {
                    path: path.to_owned(),
                    was_whole: false,
                    ticks,
                    cut: Some(cut.to_string()),
                    kept,
                })
        }
        Ok(None) => Err(RecoverError::TooLong(path.to_owned())),
        Err(error) => Err(failed(error)),
    };
    if result.is_err() {
        let _ = fs::remove_file(&beside);
    }
    result
}

fn was_whole(path: &Path) -> Result<Recovered, RecoverError> {
    Ok(Recovered {
        path: path.to_owned(),
        was_whole: true,
        ticks: Recording::open(path)?.account()?.ticks,
        cut: None,
        kept: None,
    })
}

/// Puts a finished file in the place of another; gives where that one is kept,
/// if there may be more in it.
fn replace(path: &Path, finished: &Path, cut: &Cut) -> io::Result<Option<PathBuf>> {
    let kept = matches!(cut, Cut::Damaged { .. }).then(|| damaged(path));
    if let Some(kept) = &kept {
        // Without links it is away for a moment, and never gone.
        fs::hard_link(path, kept).or_else(|_| fs::rename(path, kept))?;
    }
    fs::rename(finished, path)?;
    disk::sync_folder_of(path)?;
    Ok(kept)
}

struct Rewritten {
    ticks: u64,
    cut: Cut,
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
            // It says that it is over, and goes on.
            Ok(None) => {
                break Cut::Damaged {
                    before: raw.bytes_read(),
                    why: "more follows its end".to_owned(),
                };
            }
            Err(cut) => break cut,
        }
        if copy.records % CHECK_EVERY == 0 && !go_on(raw.bytes_read()) {
            return Ok(None);
        }
    };
    let ticks = copy.run_statistics.ticks();
    if !matches!(cut, Cut::Unreadable { .. }) {
        copy.finish(&format!("not known: the recording was {cut}"))?;
    }
    Ok(Some(Rewritten { ticks, cut }))
}

/// Records copied between two looks at the clock.
const CHECK_EVERY: u64 = 1_024;

type Output = NoSeek<BufWriter<File>>;

/// The finished file while it is put together.
struct Copy {
    writer: mcap::Writer<Output>,
    channels: Channels,
    run_statistics: RunStatistics,
    records: u64,
}

impl Copy {
    fn begin(file: File) -> Result<Self, McapError> {
        let writer = options(Compression::default()).create(NoSeek::new(BufWriter::new(file)))?;
        Ok(Self {
            writer,
            channels: Channels::default(),
            run_statistics: RunStatistics::default(),
            records: 0,
        })
    }

    fn take(&mut self, record: &Record<'_>) -> Result<(), McapError> {
        self.records += 1;
        if let Some(Ok(Item::Message(message))) = self.channels.item(record, 0) {
            self.run_statistics.take(&message);
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

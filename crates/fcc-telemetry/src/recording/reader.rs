//! Reads recordings back.

use std::fs::File;
use std::io::{self, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use mcap::records::Record;

use super::about::About;
use super::end::{End, RunStatistics};
use super::items::{Items, Messages};
use super::raw::RawReader;
use super::schema;
use super::summary::{read_end, read_footer};

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
        let mut run_statistics = RunStatistics::default();
        let mut messages = self.messages()?;
        for message in &mut messages {
            run_statistics.take(&message);
        }
        Ok(run_statistics.end(messages.cut().unwrap_or("")))
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
        self.items().map(Messages)
    }

    /// Records, events and remarks from the first, in the order of their log
    /// time.
    ///
    /// # Errors
    /// When the file cannot be opened any more.
    pub fn items(&self) -> Result<Items, OpenError> {
        File::open(&self.path)
            .and_then(RawReader::new)
            .map(|raw| Items::new(raw, self.about.clock_offset_ns))
            .map_err(|source| OpenError::Io {
                path: self.path.clone(),
                source,
            })
    }
}

/// Reads what stands before the first message.
fn read_about(mut raw: RawReader) -> Result<About, String> {
    enum Found {
        Header { profile: String, library: String },
        Metadata(bool),
        Other,
        Messages,
    }
    let mut about = About::default();
    let mut known = false;
    loop {
        let found = raw.next(|record| match record {
            Record::Header(header) => Found::Header {
                profile: header.profile,
                library: header.library,
            },
            Record::Metadata(metadata) => {
                Found::Metadata(about.take_metadata(&metadata.name, metadata.metadata))
            }
            Record::Attachment { header, data, .. } => {
                about.take_attachment(&header.name, &data);
                Found::Other
            }
            Record::Schema { .. } | Record::Channel(_) | Record::Message { .. } => Found::Messages,
            _ => Found::Other,
        });
        let found = found.map_err(|cut| cut.to_string())?;
        match found {
            Some(Found::Header { profile, library }) => match profile.as_str() {
                schema::PROFILE => {}
                schema::FIRST_PROFILE => {
                    return Err(format!(
                        "{library} wrote it, in a format before {}: read it with that version, \
                         or with Foxglove or any other program that reads MCAP",
                        schema::PROFILE
                    ));
                }
                _ => return Err("another program wrote it".to_owned()),
            },
            Some(Found::Metadata(taken)) => known |= taken,
            Some(Found::Other) => {}
            Some(Found::Messages) | None if known => return Ok(about),
            Some(Found::Messages) | None => {
                return Err("it does not say what flew".to_owned());
            }
        }
    }
}

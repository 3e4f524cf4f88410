//! Reads recordings back.

use std::io::{self, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use mcap::records::Record;

use super::about::About;
use super::damage::Damage;
use super::disk;
use super::end::{End, RunStatistics};
use super::items::{AnyMessage, Items, Messages, RecordedMessage};
use super::raw::{Found, RawReader};
use super::schema;
use super::summary;

/// A recording, opened: what is known of the flight, and its messages.
///
/// ```no_run
/// use fcc_core::framework::Message;
/// use fcc_record::Recording;
/// use fcc_telemetry::FlightMessage;
///
/// let recording = Recording::open("recordings/2026-11-20T04-21-33.512Z-built-in-01.mcap")?;
/// println!("{} at {} Hz", recording.about().aircraft, recording.about().rate_hz);
/// let mut messages = recording.messages::<FlightMessage>()?;
/// for message in &mut messages {
///     if let Message::Tick(record) = message {
///         println!("{} {}", record.tick.number, record.outputs.elevator);
///     }
/// }
/// if let Some(cut) = messages.cut() {
///     println!("the recording is not whole: {cut}");
/// }
/// for damage in messages.damages() {
///     println!("the recording is {damage}");
/// }
/// # Ok::<(), fcc_record::OpenError>(())
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

/// What is in a file, once it was read through.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Verified {
    /// The account of what can be read.
    pub account: End,
    /// What is damaged.
    pub damages: Vec<Damage>,
    /// Where and why the file ends before the recording did.
    pub cut: Option<String>,
}

/// Ticks read between two looks at the clock.
const CHECK_EVERY: u64 = 1_024;

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
        let mut file = disk::open(&path).map_err(refused)?;
        let bytes = file.metadata().map_err(refused)?.len();
        let index = summary::read_footer(&mut file, bytes);
        let end = index.as_ref().and_then(|at| {
            let summary = summary::read(&mut file, at).ok()?;
            summary::read_end(&mut file, &summary)
        });
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
    /// Whether it is damaged before its end is known once it was read through:
    /// see [`verify`](Self::verify).
    pub const fn is_whole(&self) -> bool {
        self.whole
    }

    /// The account at the end of the file; none where it is cut or damaged. See
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
        match &self.end {
            Some(end) => Ok(end.clone()),
            None => Ok(self.verify()?.account),
        }
    }

    /// Reads all of the file, and says what in it is damaged.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn verify(&self) -> Result<Verified, OpenError> {
        self.verify_while(|_| true).map(Option::unwrap_or_default)
    }

    /// As [`verify`](Self::verify), unless `go_on`, told how many bytes are
    /// read, says no: then there is nothing to say.
    pub(super) fn verify_while(
        &self,
        mut go_on: impl FnMut(u64) -> bool,
    ) -> Result<Option<Verified>, OpenError> {
        match &self.end {
            // Without damage there is no need to understand every message.
            Some(end) if self.is_undamaged(&mut go_on)? => Ok(Some(Verified {
                account: end.clone(),
                ..Verified::default()
            })),
            _ => self.count(go_on),
        }
    }

    /// Whether every checksum holds, up to an end that is as it should be.
    fn is_undamaged(&self, go_on: &mut impl FnMut(u64) -> bool) -> Result<bool, OpenError> {
        let mut raw = self.raw()?;
        let mut records = 0_u64;
        loop {
            match raw.next(|_| ()) {
                Ok(Found::Record(())) => records += 1,
                Ok(Found::End) => return Ok(true),
                Ok(Found::Damage(_)) | Err(_) => return Ok(false),
            }
            if records.is_multiple_of(CHECK_EVERY) && !go_on(raw.bytes_read()) {
                return Ok(false);
            }
        }
    }

    /// Reads message by message.
    fn count(&self, mut go_on: impl FnMut(u64) -> bool) -> Result<Option<Verified>, OpenError> {
        let mut run_statistics = RunStatistics::default();
        let mut messages = self.messages::<AnyMessage>()?;
        while let Some(message) = messages.next() {
            run_statistics.take(&message);
            if run_statistics.ticks().is_multiple_of(CHECK_EVERY) && !go_on(messages.bytes_read()) {
                return Ok(None);
            }
        }
        let cut = messages.cut().map(str::to_owned);
        let ending = match &self.end {
            Some(end) => end.ending.clone(),
            None => cut.clone().unwrap_or_default(),
        };
        Ok(Some(Verified {
            account: run_statistics.end(&ending),
            damages: messages.into_damages(),
            cut,
        }))
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
    pub fn messages<M: RecordedMessage>(&self) -> Result<Messages<M>, OpenError> {
        self.items().map(Messages::new)
    }

    /// Records, events and remarks from the first, in the order of their log
    /// time.
    ///
    /// # Errors
    /// When the file cannot be opened any more.
    pub fn items<M: RecordedMessage>(&self) -> Result<Items<M>, OpenError> {
        self.raw()
            .map(|raw| Items::new(raw, self.about.clock_offset_ns, self.end.clone()))
    }

    fn raw(&self) -> Result<RawReader, OpenError> {
        disk::open(&self.path)
            .and_then(RawReader::new)
            .map_err(|source| OpenError::Io {
                path: self.path.clone(),
                source,
            })
    }
}

/// Which program wrote a file.
enum Written {
    /// This one.
    Now,
    /// A version of it with an earlier format, by its name.
    Before(String),
    /// Another.
    ByOthers,
}

/// Reads what stands before the first message.
fn read_about(mut raw: RawReader) -> Result<About, String> {
    enum Said {
        Profile(Written),
        Flight(bool),
        Other,
        Messages,
    }
    let mut about = About::default();
    let (mut is_ours, mut known) = (false, false);
    loop {
        let said = raw.next(|record| match record {
            Record::Header(header) => Said::Profile(match header.profile.as_str() {
                schema::PROFILE => Written::Now,
                schema::FIRST_PROFILE => Written::Before(header.library),
                _ => Written::ByOthers,
            }),
            Record::Metadata(metadata) => {
                Said::Flight(about.take_metadata(&metadata.name, metadata.metadata))
            }
            Record::Attachment { header, data, .. } => {
                about.take_attachment(&header.name, &data);
                Said::Other
            }
            Record::Schema { .. } | Record::Channel(_) | Record::Message { .. } => Said::Messages,
            _ => Said::Other,
        });
        match said.map_err(|cut| cut.to_string())? {
            Found::Record(Said::Profile(Written::Before(library))) => {
                return Err(format!(
                    "{library} wrote it, in a format before {}: read it with that version, or \
                     with Foxglove or any other program that reads MCAP",
                    schema::PROFILE
                ));
            }
            Found::Record(Said::Profile(written)) => is_ours = matches!(written, Written::Now),
            Found::Record(Said::Flight(taken)) => known |= taken,
            Found::Record(Said::Other) | Found::Damage(_) => {}
            // Either may be what is damaged.
            Found::Record(Said::Messages) if is_ours || known => return Ok(about),
            Found::End if known => return Ok(about),
            Found::End if is_ours => return Err("it does not say what flew".to_owned()),
            Found::Record(Said::Messages) | Found::End => {
                return Err("another program wrote it".to_owned());
            }
        }
    }
}

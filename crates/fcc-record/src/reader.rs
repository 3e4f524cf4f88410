//! Reads recordings.

use std::io::{self, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use super::about::About;
use super::any_plant::AnyMessage;
use super::channels::Channels;
use super::damage::Damage;
use super::description::{Refusal, describe};
use super::end::{End, RunStatistics};
use super::item::RecordedMessage;
use super::items::{Items, Messages, Source};
use super::order::{Order, Sorted};
use super::raw::{Cut, Next, RawReader};
use super::schema::Topic;
use super::{disk, opening, summary};
use fcc_telemetry::schema::RecordDescription;

/// An opened recording: what is known of the flight, and its messages.
///
/// ```no_run
/// use fcc_core::framework::Message;
/// use fcc_record::Recording;
/// use fcc_telemetry::FlightMessage;
///
/// let recording = Recording::open("recordings/2026-11-20T04-21-33.512Z-built-in-01.mcap")?;
/// println!("{} at {} Hz", recording.about().plant, recording.about().rate_hz);
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
    columns: Option<RecordDescription>,
    whole: bool,
    being_written: bool,
    end: Option<End>,
}

/// Why a file cannot be read as a recording.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum OpenError {
    /// The system's error.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file ends in the description of the flight, with which a recording
    /// begins.
    #[error(
        "{path}: {cut}: the description of the flight, with which a recording begins, is not \
         complete, so nothing of it can be read"
    )]
    CutInDescription {
        /// The file.
        path: PathBuf,
        /// Where it ends, as text.
        cut: String,
    },
    /// The file is not a recording.
    #[error("{path}: not a recording of fccd: {why}")]
    NotARecording {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, as text.
        why: String,
    },
    /// Another program has written it in another order.
    #[error(
        "{path}: its messages are not in order of their log time, and too many to be sorted in \
         memory: sort it first, for example by `mcap sort`"
    )]
    OutOfOrder {
        /// The file.
        path: PathBuf,
    },
    /// It is a recording of another plant than the program's.
    #[error(
        "{path}: is a recording of another plant, {plant}, by {software}: open it with that \
         program, or in Python with fcc.Recording, which reads every plant's"
    )]
    AnotherPlant {
        /// The file.
        path: PathBuf,
        /// Its plant.
        plant: String,
        /// The program that recorded it.
        software: String,
    },
}

/// What reading a whole file found.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Verified {
    /// Statistics of what can be read.
    pub account: End,
    /// The damage.
    pub damages: Vec<Damage>,
    /// Where and why the file ends before the recording did.
    pub cut: Option<String>,
}

/// Ticks read between two reports of progress.
const CHECK_EVERY: u64 = 1_024;

impl Recording {
    /// Opens a recording, finished or not.
    ///
    /// # Errors
    /// When it cannot be read or is not a recording.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, OpenError> {
        Self::open_which(path.as_ref(), disk::is_being_written(path.as_ref()))
    }

    /// As [`open`](Self::open), of a file that a program writes, or not.
    pub(super) fn open_which(path: &Path, being_written: bool) -> Result<Self, OpenError> {
        let path = path.to_owned();
        let refused = |source| OpenError::Io {
            path: path.clone(),
            source,
        };
        let mut file = opening::open(&path).map_err(refused)?;
        let bytes = file.metadata().map_err(refused)?.len();
        let index = summary::read_footer(&mut file, bytes);
        let summary = index
            .as_ref()
            .and_then(|at| summary::read(&mut file, at).ok());
        let end = summary.as_ref();
        let end = end.and_then(|summary| summary::read_end(&mut file, summary));
        file.seek(SeekFrom::Start(0)).map_err(refused)?;
        let raw = RawReader::new(file).map_err(refused)?;
        let described = describe(raw, summary.as_ref(), end.is_some()).map_err(|refusal| {
            let path = path.clone();
            match refusal {
                Refusal::Cut(cut) => match cut.of_file(being_written) {
                    cut @ (Cut::Off(_) | Cut::NotYet(_)) => OpenError::CutInDescription {
                        path,
                        cut: cut.to_string(),
                    },
                    cut => OpenError::NotARecording {
                        path,
                        why: cut.to_string(),
                    },
                },
                Refusal::Other(why) => OpenError::NotARecording { path, why },
            }
        })?;
        Ok(Self {
            path,
            bytes,
            about: described.about,
            columns: described.columns,
            whole: index.is_some(),
            being_written,
            end: if described.is_merged {
                None
            } else {
                end.or(described.end)
            },
        })
    }

    /// Opens a recording of the plant of these messages.
    ///
    /// # Errors
    /// As [`open`](Self::open), or that it is another plant's.
    pub fn open_as<M: RecordedMessage>(path: impl AsRef<Path>) -> Result<Self, OpenError> {
        let recording = Self::open(path)?;
        recording.has_plant_of::<M>()?;
        Ok(recording)
    }

    /// What is known of the flight: machine, loop, configuration.
    pub const fn about(&self) -> &About {
        &self.about
    }

    /// The columns of its records, for programs without its plant's types; none
    /// if they are damaged.
    pub const fn columns(&self) -> Option<&RecordDescription> {
        self.columns.as_ref()
    }

    /// Whether the file is finished. If not, the recorder was killed, the power
    /// was lost or the disk was full: see [`recover`](super::recover). Damage
    /// before the end is found by [`verify`](Self::verify).
    pub const fn is_whole(&self) -> bool {
        self.whole
    }

    /// Whether it is not finished because a program was writing it when it was
    /// opened.
    pub const fn is_being_written(&self) -> bool {
        self.being_written && !self.whole
    }

    /// The statistics at the end of the file; none if it is unfinished or
    /// damaged there. See [`account`](Self::account).
    pub const fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// The statistics at the end of the file, or counted from its messages if
    /// it is unfinished.
    ///
    /// # Errors
    /// When the file can no longer be read.
    pub fn account(&self) -> Result<End, OpenError> {
        match &self.end {
            Some(end) => Ok(end.clone()),
            None => Ok(self.verify()?.account),
        }
    }

    /// Reads the whole file and reports its damage.
    ///
    /// # Errors
    /// When the file can no longer be read.
    pub fn verify(&self) -> Result<Verified, OpenError> {
        self.verify_with(|_| {})
    }

    /// As [`verify`](Self::verify). `progress` is called with the number of bytes
    /// read.
    pub(super) fn verify_with(&self, mut progress: impl FnMut(u64)) -> Result<Verified, OpenError> {
        match &self.end {
            // Without damage there is no need to decode every message.
            Some(end) if self.is_undamaged(end, &mut progress)? => Ok(Verified {
                account: end.clone(),
                ..Verified::default()
            }),
            _ => self.count(progress),
        }
    }

    /// Whether every checksum matches, the file is finished, and no program has left
    /// out a record or an event.
    fn is_undamaged(&self, end: &End, progress: &mut impl FnMut(u64)) -> Result<bool, OpenError> {
        let mut raw = self.raw()?;
        let mut channels = Channels::default();
        let (mut all, mut records, mut events) = (0_u64, 0_u64, 0_u64);
        loop {
            match raw.next(|record| channels.message(&record).map(|(topic, ..)| topic)) {
                Ok(Next::Record(topic)) => {
                    records += u64::from(topic == Some(Topic::Record));
                    events += u64::from(topic == Some(Topic::Event));
                }
                Ok(Next::End) => return Ok(records == end.ticks && events >= end.events),
                Ok(Next::Damage(_)) | Err(_) => return Ok(false),
            }
            all += 1;
            if all.is_multiple_of(CHECK_EVERY) {
                progress(raw.bytes_read());
            }
        }
    }

    /// Decodes every message.
    fn count(&self, mut progress: impl FnMut(u64)) -> Result<Verified, OpenError> {
        let mut run_statistics = RunStatistics::default();
        let mut messages = self.messages::<AnyMessage>()?;
        while let Some(message) = messages.next() {
            run_statistics.take(&message);
            if run_statistics.ticks().is_multiple_of(CHECK_EVERY) {
                progress(messages.bytes_read());
            }
        }
        let cut = messages.cut().map(str::to_owned);
        let ending = match &self.end {
            Some(end) => end.ending.clone(),
            None => cut.clone().unwrap_or_default(),
        };
        Ok(Verified {
            account: run_statistics.end(&ending),
            damages: messages.into_damages(),
            cut,
        })
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The length of the file; with [`Messages::bytes_read`], to show progress.
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Records and events from the first, in order of log time.
    ///
    /// # Errors
    /// When the file can no longer be opened, or is of another plant.
    pub fn messages<M: RecordedMessage>(&self) -> Result<Messages<M>, OpenError> {
        self.items().map(Messages::new)
    }

    /// Records, events and remarks from the first, in order of log time.
    ///
    /// # Errors
    /// When the file can no longer be opened, or is of another plant.
    pub fn items<M: RecordedMessage>(&self) -> Result<Items<M>, OpenError> {
        self.has_plant_of::<M>()?;
        let order = Order::of(self.raw()?);
        let is_of_file = order.is_of_file().map_err(|()| OpenError::OutOfOrder {
            path: self.path.clone(),
        })?;
        let raw = self.raw()?;
        let source = if is_of_file {
            Source::File(Box::new(raw), Channels::default())
        } else {
            Source::Sorted(Sorted::read(raw))
        };
        Ok(Items::new(
            order.documents,
            source,
            self.about.clock_offset_ns,
            self.end.clone(),
            self.being_written,
        ))
    }

    fn has_plant_of<M: RecordedMessage>(&self) -> Result<(), OpenError> {
        let Some(columns) = &self.columns else {
            return Ok(());
        };
        match M::columns() {
            Some(own) if columns.is_of_another_plant(&own) => Err(OpenError::AnotherPlant {
                path: self.path.clone(),
                plant: self.about.plant.clone(),
                software: self.about.software.clone(),
            }),
            _ => Ok(()),
        }
    }

    fn raw(&self) -> Result<RawReader, OpenError> {
        opening::open(&self.path)
            .and_then(RawReader::new)
            .map_err(|source| OpenError::Io {
                path: self.path.clone(),
                source,
            })
    }
}

//! The files of a recording as one.

use std::path::{Path, PathBuf};

use fcc_core::framework::Message;
use fcc_record::{About, Item, Items, OpenError, Recording};
use fcc_telemetry::FlightMessage;

use crate::config::{Config, ConfigError};

/// The files of one recording, oldest first: one, or several where it was
/// rotated.
#[derive(Debug)]
pub struct Chain {
    recordings: Vec<Recording>,
    config: Config,
}

/// Why files cannot be replayed as one recording.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum ChainError {
    /// No file is given.
    #[error("no recording is given: name at least one file")]
    Empty,
    /// One cannot be read or is something else.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// Two are of different flights.
    #[error(
        "{file}: is of another flight than {first}: give the parts of one recording, or one \
         recording at a time"
    )]
    AnotherFlight {
        /// Which file.
        file: PathBuf,
        /// The file it does not go with.
        first: PathBuf,
    },
    /// They are not given in their order.
    #[error("{file}: is part {part}, and follows part {after}: give the parts oldest first")]
    OutOfOrder {
        /// Which file.
        file: PathBuf,
        /// Which part of the recording it is.
        part: u32,
        /// The part before it.
        after: u32,
    },
    /// The configuration that was flown is not in the file.
    #[error("{file}: holds no configuration, so it is not known what was flown")]
    NoConfig {
        /// Which file.
        file: PathBuf,
    },
    /// The configuration that was flown is not one that this version reads.
    #[error("the configuration in the recording cannot be read by this version of fccd:\n{0}")]
    Config(#[from] ConfigError),
}

impl Chain {
    /// Opens the files of a recording.
    ///
    /// # Errors
    /// When they are not the parts of one recording in their order, or its
    /// configuration cannot be read.
    pub fn open(files: &[PathBuf]) -> Result<Self, ChainError> {
        let recordings = files
            .iter()
            .map(Recording::open)
            .collect::<Result<Vec<_>, _>>()?;
        let Some(first) = recordings.first() else {
            return Err(ChainError::Empty);
        };
        for (before, next) in recordings.iter().zip(recordings.iter().skip(1)) {
            follows(before, next)?;
        }
        if first.about().config.trim().is_empty() {
            return Err(ChainError::NoConfig {
                file: first.path().to_owned(),
            });
        }
        let config = Config::parse(&first.about().config, &name(first.path()))?;
        Ok(Self { recordings, config })
    }

    /// The configuration that was flown, defaults and command line included.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// What is known of the flight, from the first file.
    pub fn about(&self) -> Option<&About> {
        self.recordings.first().map(Recording::about)
    }

    /// How long the files are together.
    pub fn bytes(&self) -> u64 {
        self.recordings.iter().map(Recording::bytes).sum()
    }

    /// All records and events, file by file.
    pub fn messages(&self) -> ChainMessages<'_> {
        ChainMessages {
            waiting: self.recordings.iter(),
            present: None,
            bytes_before: 0,
            cuts: Vec::new(),
            damages: Vec::new(),
        }
    }
}

fn name(path: &Path) -> String {
    format!("{}: config.toml", path.display())
}

fn follows(before: &Recording, next: &Recording) -> Result<(), ChainError> {
    let (was, is) = (before.about(), next.about());
    if was.clock_offset_ns != is.clock_offset_ns || was.config != is.config {
        return Err(ChainError::AnotherFlight {
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

/// All records and events of a recording, file by file.
pub struct ChainMessages<'a> {
    waiting: std::slice::Iter<'a, Recording>,
    present: Option<(&'a Path, Items<FlightMessage>)>,
    bytes_before: u64,
    cuts: Vec<String>,
    damages: Vec<String>,
}

impl ChainMessages<'_> {
    /// Bytes read so far, of [`Chain::bytes`].
    pub fn bytes_read(&self) -> u64 {
        let present = self.present.as_ref();
        self.bytes_before + present.map_or(0, |(_, items)| items.bytes_read())
    }

    /// Where and why files read so far ended before their recording did.
    pub fn cuts(&self) -> &[String] {
        &self.cuts
    }

    /// What in the files read so far is damaged.
    pub fn damages(&self) -> &[String] {
        &self.damages
    }

    fn leave(&mut self) {
        if let Some((path, items)) = self.present.take() {
            self.bytes_before += items.bytes_read();
            if let Some(cut) = items.cut() {
                self.cuts.push(format!("{}: {cut}", path.display()));
            }
        }
    }
}

impl Iterator for ChainMessages<'_> {
    type Item = FlightMessage;

    fn next(&mut self) -> Option<FlightMessage> {
        loop {
            while let Some((path, items)) = &mut self.present
                && let Some(item) = items.next()
            {
                match item {
                    Item::Message(message) => return Some(message),
                    Item::Remark(_) => {}
                    Item::Damage(damage) => {
                        self.damages.push(format!("{}: {damage}", path.display()));
                        // What was lost there is lost as if it had never been
                        // recorded.
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

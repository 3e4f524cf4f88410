//! One file of a recording while it is written.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::mem;
use std::path::{Path, PathBuf};

use fcc_core::framework::{EventOf, Message, MessageOf, RecordOf};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};

use super::about::{About, COLUMNS, CONFIG, CONFIG_AS_GIVEN};
use super::disk::Disk;
use super::document::{Document, MEDIA_TYPE};
use super::end::{END, RunStatistics};
use super::foxglove;
use super::outlet::Outlet;
use super::record_messages::RecordMessages;
use super::schema::{self, Topic, topics};
use super::settings::Compression;
use super::wire::log::Level;
use crate::recorded::Recorded;
use fcc_telemetry::describe_event;
use fcc_telemetry::schema::RecordDescription;

/// The largest size of a chunk before compression: the memory a reader needs at
/// once.
const CHUNK_BYTES: u64 = 1 << 20;

/// One file of a recording while it is written.
///
/// Messages are kept in memory until [`commit`](Self::commit) writes them as
/// one chunk and syncs it: at any time the file on the disk ends at the end of
/// a record.
pub(super) struct RecordingFile<C: Recorded> {
    path: PathBuf,
    writer: mcap::Writer<NoSeek<Outlet>>,
    outlet: Outlet,
    channels: Vec<u16>,
    offset_ns: i64,
    first_log_ns: Option<u64>,
    last_log_ns: u64,
    sequence: u32,
    gathered_bytes: u64,
    messages: RecordMessages<C>,
    run_statistics: RunStatistics,
    names: Names,
}

/// Names of the sensors and actuators, for the text of events.
struct Names {
    sensors: Vec<String>,
    actuators: Vec<String>,
}

impl<C: Recorded> RecordingFile<C> {
    /// Begins a file with what is known of the flight, and syncs it.
    pub(super) fn begin(
        disk: &mut dyn Disk,
        path: &Path,
        about: &About,
        compression: Compression,
    ) -> io::Result<Self> {
        let outlet = Outlet::new(disk.create(path)?);
        let begun = Self::write_beginning(&outlet, about, compression).map_err(to_io);
        let (writer, channels) = begun.inspect_err(|_| {
            outlet.abandon();
            // A file with no content is of no use.
            let _ = fs::remove_file(path);
        })?;
        Ok(Self {
            path: path.to_owned(),
            writer,
            outlet,
            channels,
            offset_ns: about.clock_offset_ns,
            first_log_ns: None,
            last_log_ns: about.started_unix_ns,
            sequence: 0,
            gathered_bytes: 0,
            messages: RecordMessages::default(),
            run_statistics: RunStatistics::default(),
            names: Names {
                sensors: about.sensors.clone(),
                actuators: about.actuators.clone(),
            },
        })
    }

    fn write_beginning(
        outlet: &Outlet,
        about: &About,
        compression: Compression,
    ) -> Result<(mcap::Writer<NoSeek<Outlet>>, Vec<u16>), McapError> {
        let mut writer = options(compression)
            .library(about.software.clone())
            .create(NoSeek::new(outlet.clone()))?;
        for (name, metadata) in about.to_metadata() {
            writer.write_metadata(&Metadata {
                name: name.to_owned(),
                metadata,
            })?;
        }
        let as_given = about.config_as_given.as_ref();
        let columns = RecordDescription::of::<RecordOf<C>>().to_json();
        let texts = [
            (CONFIG, "application/toml", Some(&about.config)),
            (CONFIG_AS_GIVEN, "application/toml", as_given),
            (COLUMNS, "application/json", Some(&columns)),
        ];
        for (name, media_type, text) in texts {
            if let Some(text) = text {
                attach(&mut writer, name, media_type, text, about.started_unix_ns)?;
            }
        }
        for Document { name, text } in &about.documents {
            attach(&mut writer, name, MEDIA_TYPE, text, about.started_unix_ns)?;
        }
        let mut channels = Vec::new();
        for (name, schema_name, descriptors) in topics::<C>() {
            let schema = writer.add_schema(&schema_name, schema::ENCODING, &descriptors)?;
            channels.push(writer.add_channel(schema, name, schema::ENCODING, &BTreeMap::new())?);
        }
        writer.flush()?;
        outlet.sync()?;
        Ok((writer, channels))
    }

    /// Takes a record or an event.
    pub(super) fn take(&mut self, message: &MessageOf<C>) -> io::Result<()> {
        self.run_statistics.take(message);
        match message {
            Message::Tick(record) => self.record(record),
            Message::Event(event) => self.event(event),
        }
        .map_err(to_io)
    }

    fn record(&mut self, record: &RecordOf<C>) -> Result<(), McapError> {
        let log_ns = self.log_time(record.tick.woke.as_nanos());
        let mut messages = mem::take(&mut self.messages);
        let mut written = Ok(());
        messages.record(record, log_ns, |topic, bytes| {
            if written.is_ok() {
                written = self.write_bytes(topic, log_ns, bytes);
            }
        });
        self.messages = messages;
        written
    }

    fn event(&mut self, event: &EventOf<C>) -> Result<(), McapError> {
        let log_ns = self.log_time(event.time.as_nanos());
        let text = describe_event::<C>(event, &self.names.sensors, &self.names.actuators);
        let mut bytes = Vec::new();
        schema::encode_event(event, &text, &mut bytes);
        self.write_bytes(Topic::Event as usize, log_ns, &bytes)?;
        let line = foxglove::line(foxglove::EVENT, text, foxglove::level(event), log_ns);
        self.write(Topic::Log as usize, log_ns, &line)
    }

    /// Takes text that is not an event of the loop.
    pub(super) fn remark(&mut self, text: String) -> io::Result<()> {
        let log_ns = self.last_log_ns;
        let line = foxglove::line(foxglove::REMARK, text, Level::Info, log_ns);
        self.write(Topic::Log as usize, log_ns, &line)
            .map_err(to_io)
    }

    /// Takes a document, at its place among the messages.
    pub(super) fn document(&mut self, document: &Document) -> io::Result<()> {
        let Document { name, text } = document;
        self.gathered_bytes += text.len() as u64;
        attach(&mut self.writer, name, MEDIA_TYPE, text, self.last_log_ns).map_err(to_io)
    }

    fn write(
        &mut self,
        topic: usize,
        log_time: u64,
        message: &impl prost::Message,
    ) -> Result<(), McapError> {
        self.write_bytes(topic, log_time, &message.encode_to_vec())
    }

    fn write_bytes(&mut self, topic: usize, log_time: u64, bytes: &[u8]) -> Result<(), McapError> {
        let header = MessageHeader {
            channel_id: self.channels.get(topic).copied().unwrap_or(0),
            sequence: self.sequence,
            log_time,
            publish_time: log_time,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.gathered_bytes += bytes.len() as u64;
        self.writer.write_to_known_channel(&header, bytes)
    }

    /// Wall clock at the start plus the loop's time since. It never goes
    /// backwards, because readers search by it.
    fn log_time(&mut self, loop_ns: i64) -> u64 {
        let unix_ns = if loop_ns == i64::MIN {
            0
        } else {
            u64::try_from(loop_ns.saturating_add(self.offset_ns)).unwrap_or(0)
        };
        self.last_log_ns = self.last_log_ns.max(unix_ns);
        self.first_log_ns.get_or_insert(self.last_log_ns);
        self.last_log_ns
    }

    /// Writes the buffered messages and waits until they survive a loss of
    /// power.
    pub(super) fn commit(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(to_io)?;
        self.outlet.sync()?;
        self.gathered_bytes = 0;
        Ok(())
    }

    /// Finishes the file: statistics and index.
    pub(super) fn finish(mut self, ending: &str) -> io::Result<()> {
        let finished = self
            .write_end(ending)
            .map_err(to_io)
            .and_then(|()| self.outlet.sync());
        if finished.is_err() {
            self.outlet.abandon();
        }
        finished
    }

    fn write_end(&mut self, ending: &str) -> Result<(), McapError> {
        self.writer.write_metadata(&Metadata {
            name: END.to_owned(),
            metadata: self.run_statistics.end(ending).to_fields(),
        })?;
        self.writer.finish()?;
        Ok(())
    }

    /// Leaves the file as it was when last synced: unfinished, with no partial
    /// record.
    pub(super) fn abandon(self) {
        self.outlet.abandon();
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// What another program did to the file; none if nothing is known.
    pub(super) fn change(&self) -> Option<String> {
        self.outlet.change(&self.path)
    }

    /// Bytes synced to the disk.
    pub(super) fn bytes(&self) -> u64 {
        self.outlet.synced_bytes()
    }

    /// Bytes buffered since, before compression.
    pub(super) const fn gathered_bytes(&self) -> u64 {
        self.gathered_bytes
    }

    /// Duration of the flight in the file, ns.
    pub(super) fn span_ns(&self) -> u64 {
        self.first_log_ns
            .map_or(0, |first| self.last_log_ns.saturating_sub(first))
    }

    /// Records given to the file.
    pub(super) fn ticks(&self) -> u64 {
        self.run_statistics.ticks()
    }
}

fn attach(
    writer: &mut mcap::Writer<NoSeek<Outlet>>,
    name: &str,
    media_type: &str,
    text: &str,
    time_ns: u64,
) -> Result<(), McapError> {
    writer.attach(&Attachment {
        log_time: time_ns,
        create_time: time_ns,
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        data: text.as_bytes().into(),
    })
}

/// The options for every file.
pub(super) fn options(compression: Compression) -> WriteOptions {
    WriteOptions::new()
        .profile(schema::PROFILE)
        .compression(compression.to_mcap())
        // The default is one thread per core, which would disturb the flight.
        .compression_threads(0)
        .chunk_size(Some(CHUNK_BYTES))
        // A chunk is assembled in memory and appended as a whole: an unfinished
        // file ends at the end of a chunk.
        .disable_seeking(true)
}

fn to_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

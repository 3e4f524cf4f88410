//! Reads a recording item by item: memory does not grow with the file.

use std::collections::VecDeque;

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Message, Record, Tick, Time};
use mcap::records::{self as mcap_records, MessageHeader};
use prost::Message as _;

use super::about::document;
use super::damage::Damage;
use super::document::Document;
use super::end::End;
use super::foxglove::REMARK;
use super::raw::{DamagedBytes, Next, RawReader};
use super::remark::Remark;
use super::schema::{self, Topic};
use super::wire;
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::schema::protobuf::{DecodeError, decode};

/// A record or an event of a loop, for any plant: the declared schema
/// determines how it is read.
pub trait RecordedMessage: Sized {
    /// The record in a message.
    ///
    /// # Errors
    /// When the bytes are not a record.
    fn record(bytes: &[u8]) -> Result<Self, DecodeError>;

    /// The event in a message.
    ///
    /// # Errors
    /// When the bytes are not an event.
    fn event(bytes: &[u8]) -> Result<Self, DecodeError>;

    /// Its tick; none for an event.
    fn tick(&self) -> Option<&Tick>;

    /// The columns of its record; none if records of any plant are read.
    fn columns() -> Option<RecordDescription>;
}

impl<M: Schema, E: Schema, S: Schema, O: Schema, R: Schema> RecordedMessage
    for Message<M, E, S, O, R>
{
    fn record(bytes: &[u8]) -> Result<Self, DecodeError> {
        decode(bytes).map(Self::Tick)
    }

    fn event(bytes: &[u8]) -> Result<Self, DecodeError> {
        decode(bytes).map(Self::Event)
    }

    fn tick(&self) -> Option<&Tick> {
        match self {
            Self::Tick(record) => Some(&record.tick),
            Self::Event(_) => None,
        }
    }

    fn columns() -> Option<RecordDescription> {
        Some(RecordDescription::of::<Record<M, E, S, O>>())
    }
}

/// One item of a recording.
#[derive(Clone, PartialEq, Debug)]
pub enum Item<M> {
    /// A record or an event of the loop.
    Message(M),
    /// Text that is not an event of the loop.
    Remark(Remark),
    /// A text that came during the flight, or did before the file was begun.
    Document(Document),
    /// Damage; the items that were here are missing.
    Damage(Damage),
}

/// The most items that are held back until it is known which ticks are missing
/// before them.
const MAX_HELD_BACK: usize = 1_024;

/// The records, events and remarks of a recording. Damage is skipped, and
/// reported in its place.
pub struct Items<M> {
    raw: RawReader,
    channels: Channels,
    clock_offset_ns: i64,
    /// The statistics in the file.
    end: Option<End>,
    being_written: bool,
    last_tick: Option<Tick>,
    /// Damage after which no tick was read yet.
    damage: Option<Damage>,
    /// Items read after it.
    held_back: VecDeque<Item<M>>,
    finished: bool,
    cut: Option<String>,
}

impl<M: RecordedMessage> Items<M> {
    pub(super) fn new(
        raw: RawReader,
        clock_offset_ns: i64,
        end: Option<End>,
        being_written: bool,
    ) -> Self {
        Self {
            raw,
            channels: Channels::default(),
            clock_offset_ns,
            end,
            being_written,
            last_tick: None,
            damage: None,
            held_back: VecDeque::new(),
            finished: false,
            cut: None,
        }
    }

    /// Where and why reading ended before the end of the recording; none while
    /// there is more to read, and for a finished file.
    pub fn cut(&self) -> Option<&str> {
        self.cut.as_deref()
    }

    /// Bytes read so far, of [`Recording::bytes`](super::Recording::bytes).
    pub const fn bytes_read(&self) -> u64 {
        self.raw.bytes_read()
    }

    fn read(&mut self) -> Option<Result<Item<M>, DamagedBytes>> {
        loop {
            let (channels, offset_ns) = (&mut self.channels, self.clock_offset_ns);
            match self.raw.next(|record| channels.item(&record, offset_ns)) {
                Err(cut) => {
                    self.cut = Some(cut.of_file(self.being_written).to_string());
                    return None;
                }
                Ok(Next::End) => return None,
                Ok(Next::Damage(damaged)) => return Some(Err(damaged)),
                Ok(Next::Record(Some(Ok(item)))) => return Some(Ok(item)),
                Ok(Next::Record(Some(Err(why)))) => {
                    return Some(Err(DamagedBytes {
                        bytes: self.raw.last_bytes(),
                        why,
                        messages: true,
                    }));
                }
                Ok(Next::Record(None)) => {}
            }
        }
    }

    /// Takes an item; returns it if nothing has to come before it.
    fn take(&mut self, read: Option<Result<Item<M>, DamagedBytes>>) -> Option<Item<M>> {
        match read {
            Some(Ok(item)) => {
                let tick = match &item {
                    Item::Message(message) => message.tick().copied(),
                    _ => None,
                };
                if tick.is_some() || self.held_back.len() >= MAX_HELD_BACK {
                    self.locate_damage(tick.as_ref());
                }
                self.last_tick = tick.or(self.last_tick);
                if self.damage.is_none() && self.held_back.is_empty() {
                    return Some(item);
                }
                self.held_back.push_back(item);
            }
            Some(Err(damaged)) => match &mut self.damage {
                Some(damage) => damage.join(&damaged),
                None => self.damage = Some(Damage::of(damaged)),
            },
            None => {
                self.finished = true;
                self.locate_damage(None);
            }
        }
        None
    }

    fn locate_damage(&mut self, next: Option<&Tick>) {
        if let Some(mut damage) = self.damage.take() {
            // The statistics of the end do not apply to a gap in the middle.
            let end = self
                .end
                .as_ref()
                .filter(|_| next.is_some() || self.finished);
            damage.locate(self.last_tick.as_ref(), next, end);
            self.held_back.push_front(Item::Damage(damage));
        }
    }
}

impl<M: RecordedMessage> Iterator for Items<M> {
    type Item = Item<M>;

    fn next(&mut self) -> Option<Item<M>> {
        loop {
            if self.damage.is_none()
                && let Some(item) = self.held_back.pop_front()
            {
                return Some(item);
            }
            if self.finished {
                return None;
            }
            let read = self.read();
            if let Some(item) = self.take(read) {
                return Some(item);
            }
        }
    }
}

/// The records and events of a recording.
pub struct Messages<M> {
    items: Items<M>,
    damages: Vec<Damage>,
}

impl<M: RecordedMessage> Messages<M> {
    pub(super) const fn new(items: Items<M>) -> Self {
        Self {
            items,
            damages: Vec::new(),
        }
    }

    /// As [`Items::cut`].
    pub fn cut(&self) -> Option<&str> {
        self.items.cut()
    }

    /// Damage found so far.
    pub fn damages(&self) -> &[Damage] {
        &self.damages
    }

    pub(super) fn into_damages(self) -> Vec<Damage> {
        self.damages
    }

    /// As [`Items::bytes_read`].
    pub const fn bytes_read(&self) -> u64 {
        self.items.bytes_read()
    }
}

impl<M: RecordedMessage> Iterator for Messages<M> {
    type Item = M;

    fn next(&mut self) -> Option<M> {
        for item in self.items.by_ref() {
            match item {
                Item::Message(message) => return Some(message),
                Item::Damage(damage) => self.damages.push(damage),
                Item::Remark(_) | Item::Document(_) => {}
            }
        }
        None
    }
}

/// The channels of a file, by content.
pub(super) struct Channels {
    record: u16,
    pub(super) event: u16,
    pub(super) log: u16,
}

/// As the recorder numbers them: the chunk that declares them may be damaged.
impl Default for Channels {
    fn default() -> Self {
        Self {
            record: Topic::Record.channel(),
            event: Topic::Event.channel(),
            log: Topic::Log.channel(),
        }
    }
}

impl Channels {
    /// The item in an MCAP record, if there is one.
    pub(super) fn item<M: RecordedMessage>(
        &mut self,
        record: &mcap_records::Record<'_>,
        clock_offset_ns: i64,
    ) -> Option<Result<Item<M>, String>> {
        match record {
            mcap_records::Record::Channel(channel)
                if channel.message_encoding == schema::ENCODING =>
            {
                for (topic, id) in [
                    (Topic::Record, &mut self.record),
                    (Topic::Event, &mut self.event),
                    (Topic::Log, &mut self.log),
                ] {
                    if channel.topic == topic.name() {
                        *id = channel.id;
                    }
                }
                None
            }
            mcap_records::Record::Message { header, data } => {
                let id = header.channel_id;
                if id == self.record {
                    Some(
                        M::record(data)
                            .map_err(|error| decode_failure("a record", error))
                            .map(Item::Message),
                    )
                } else if id == self.event {
                    Some(
                        M::event(data)
                            .map_err(|error| decode_failure("an event", error))
                            .map(Item::Message),
                    )
                } else if id == self.log {
                    remark(header, data, clock_offset_ns).map(|remark| Ok(Item::Remark(remark)))
                } else {
                    None
                }
            }
            mcap_records::Record::Attachment { header, data, .. } => {
                document(&header.name, data).map(|found| Ok(Item::Document(found)))
            }
            _ => None,
        }
    }
}

fn decode_failure(what: &str, error: DecodeError) -> String {
    match error {
        DecodeError::Unknown(unknown) => format!("{what} cannot be decoded: {unknown}"),
        damaged => format!("{what} is damaged: {damaged}"),
    }
}

/// The remark in a log line; none if the line describes an event, which is
/// recorded separately. Damage to a remark is ignored: it is not part of the
/// flight.
fn remark(header: &MessageHeader, data: &[u8], clock_offset_ns: i64) -> Option<Remark> {
    let line = wire::Log::decode(data).ok()?;
    (line.name == REMARK).then(|| {
        let logged_ns = i64::try_from(header.log_time).unwrap_or(i64::MAX);
        Remark {
            time: Time::from_nanos(logged_ns.saturating_sub(clock_offset_ns)),
            text: line.message,
        }
    })
}

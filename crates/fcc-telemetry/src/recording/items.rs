//! What is in a recording, read one by one: memory does not grow with the file.

use fcc_core::framework::{Message, Time};
use mcap::records::{MessageHeader, Record};
use prost::Message as _;

use super::foxglove::REMARK;
use super::raw::RawReader;
use super::schema::{self, Topic};
use super::wire;
use crate::FlightMessage;
use crate::schema::protobuf::{DecodeError, decode};

/// One thing in a recording.
#[derive(Clone, PartialEq, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are messages, and a box for each would be work for nothing"
)]
pub enum Item {
    /// A record or an event of the loop.
    Message(FlightMessage),
    /// Words that are no event of the loop.
    Remark(Remark),
}

/// Words that are no event of the loop: of the recorder, or of who watches over
/// the connection to a simulator.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Remark {
    /// On the loop's clock: when the last message before it was logged.
    pub time: Time,
    /// For people.
    pub text: String,
}

/// The records, events and remarks of a recording.
pub struct Items {
    raw: RawReader,
    channels: Channels,
    clock_offset_ns: i64,
    over: bool,
    cut: Option<String>,
}

impl Items {
    pub(super) fn new(raw: RawReader, clock_offset_ns: i64) -> Self {
        Self {
            raw,
            channels: Channels::default(),
            clock_offset_ns,
            over: false,
            cut: None,
        }
    }

    /// Where and why reading ended before the recording did; none while there
    /// is more to read, and after a whole file.
    pub fn cut(&self) -> Option<&str> {
        self.cut.as_deref()
    }

    /// Bytes read so far, of [`Recording::bytes`](super::Recording::bytes).
    pub const fn bytes_read(&self) -> u64 {
        self.raw.bytes_read()
    }

    fn read(&mut self) -> Result<Option<Item>, String> {
        loop {
            let (channels, offset_ns) = (&mut self.channels, self.clock_offset_ns);
            let found = self.raw.next(|record| channels.item(&record, offset_ns));
            match found.map_err(|cut| cut.to_string())? {
                None => return Ok(None),
                Some(Some(item)) => return item.map(Some),
                Some(None) => {}
            }
        }
    }
}

impl Iterator for Items {
    type Item = Item;

    fn next(&mut self) -> Option<Item> {
        if self.over {
            return None;
        }
        let item = self.read().unwrap_or_else(|cut| {
            self.cut = Some(cut);
            None
        });
        self.over = item.is_none();
        item
    }
}

/// The records and events of a recording.
pub struct Messages(pub(super) Items);

impl Messages {
    /// As [`Items::cut`].
    pub fn cut(&self) -> Option<&str> {
        self.0.cut()
    }

    /// As [`Items::bytes_read`].
    pub const fn bytes_read(&self) -> u64 {
        self.0.bytes_read()
    }
}

impl Iterator for Messages {
    type Item = FlightMessage;

    fn next(&mut self) -> Option<FlightMessage> {
        self.0.find_map(|item| match item {
            Item::Message(message) => Some(message),
            Item::Remark(_) => None,
        })
    }
}

/// Which channels of a file carry what.
#[derive(Default)]
pub(super) struct Channels {
    record: Option<u16>,
    event: Option<u16>,
    log: Option<u16>,
}

impl Channels {
    /// What a record of MCAP holds, if it is something of ours.
    pub(super) fn item(
        &mut self,
        record: &Record<'_>,
        clock_offset_ns: i64,
    ) -> Option<Result<Item, String>> {
        match record {
            Record::Channel(channel) if channel.message_encoding == schema::ENCODING => {
                for (topic, id) in [
                    (Topic::Record, &mut self.record),
                    (Topic::Event, &mut self.event),
                    (Topic::Log, &mut self.log),
                ] {
                    if channel.topic == topic.name() {
                        *id = Some(channel.id);
                    }
                }
                None
            }
            Record::Message { header, data } => {
                let id = Some(header.channel_id);
                if id == self.record {
                    Some(decode_record(data).map(Item::Message))
                } else if id == self.event {
                    Some(decode_event(data).map(Item::Message))
                } else if id == self.log {
                    remark(header, data, clock_offset_ns).map(|remark| Ok(Item::Remark(remark)))
                } else {
                    None
                }
            }
            _ => None,
        }
    }
}

fn decode_record(data: &[u8]) -> Result<FlightMessage, String> {
    decode(data)
        .map(Message::Tick)
        .map_err(|error| refused("a record", error))
}

fn decode_event(data: &[u8]) -> Result<FlightMessage, String> {
    decode(data)
        .map(Message::Event)
        .map_err(|error| refused("an event", error))
}

fn refused(what: &str, error: DecodeError) -> String {
    match error {
        DecodeError::Unknown(unknown) => format!("{what} cannot be understood: {unknown}"),
        damaged => format!("{what} is damaged: {damaged}"),
    }
}

/// The remark in a line of the log; none where it tells of an event, which is
/// there beside it. Words are no part of a flight: damage to them ends nothing.
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

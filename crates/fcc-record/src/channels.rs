//! Which channel of a file carries which topic.

use std::collections::BTreeMap;

use fcc_core::framework::Time;
use mcap::records::{Channel, MessageHeader, Record};
use prost::Message as _;

use super::foxglove::REMARK;
use super::item::{Item, RecordedMessage};
use super::remark::Remark;
use super::schema::{self, Topic};
use super::wire;
use fcc_telemetry::schema::protobuf::DecodeError;

/// The topics of a file, by the number of the channel. A number that is not
/// declared is the recorder's: the chunk that declares it may be damaged. If a
/// declaration is not as the recorder's, another program has numbered them all.
#[derive(Default)]
pub(super) struct Channels {
    declared: BTreeMap<u16, Option<Topic>>,
    are_renumbered: bool,
}

impl Channels {
    /// Takes a declaration.
    pub(super) fn declare(&mut self, channel: &Channel) {
        let topic = Topic::ALL.into_iter().find(|topic| {
            topic.name() == channel.topic && channel.message_encoding == schema::ENCODING
        });
        self.are_renumbered |= topic != Topic::of_channel(channel.id);
        self.declared.insert(channel.id, topic);
    }

    pub(super) fn is_declared(&self, id: u16) -> bool {
        self.declared.contains_key(&id)
    }

    pub(super) const fn are_renumbered(&self) -> bool {
        self.are_renumbered
    }

    /// A channel that carries a topic.
    pub(super) fn of_topic(&self, topic: Topic) -> Option<u16> {
        let mut declared = self.declared.iter();
        let declared = declared.find_map(|(id, of)| (*of == Some(topic)).then_some(*id));
        declared.or_else(|| (!self.are_renumbered).then(|| topic.channel()))
    }

    /// The message of an own topic in a record. Takes declarations.
    pub(super) fn message<'a>(
        &mut self,
        record: &'a Record<'_>,
    ) -> Option<(Topic, MessageHeader, &'a [u8])> {
        match record {
            Record::Channel(channel) => {
                self.declare(channel);
                None
            }
            Record::Message { header, data } => {
                let topic = match self.declared.get(&header.channel_id) {
                    Some(declared) => *declared,
                    None if self.are_renumbered => None,
                    None => Topic::of_channel(header.channel_id),
                };
                Some((topic?, *header, data))
            }
            _ => None,
        }
    }

    /// The item in a record. Takes declarations.
    pub(super) fn item<M: RecordedMessage>(
        &mut self,
        record: &Record<'_>,
        clock_offset_ns: i64,
    ) -> Option<Result<Item<M>, String>> {
        let (topic, header, data) = self.message(record)?;
        item(topic, &header, data, clock_offset_ns)
    }
}

/// The item in a message, if there is one.
pub(super) fn item<M: RecordedMessage>(
    topic: Topic,
    header: &MessageHeader,
    data: &[u8],
    clock_offset_ns: i64,
) -> Option<Result<Item<M>, String>> {
    let (what, read) = match topic {
        Topic::Record => ("a record", M::record(data)),
        Topic::Event => ("an event", M::event(data)),
        Topic::Log => return Some(Ok(Item::Remark(remark(header, data, clock_offset_ns)?))),
    };
    Some(read.map(Item::Message).map_err(|error| match error {
        DecodeError::Unknown(unknown) => format!("{what} cannot be decoded: {unknown}"),
        damaged => format!("{what} is damaged: {damaged}"),
    }))
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

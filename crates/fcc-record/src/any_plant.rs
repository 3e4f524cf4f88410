//! The messages of any plant: what every loop records is decoded, and what only
//! some do is left as bytes.

use fcc_core::framework::schema::{Field, Schema, Sink, Source, Type, Unknown};
use fcc_core::framework::{Event, Message, Record, Tick};
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::schema::protobuf::{DecodeError, decode};
use prost::Message as _;

use super::item::RecordedMessage;

/// What is not read.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Unread;

impl Schema for Unread {
    const TYPE: Type = <()>::TYPE;

    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W) {
        ().write(field, sink);
    }

    fn read<R: Source>(&mut self, _: &'static Field, _: &mut R) -> Result<(), Unknown> {
        Ok(())
    }
}

/// The ticks, states and events of a loop, whatever its plant.
pub(super) type AnyMessage = Message<Unread, Unread, Unread, Unread, Unread>;

/// A message of any plant's recording.
#[derive(Clone, PartialEq, Debug)]
pub enum AnyPlantMessage {
    /// A record: the part that every loop has, and all of it, encoded; see
    /// [`RowDecoder`](fcc_telemetry::schema::protobuf::RowDecoder).
    Record(Record<Unread, Unread, Unread, Unread>, Vec<u8>),
    /// An event, and its text.
    Event(Event<Unread>, String),
}

impl RecordedMessage for AnyPlantMessage {
    fn record(bytes: &[u8]) -> Result<Self, DecodeError> {
        Ok(Self::Record(decode(bytes)?, bytes.to_vec()))
    }

    fn event(bytes: &[u8]) -> Result<Self, DecodeError> {
        /// The text of an event; its number is that of
        /// [`TEXT`](super::schema::TEXT).
        #[derive(prost::Message)]
        struct Described {
            #[prost(string, tag = "3")]
            text: String,
        }
        let described = Described::decode(bytes).map_err(|_| DecodeError::Damaged)?;
        Ok(Self::Event(decode(bytes)?, described.text))
    }

    fn tick(&self) -> Option<&Tick> {
        match self {
            Self::Record(record, _) => Some(&record.tick),
            Self::Event(..) => None,
        }
    }

    fn columns() -> Option<RecordDescription> {
        None
    }
}

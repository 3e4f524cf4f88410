//! One item of a recording.

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Message, Record, Tick};

use super::damage::Damage;
use super::document::Document;
use super::remark::Remark;
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
    /// A text that came during the flight, or did before the file was begun:
    /// these come first.
    Document(Document),
    /// Damage; the items that were here are missing.
    Damage(Damage),
}

//! The topics of a recording and their schemas.

use std::borrow::Cow;

use fcc_core::framework::schema::Schema as _;

use fcc_telemetry::schema::protobuf::{Extra, File, append_text, describe, encode};
use fcc_telemetry::{FlightEvent, FlightRecord};

/// What says in a file that it is one of ours, in this format.
pub(super) const PROFILE: &str = "fcc.v2";

/// What the first format was known by: records were laid out another way.
pub(super) const FIRST_PROFILE: &str = "fcc";

/// How messages and their schemas are encoded.
pub(super) const ENCODING: &str = "protobuf";

/// What the messages of a loop are called together.
pub const PACKAGE: &str = "fcc.v2";

/// An event in words, in its message.
pub(super) const TEXT: Extra = Extra {
    structure: "Event",
    name: "text",
    number: 3,
    meaning: "What happened, in words for people.",
};

/// Appends an event and its words for people as a message.
pub(super) fn encode_event(event: &FlightEvent, text: &str, into: &mut Vec<u8>) {
    encode(event, into);
    append_text(TEXT.number, text, into);
}

/// The topics of a recording.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Topic {
    Record,
    Event,
    Position,
    Attitude,
    Log,
}

macro_rules! descriptors {
    ($name:literal) => {
        include_bytes!(concat!(env!("OUT_DIR"), "/", $name, ".fds"))
    };
}

impl Topic {
    pub(super) const ALL: [Self; 5] = [
        Self::Record,
        Self::Event,
        Self::Position,
        Self::Attitude,
        Self::Log,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Record => "/fcc/record",
            Self::Event => "/fcc/event",
            Self::Position => "/fcc/position",
            Self::Attitude => "/fcc/attitude",
            Self::Log => "/fcc/log",
        }
    }

    /// The full name of the message's type.
    pub(super) const fn schema(self) -> &'static str {
        match self {
            Self::Record => "fcc.v2.Record",
            Self::Event => "fcc.v2.Event",
            Self::Position => "foxglove.LocationFix",
            Self::Attitude => "foxglove.FrameTransform",
            Self::Log => "foxglove.Log",
        }
    }

    /// The type and all it is made of, as a `FileDescriptorSet`.
    pub(super) fn descriptors(self) -> Cow<'static, [u8]> {
        let described = match self {
            Self::Record | Self::Event => {
                return describe(&messages(), "fcc/v2/flight.proto", PACKAGE).into();
            }
            Self::Position => descriptors!("location_fix").as_slice(),
            Self::Attitude => descriptors!("frame_transform"),
            Self::Log => descriptors!("log"),
        };
        described.into()
    }
}

/// The messages of a flight: its records and events.
pub fn messages() -> File {
    File::of(&[FlightRecord::TYPE, FlightEvent::TYPE], &[TEXT])
}

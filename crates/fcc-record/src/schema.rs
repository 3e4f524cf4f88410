//! The topics of a recording and their schemas.

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Event, EventOf, RecordOf};

use crate::recorded::{Recorded, TopicOf, Views};
use fcc_telemetry::schema::protobuf::{Extra, File, append_text, describe, encode};

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
pub(super) fn encode_event<O: Schema>(event: &Event<O>, text: &str, into: &mut Vec<u8>) {
    encode(event, into);
    append_text(TEXT.number, text, into);
}

/// The topics of every recording; what its plant adds comes after them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Topic {
    Record,
    Event,
    Log,
}

/// How many they are.
pub(super) const OWN_TOPICS: usize = 3;

impl Topic {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Record => "/fcc/record",
            Self::Event => "/fcc/event",
            Self::Log => "/fcc/log",
        }
    }
}

/// All topics of a recording.
pub(super) fn topics<C: Recorded>() -> Vec<TopicOf> {
    let described = describe(&messages::<C>(), "fcc/v2/loop.proto", PACKAGE);
    let log = include_bytes!(concat!(env!("OUT_DIR"), "/log.fds"));
    let record = format!("{PACKAGE}.Record");
    let own = [
        (Topic::Record.name(), record, described.clone().into()),
        (
            Topic::Event.name(),
            format!("{PACKAGE}.Event"),
            described.into(),
        ),
        (Topic::Log.name(), "foxglove.Log".to_owned(), log.into()),
    ];
    let more = C::Views::TOPICS.iter();
    let more = more.map(|(name, of, described)| (*name, (*of).to_owned(), (*described).into()));
    own.into_iter().chain(more).collect()
}

/// The messages of a loop: its records and events.
pub fn messages<C: Recorded>() -> File {
    File::of(&[RecordOf::<C>::TYPE, EventOf::<C>::TYPE], &[TEXT])
}

//! The topics of a recording and their schemas.

use std::borrow::Cow;
#[cfg(feature = "flight")]
use std::sync::LazyLock;

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Event, EventOf, RecordOf};

use crate::recorded::{Recorded, TopicOf, Views};
use fcc_telemetry::schema::protobuf::{Extra, File, append_text, describe, encode};

/// Identifies a file as a recording in this format.
pub(super) const PROFILE: &str = "fcc.v2";

/// Identifies the first format, which had other messages.
pub(super) const FIRST_PROFILE: &str = "fcc";

/// How messages and their schemas are encoded.
pub(super) const ENCODING: &str = "protobuf";

/// The package of a loop's messages.
pub const PACKAGE: &str = "fcc.v2";

/// The text of an event, in its message.
pub(super) const TEXT: Extra = Extra {
    structure: "Event",
    name: "text",
    number: 3,
    meaning: "What happened, as text.",
};

/// Appends an event with its text for users as a message.
pub(super) fn encode_event<O: Schema>(event: &Event<O>, text: &str, into: &mut Vec<u8>) {
    encode(event, into);
    append_text(TEXT.number, text, into);
}

/// The topics of every recording; those of its plant follow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Topic {
    Record,
    Event,
    Log,
}

/// Their number.
pub(super) const OWN_TOPICS: usize = 3;

impl Topic {
    pub(super) const ALL: [Self; OWN_TOPICS] = [Self::Record, Self::Event, Self::Log];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Record => "/fcc/record",
            Self::Event => "/fcc/event",
            Self::Log => "/fcc/log",
        }
    }

    /// The number that the recorder gives its channel.
    pub(super) const fn channel(self) -> u16 {
        self as u16 + 1
    }

    /// The topic to whose channel the recorder gives this number.
    pub(super) fn of_channel(id: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.channel() == id)
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

/// The topic of a channel whose declaration is damaged, by its number and a
/// message of it; only a flight's messages have a known type.
pub(super) fn undeclared(channel: u16, message: &[u8]) -> Option<TopicOf> {
    let own = Topic::of_channel(channel);
    #[cfg(feature = "flight")]
    {
        use fcc_fixed_wing::Autopilot;
        use fcc_telemetry::schema::protobuf::decode;
        let is_flight = match own {
            Some(Topic::Record) => decode::<RecordOf<Autopilot>>(message).is_ok(),
            Some(Topic::Event) => decode::<EventOf<Autopilot>>(message).is_ok(),
            Some(Topic::Log) | None => true,
        };
        if is_flight {
            // Describing them takes longer than to recover a short file.
            static TOPICS: LazyLock<Vec<TopicOf>> = LazyLock::new(topics::<Autopilot>);
            return TOPICS.get(usize::from(channel.checked_sub(1)?)).cloned();
        }
    }
    let _ = message;
    Some((own?.name(), String::new(), Cow::Borrowed(&[])))
}

/// The messages of a loop: its records and events.
pub fn messages<C: Recorded>() -> File {
    File::of(&[RecordOf::<C>::TYPE, EventOf::<C>::TYPE], &[TEXT])
}

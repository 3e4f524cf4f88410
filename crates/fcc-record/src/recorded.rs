//! What a recording contains besides records and events.

use std::borrow::Cow;

use fcc_core::framework::{Controller, RecordOf};
use fcc_telemetry::Telemetry;

/// A controller whose loop can be recorded.
pub trait Recorded: Telemetry {
    /// What its recordings contain besides records and events; `()` for
    /// nothing.
    type Views: Views<Self>;
}

/// What a recording contains besides records and events: messages of well-known
/// types that other programs can display.
pub trait Views<C: Controller + ?Sized>: Default + Send {
    /// For each topic: its name, the type of its messages, and that type's
    /// `FileDescriptorSet`.
    const TOPICS: &'static [(&'static str, &'static str, &'static [u8])];

    /// Takes the next record; `unix_ns` is its wall-clock time.
    fn take(&mut self, record: &RecordOf<C>, unix_ns: u64);

    /// Appends the message of a topic for that record; false if there is none.
    fn append(&mut self, topic: usize, into: &mut Vec<u8>) -> bool;
}

/// Nothing besides records and events.
impl<C: Controller> Views<C> for () {
    const TOPICS: &'static [(&'static str, &'static str, &'static [u8])] = &[];

    fn take(&mut self, _: &RecordOf<C>, _: u64) {}

    fn append(&mut self, _: usize, _: &mut Vec<u8>) -> bool {
        false
    }
}

/// A topic's name, the type of its messages, and that type's description.
pub type TopicOf = (&'static str, String, Cow<'static, [u8]>);

//! What is published.

use fcc_core::framework::RecordOf;
use fcc_telemetry::Telemetry;

use super::{Event, Info, Status};

/// What is published: plain data of a fixed size.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "a flight's record is larger")]
pub(super) enum Item<C: Telemetry> {
    /// A tick.
    Record(RecordOf<C>),
    /// An event.
    Event(Event),
    /// The publishing daemon; again if it changes.
    Info(Info),
    /// The status, without what only the publishing thread knows.
    Status(Status),
}

//! The input of the publishing thread.

use fcc_core::framework::RecordOf;
use fcc_telemetry::Telemetry;

use super::{Event, Info, RecorderStatus};

/// Input of the publishing thread: data of a fixed size.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are records, and the ring's slots have their size"
)]
pub(super) enum Item<C: Telemetry> {
    /// A tick.
    Record(RecordOf<C>),
    /// An event.
    Event(Event),
    /// The publishing daemon; again if it changes.
    Info(Info),
    /// The state of recording.
    Recorder(RecorderStatus),
}

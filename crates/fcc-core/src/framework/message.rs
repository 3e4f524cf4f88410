//! What a loop tells of itself.

use super::{Controller, Event, Record};

/// What a loop tells of itself: `M`, `E`, `S` and `O` are its measurements,
/// estimate, set points and outputs, `R` what may be ordered of its controller.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Message<M, E, S, O, R> {
    /// One tick, whole.
    Tick(Record<M, E, S, O>),
    /// Something that happened. It comes before the record of its tick.
    Event(Event<R>),
}

/// What a controller's loop tells of itself.
pub type MessageOf<C> = Message<
    <C as Controller>::Measurements,
    <C as Controller>::Estimate,
    <C as Controller>::Setpoints,
    <C as Controller>::Outputs,
    <C as Controller>::Command,
>;

//! The messages that a loop sends.

use super::{Controller, Event, Record};

/// A message from a loop: `M`, `E`, `S` and `O` are its measurements, estimate,
/// set points and outputs, `R` a command to its controller.
///
/// ```
/// use fcc_core::framework::{Message, Record, State, Tick};
///
/// // For a plant with one measurement and one output.
/// let record = Record::<f64, (), f64, f64>::new(Tick::default(), State::Standby);
/// let message = Message::<f64, (), f64, f64, ()>::Tick(record);
/// assert!(matches!(message, Message::Tick(record) if record.state == State::Standby));
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Message<M, E, S, O, R> {
    /// The record of one tick.
    Tick(Record<M, E, S, O>),
    /// Something that happened. It comes before the record of its tick.
    Event(Event<R>),
}

/// The message type of a controller's loop.
///
/// ```
/// # mod heating {
/// #     include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/heating.rs"));
/// # }
/// # use heating::Heating;
/// use fcc_core::framework::{MessageOf, RecordOf, State, Tick};
///
/// let record = RecordOf::<Heating>::new(Tick::default(), State::Engaged);
/// let message: MessageOf<Heating> = MessageOf::<Heating>::Tick(record);
/// assert_eq!(message, MessageOf::<Heating>::Tick(record));
/// ```
pub type MessageOf<C> = Message<
    <C as Controller>::Measurements,
    <C as Controller>::Estimate,
    <C as Controller>::Setpoints,
    <C as Controller>::Outputs,
    <C as Controller>::Command,
>;

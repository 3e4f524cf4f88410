//! What a loop tells of itself.

use super::{Controller, Event, Record};

/// What a loop tells of itself: `M`, `E`, `S` and `O` are its measurements,
/// estimate, set points and outputs, `R` what may be ordered of its controller.
///
/// ```
/// use fcc_core::framework::{Message, Record, State, Tick};
///
/// // Of a plant with one measurement and one output.
/// let record = Record::<f64, (), f64, f64>::new(Tick::default(), State::Standby);
/// let message = Message::<f64, (), f64, f64, ()>::Tick(record);
/// assert!(matches!(message, Message::Tick(record) if record.state == State::Standby));
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Message<M, E, S, O, R> {
    /// One tick, whole.
    Tick(Record<M, E, S, O>),
    /// Something that happened. It comes before the record of its tick.
    Event(Event<R>),
}

/// What a controller's loop tells of itself.
///
/// ```
/// # use fcc_core::framework::{Controller, Flags, Tick};
/// # struct Heating;
/// # impl Controller for Heating {
/// #     type Measurements = f64;
/// #     type Estimate = ();
/// #     type Setpoints = f64;
/// #     type Outputs = f64;
/// #     type Command = f64;
/// #     fn estimate(&mut self, _: &Tick, _: &f64) {}
/// #     fn engage_inhibits(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn faults(&self, _: &Tick, _: &f64) -> Flags { Flags::NONE }
/// #     fn flag_name(_: u32) -> &'static str { "the door is open" }
/// #     fn engage(&mut self, _: &Tick, _: &f64) {}
/// #     fn control(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn failsafe(&mut self, _: &Tick, _: &f64) -> f64 { 0.0 }
/// #     fn setpoints(&self) -> f64 { 21.0 }
/// #     fn outputs_are_valid(&self, _: &f64) -> bool { true }
/// # }
/// use fcc_core::framework::{MessageOf, RecordOf, State};
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

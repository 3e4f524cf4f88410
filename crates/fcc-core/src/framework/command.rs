//! What may be asked of a loop from outside.

/// What may be asked of a loop from outside; `O` is what may be asked of its
/// controller. Commands are carried out in the sequence they were sent in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LoopCommand<O> {
    /// Take over, if nothing blocks it: one attempt, answered by a change of
    /// state or by [`EngageRefused`](super::EventKind::EngageRefused).
    Engage,
    /// Let go.
    Disengage,
    /// Let go and end the loop.
    Stop,
    /// For the controller.
    Controller(O),
}

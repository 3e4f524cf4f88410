//! What may be asked of a loop from outside.

use crate::schema;

schema! {
    /// What may be asked of a loop from outside; `O` is what may be asked of its
    /// controller. Commands are carried out in the sequence they were sent in.
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    pub enum LoopCommand<O> {
        /// Take over, if nothing blocks it: one attempt, answered by a change of
        /// state or by `EngageRefused`.
        #[field(1)]
        Engage,
        /// Let go.
        #[field(2)]
        Disengage,
        /// Let go and end the loop.
        #[field(3)]
        Stop,
        /// For the controller.
        #[field(4)]
        Controller(command: O),
    }
}

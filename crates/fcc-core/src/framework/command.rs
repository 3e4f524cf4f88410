//! What may be asked of a loop from outside.

use crate::schema;

schema! {
    /// What may be asked of a loop from outside; `O` is what may be asked of its
    /// controller. Commands are carried out in the sequence they were sent in.
    ///
    /// ```
    /// use fcc_core::framework::LoopCommand;
    ///
    /// // For a thermostat, whose only command is a temperature.
    /// let commands = [LoopCommand::Engage, LoopCommand::Controller(21.0)];
    /// assert_eq!(commands[1], LoopCommand::Controller(21.0));
    /// ```
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

//! Commands to a loop from outside.

use crate::schema;

schema! {
    /// A command to a loop from outside; `O` is a command to its controller.
    /// Commands are executed in the order in which they were sent.
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
        /// Engage, if no engage inhibit is active: one attempt, answered by a
        /// change of state or by `EngageRefused`.
        #[field(1)]
        Engage,
        /// Disengage.
        #[field(2)]
        Disengage,
        /// Release control and end the loop.
        #[field(3)]
        Stop,
        /// A command to the controller.
        #[field(4)]
        Controller(command: O),
    }
}

//! Commands to a loop from outside its program, by the names of set points: what
//! is permitted, and what became of each.

mod commandable;
mod invalid_command;
mod outside_limits;
mod sent_commands;

use serde::{Deserialize, Serialize};

pub use commandable::{Commandable, CommandableSetpoint, PlantLimits};
pub use invalid_command::InvalidCommand;
pub use outside_limits::OutsideLimits;
pub use sent_commands::SentCommands;

/// A command to a loop of any plant from another program.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Command {
    /// Take control with the present state as set points, if nothing inhibits
    /// it.
    Engage,
    /// Release the controls.
    Disengage,
    /// Release the controls and end the program.
    Stop,
    /// Change these set points, by the names of [`Commandable::SETPOINTS`]; the
    /// others keep their value. Ends an aircraft's pattern.
    Set(Vec<(String, f64)>),
    /// Fly another plan. Who flies reads and checks its file, and sends it to the loop
    /// as [`SentCommands::send_prepared`].
    ReplacePlan {
        /// The file, with its whole path.
        file: String,
        /// The item that is flown first, from 1.
        item: u16,
    },
}

impl Command {
    /// Changes these set points.
    ///
    /// ```
    /// use fcc_telemetry::Command;
    ///
    /// let command = Command::set([("heading_rad", 1.57)]);
    /// assert_eq!(command, Command::Set(vec![("heading_rad".to_owned(), 1.57)]));
    /// ```
    pub fn set<'a>(setpoints: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let setpoints = setpoints.into_iter();
        Self::Set(
            setpoints
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
        )
    }
}

/// A command from another program that waits for its answer.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct PendingCommand {
    /// Its identifier, by which it is answered.
    pub id: u64,
    /// Who sent it, in words.
    pub sender: String,
    /// The command.
    pub command: Command,
}

/// The result of a command.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Verdict {
    /// It was carried out in this tick.
    CarriedOut {
        /// The tick that read it.
        tick: u64,
    },
    /// It was refused, for this reason.
    Refused(String),
    /// It was refused because a set point is out of its limits.
    Outside(OutsideLimits),
}

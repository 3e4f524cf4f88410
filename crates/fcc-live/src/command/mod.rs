//! Commands to a daemon from another program on the machine.
//!
//! ```text
//! Commander ─► service ─► fcc-live ─► ring ─► who flies ─► the loop's ring
//!    ▲         request     looks             sends, and sees in what the loop
//!    └──────── response ◄─ answers ◄─ ring ◄ tells what became of the command
//! ```
//!
//! The loop's thread only reads its ring of commands, as it always does. The
//! sender learns the result and the tick that read the command. Only the
//! daemon's own user can open the service: iceoryx2 creates its files for their
//! owner alone.

mod command_server;
mod commandable;
mod commander;
mod error;
mod outside_limits;
mod sent_commands;
mod wire;

use serde::{Deserialize, Serialize};

pub(super) use command_server::{CommandServer, Ends, Rings};
pub use commandable::{Commandable, CommandableSetpoint, PlantLimits};
pub use commander::Commander;
pub use error::{CommandError, InvalidCommand};
pub use outside_limits::OutsideLimits;
pub use sent_commands::SentCommands;
pub(crate) use wire::{Answer, CommandRequest};
#[cfg(fuzzing)]
pub use wire::{read_answer, read_request};

/// The version of commands and answers, independent of the layouts'. Increase
/// it, and the version in the types' names, with every change of one of them or
/// of its meaning.
pub const COMMANDS_VERSION: u32 = 2;

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
}

impl Command {
    /// Changes these set points.
    ///
    /// ```
    /// use fcc_live::Command;
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
    /// Its identifier, for [`PublisherOf::answer`](super::PublisherOf::answer).
    pub id: u64,
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

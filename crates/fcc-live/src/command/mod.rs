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
mod commander;
mod error;
mod wire;

pub(super) use command_server::{CommandServer, Ends, Rings};
pub use commander::Commander;
pub use error::CommandError;
pub use fcc_telemetry::{
    Command, Commandable, CommandableSetpoint, InvalidCommand, OutsideLimits, PendingCommand,
    PlantLimits, SentCommands, Verdict,
};
pub(crate) use wire::{Answer, CommandRequest};
#[cfg(fuzzing)]
pub use wire::{read_answer, read_request};

/// The version of commands and answers, independent of the layouts'. Increase
/// it, and the version in the types' names, with every change of one of them or
/// of its meaning.
pub const COMMANDS_VERSION: u32 = 5;

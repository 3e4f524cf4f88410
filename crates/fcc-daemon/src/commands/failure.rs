//! A command that gives no result.

use std::fmt::Display;

use fcc_flight::config::ConfigError;
use fcc_record::OpenError;
use fcc_replay::ChainError;
use serde::Serialize;

use crate::exit::Exit;
use crate::output;

/// Why a command gives no result, and its exit code.
pub(super) struct Failure {
    exit: Exit,
    message: String,
}

impl Failure {
    /// Something failed.
    pub(super) fn new(message: impl Display) -> Self {
        Self::of(Exit::Failure, message)
    }

    /// Something failed, with an exit code of its own.
    pub(super) fn of(exit: Exit, message: impl Display) -> Self {
        let message = format!("fccd: {message}");
        Self { exit, message }
    }

    /// The command line is wrong, with the message of its parser.
    pub(super) fn usage(message: impl Display) -> Self {
        Self {
            exit: Exit::Usage,
            message: message.to_string(),
        }
    }

    /// Prints the message, and with `--json` also an object with the key
    /// `error` on standard output.
    pub(super) fn print(self, json: bool) -> Exit {
        #[derive(Serialize)]
        struct Printed<'a> {
            error: &'a str,
        }
        output::message(self.message.trim_end());
        if json {
            let error = self.message.trim().trim_start_matches("fccd: ");
            return output::json(&Printed { error }, self.exit);
        }
        self.exit
    }
}

impl From<OpenError> for Failure {
    fn from(error: OpenError) -> Self {
        let exit = match error {
            OpenError::CutInDescription { .. } => Exit::Incomplete,
            _ => Exit::Usage,
        };
        Self::of(exit, error)
    }
}

impl From<ConfigError> for Failure {
    /// Each problem begins with the file's name.
    fn from(error: ConfigError) -> Self {
        Self::usage(error)
    }
}

/// Why files are no recording that can be replayed.
pub(super) fn not_opened(error: ChainError) -> Failure {
    let exit = match error {
        ChainError::Open(OpenError::CutInDescription { .. }) => Exit::NotReplayed,
        ChainError::Open(error) => return error.into(),
        _ => Exit::NotReplayed,
    };
    Failure::of(exit, error)
}

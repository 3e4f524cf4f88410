//! Exit codes: those of `fccd`.

use std::process::ExitCode;

/// How the program ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Exit {
    /// Success.
    Success = 0,
    /// The operating system or the network failed.
    Failure = 1,
    /// The command line or a configuration is wrong.
    Usage = 2,
    /// Another program uses the port.
    Taken = 12,
}

/// The exit codes, for `--help`.
pub(crate) const EXIT_CODES: &str = "Exit codes:\n  0  success\n  1  the operating system or the \
    network failed\n  2  the command line or a configuration is wrong\n 12  another program uses \
    the port";

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

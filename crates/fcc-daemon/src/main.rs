//! `fccd`: the flight control computer's daemon.

use std::process::ExitCode;

fn main() -> ExitCode {
    fcc_daemon::commands::run().into()
}

//! `fccd`: the flight control computer's daemon.

use std::process::ExitCode;

use clap::Parser;
use fcc_daemon::cli::Cli;

fn main() -> ExitCode {
    fcc_daemon::commands::run(Cli::parse()).into()
}

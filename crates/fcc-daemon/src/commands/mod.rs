//! What the commands do: each prints its result on standard output, speaks to
//! people on standard error, and ends with a code that means something.

mod check;
mod doctor;
mod fly;
mod guard;
mod list;
#[cfg(feature = "live")]
mod order;
mod progress;
mod recover;
mod replay;
mod report;
mod run;
mod timing;
#[cfg(feature = "live")]
mod top;

use std::path::Path;
use std::{fs, io};

use clap::CommandFactory;
use serde::Serialize;

use crate::cli::{Cli, Command};
use crate::exit::Exit;

/// Carries out a command.
pub fn run(cli: Cli) -> Exit {
    match cli.command {
        Command::Fly(args) => fly::fly(&args),
        Command::Run(args) => run::run(&args),
        Command::List(args) => list::list(&args),
        Command::Recover(args) => recover::recover(&args),
        Command::Timing(args) => timing::timing(&args),
        Command::Replay(args) => replay::replay(&args),
        #[cfg(feature = "live")]
        Command::Order(args) => order::order(&args),
        #[cfg(feature = "live")]
        Command::Top(args) => top::top(&args),
        Command::Check(args) => check::check(&args),
        Command::Doctor(args) => doctor::doctor(&args),
        Command::Report(args) => report::report(&args),
        Command::Guard => guard::guard(),
        Command::Completions { shell } => {
            clap_complete::generate(shell, &mut Cli::command(), "fccd", &mut io::stdout());
            Exit::Success
        }
        Command::Man { folder } => man(&folder),
    }
}

/// Writes a manual page for the program and for each command.
fn man(folder: &Path) -> Exit {
    let written =
        fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(Cli::command(), folder));
    match written {
        Ok(()) => Exit::Success,
        Err(error) => fail(&format!("{}: {error}", folder.display())),
    }
}

/// Prints a result for other tools to read.
fn print_json<T: Serialize>(value: &T) -> Exit {
    let mut out = io::stdout().lock();
    let printed = serde_json::to_writer_pretty(&mut out, value)
        .map_err(io::Error::from)
        .and_then(|()| io::Write::write_all(&mut out, b"\n"));
    match printed {
        Ok(()) => Exit::Success,
        Err(error) => fail(&format!("the result could not be printed: {error}")),
    }
}

/// Says what went wrong.
fn fail(message: &str) -> Exit {
    eprintln!("fccd: {message}");
    Exit::Failure
}

//! The commands: each prints its result on standard output and messages on
//! standard error, and returns an exit code.

mod check;
#[cfg(feature = "live")]
mod command;
mod doctor;
mod failure;
mod fly;
mod list;
mod outcome;
mod progress;
#[cfg(feature = "live")]
mod publisher;
mod recover;
mod release_helper;
mod replay;
mod report;
mod run;
mod timing;
#[cfg(feature = "live")]
mod top;
mod x_plane;

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use clap::{CommandFactory, Parser};
use clap_complete::Shell;

use failure::Failure;

use crate::cli::{Action, Cli};
use crate::exit::Exit;
use crate::output;
use crate::process::survive_file_size_limit;

/// Runs the command of the command line.
pub fn run() -> Exit {
    let json = std::env::args_os().any(|argument| argument == "--json");
    if let Err(error) = survive_file_size_limit() {
        output::message(format_args!("fccd: SIGXFSZ cannot be caught: {error}"));
    }
    match Cli::try_parse() {
        Ok(cli) => carry_out(cli.command).unwrap_or_else(|failure| failure.print(json)),
        Err(error) if error.use_stderr() => Failure::usage(error.render()).print(json),
        Err(help) => match help.print() {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Failure::new(format_args!("the help could not be printed: {error}")).print(false)
            }
            _ => Exit::Success,
        },
    }
}

fn carry_out(command: Action) -> Result<Exit, Failure> {
    Ok(match command {
        Action::Fly(args) => fly::fly(&args)?,
        Action::Run(args) => run::run(&args)?,
        Action::List(args) => list::list(&args)?,
        Action::Recover(args) => recover::recover(&args)?,
        Action::Timing(args) => timing::timing(&args)?,
        Action::Replay(args) => replay::replay(&args)?,
        #[cfg(feature = "live")]
        Action::Command(args) => command::command(&args)?,
        #[cfg(feature = "live")]
        Action::Top(args) => top::top(&args)?,
        Action::Check(args) => check::check(&args),
        Action::Doctor(args) => doctor::doctor(&args)?,
        Action::XPlane(args) => x_plane::x_plane(&args)?,
        Action::Report(args) => report::report(&args)?,
        #[cfg(feature = "live")]
        Action::Publisher => publisher::publisher()?,
        Action::ReleaseHelper => release_helper::release_helper()?,
        Action::Completions { shell } => completions(shell),
        Action::Man { folder } => man(&folder)?,
    })
}

fn completions(shell: Shell) -> Exit {
    // If it cannot write, `generate` panics.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "fccd", &mut script);
    output::bytes(&script, Exit::Success)
}

/// Writes manual pages for the program and each command.
fn man(folder: &Path) -> Result<Exit, Failure> {
    fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), folder))
        .map_err(|error| Failure::new(format_args!("{}: {error}", folder.display())))?;
    Ok(Exit::Success)
}

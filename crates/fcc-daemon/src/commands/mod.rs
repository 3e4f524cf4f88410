//! The commands: each prints its result on standard output and messages on
//! standard error, and returns an exit code.

mod airframe;
mod answers;
mod calibrate;
mod check;
mod check_controls;
#[cfg(feature = "live")]
mod command;
mod doctor;
mod failure;
mod fly;
mod ground;
mod list;
#[cfg(feature = "live")]
mod live_vehicles;
mod lookup;
mod outcome;
mod plan;
mod plan_picture;
mod probe;
mod progress;
#[cfg(feature = "live")]
mod publisher;
mod recover;
mod release_helper;
mod replay;
mod replay_navigation;
mod report;
mod run;
mod timing;
#[cfg(feature = "live")]
mod top;
mod vehicles;
mod x_plane;

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory, Parser};
use clap_complete::Shell;
use fcc_flight::flight::Pace;
use fcc_record::create_folder;

use failure::Failure;
use vehicles::Kind;

use crate::cli::{Action, Cli};
use crate::exit::Exit;
use crate::output;
use crate::process::{raise_stack_limit, survive_file_size_limit};

/// Runs the command of the command line.
pub fn run() -> Exit {
    let json = std::env::args_os().any(|argument| argument == "--json");
    if let Err(why) = raise_stack_limit() {
        return Failure::new(why).print(json);
    }
    if let Err(error) = survive_file_size_limit() {
        output::message(format_args!("fccd: SIGXFSZ cannot be caught: {error}"));
    }
    match Cli::try_parse() {
        Ok(cli) => complete(cli.command, json),
        Err(error) if error.use_stderr() => Failure::usage(plain(error).render()).print(json),
        Err(help_or_version) => output::printed(help_or_version.print(), Exit::Success),
    }
}

/// The parser's error with the usage of the whole command, and not only of the
/// options that were given. No name of a file begins with two hyphens, so that is
/// not proposed.
fn plain(mut error: clap::Error) -> clap::Error {
    let mut command = Cli::command();
    command.build();
    for word in std::env::args_os().skip(1) {
        match command.find_subcommand(&word) {
            Some(of_it) => command = of_it.clone(),
            // The name of an instance or of a user may stand before it.
            None if command.has_subcommands() => {}
            None => break,
        }
    }
    if error.get(ContextKind::Usage).is_some() {
        let usage = ContextValue::StyledStr(command.render_usage());
        error.insert(ContextKind::Usage, usage);
    }
    if error.kind() == ErrorKind::UnknownArgument {
        error.remove(ContextKind::Suggested);
    }
    error
}

/// Carries out a command and prints what came of it.
fn complete(command: Action, json: bool) -> Exit {
    let prepared = match &command {
        Action::Fly(args) => fly::prepare(fly::pace(args)),
        Action::Run(_) | Action::CheckControls(_) => fly::prepare(Pace::RealTime),
        _ => Ok(None),
    };
    // Until the end: a failure is printed, too.
    match prepared {
        Ok(_printer) => carry_out(command).unwrap_or_else(|failure| failure.print(json)),
        Err(failure) => failure.print(json),
    }
}

fn carry_out(command: Action) -> Result<Exit, Failure> {
    Ok(match command {
        Action::Fly(args) => match Kind::of_flight(&args)? {
            Some(kind) => (kind.fly)(&args)?,
            None => fly::fly(&args)?,
        },
        Action::Run(args) => run::run(&args)?,
        Action::List(args) => list::list(&args)?,
        Action::Recover(args) => recover::recover(&args)?,
        Action::Timing(args) => timing::timing(&args)?,
        Action::Replay(args) => {
            match args.files.first().and_then(|file| Kind::of_recording(file)) {
                Some(kind) => (kind.replay)(&args)?,
                None => replay::replay(&args)?,
            }
        }
        #[cfg(feature = "live")]
        Action::Command(args) => command::command(&args)?,
        #[cfg(feature = "live")]
        Action::Top(args) => top::top(&args)?,
        Action::Calibrate(args) => calibrate::calibrate(&args)?,
        Action::Check(args) => check::check(&args),
        Action::CheckControls(args) => check_controls::check_controls(&args)?,
        Action::Airframe(args) => airframe::airframe(&args)?,
        Action::Doctor(args) => doctor::doctor(&args)?,
        Action::Probe(args) => probe::probe(&args)?,
        Action::Plan(args) => plan::plan(&args)?,
        Action::XPlane(args) => x_plane::x_plane(&args)?,
        Action::Report(args) => match Kind::of_recording(&args.file) {
            Some(kind) => (kind.report)(&args)?,
            None => report::report(&args)?,
        },
        Action::Ground(args) => ground::ground(&args)?,
        #[cfg(feature = "live")]
        Action::Publisher { vehicle } => publisher::publisher(vehicle.as_deref())?,
        Action::ReleaseHelper => release_helper::release_helper()?,
        Action::Completions { shell } => completions(shell),
        Action::Schema => output::json(&fcc_flight::config::schema(), Exit::Success),
        Action::Man { folder } => man(&folder)?,
    })
}

/// A command as `--help` shows it: scripts for shells have hidden ones, too.
fn shown(command: &Command) -> Command {
    let arguments = command.get_arguments().filter(|one| !one.is_hide_set());
    let commands = command.get_subcommands().filter(|one| !one.is_hide_set());
    Command::new(command.get_name().to_owned())
        .about(command.get_about().cloned().unwrap_or_default())
        .version(command.get_version().unwrap_or_default().to_owned())
        .disable_version_flag(command.get_version().is_none())
        .args(arguments.cloned())
        .subcommands(commands.map(shown))
}

fn completions(shell: Shell) -> Exit {
    // If it cannot write, `generate` panics.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut shown(&Cli::command()), "fccd", &mut script);
    output::bytes(&script, Exit::Success)
}

/// Writes manual pages for the program and each command.
fn man(folder: &Path) -> Result<Exit, Failure> {
    create_folder(folder)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), folder))
        .map_err(|error| Failure::new(format_args!("{}: {error}", folder.display())))?;
    Ok(Exit::Success)
}

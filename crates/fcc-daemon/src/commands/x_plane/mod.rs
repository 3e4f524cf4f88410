//! `fccd x-plane`: commands for a person with X-Plane.

mod check;
mod identify;
mod steps;
mod terminal;

use std::env;
use std::path::PathBuf;

use fcc_flight::config::{Config, ConfigError};
use fcc_xplane_check::{CheckError, Request};

use super::failure::Failure;
use crate::cli::x_plane::{ConnectionArgs, XPlaneArgs, XPlaneCommand};
use crate::exit::Exit;

/// The configuration if none is given: X-Plane on this machine.
const DEFAULT: &str = "[x-plane]\n";

/// Carries out one of the commands.
pub(super) fn x_plane(args: &XPlaneArgs) -> Result<Exit, Failure> {
    match &args.what {
        XPlaneCommand::Check(args) => check::check(args),
        XPlaneCommand::Steps { json } => Ok(steps::list(*json)),
        XPlaneCommand::Identify(args) => identify::identify(args),
    }
}

/// What the commands begin with, and its configuration.
fn request(connection: &ConnectionArgs, folder: PathBuf) -> Result<(Request, Config), Failure> {
    let program = env::current_exe()
        .map_err(|error| Failure::new(format_args!("its own program cannot be found: {error}")))?;
    let (config, text) = configuration(connection)?;
    let section = config.x_plane.as_ref().ok_or_else(|| {
        Failure::usage(
            "fccd x-plane is for X-Plane: give a file with a section [x-plane], such as \
             config/x-plane.toml",
        )
    })?;
    let request = Request {
        program,
        config: text,
        x_plane: section.into(),
        folder,
        report: Vec::new(),
        only: Vec::new(),
        is_unattended: false,
        is_short: false,
        local_port: connection.local_port,
    };
    Ok((request, config))
}

fn configuration(connection: &ConnectionArgs) -> Result<(Config, String), ConfigError> {
    match &connection.config {
        Some(file) => Config::load_with_text(file),
        None => Ok((Config::parse(DEFAULT, "the default")?, DEFAULT.to_owned())),
    }
}

/// What could not begin: a port that is taken has an exit code of its own.
fn not_begun(error: &CheckError) -> Failure {
    let exit = if error.is_taken() {
        Exit::Taken
    } else {
        Exit::Failure
    };
    Failure::of(exit, error)
}

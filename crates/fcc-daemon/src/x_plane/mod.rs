//! `fccd x-plane`: commands for a person with X-Plane.

mod args;
mod check;
mod identify;
mod steps;
mod terminal;

pub use args::{ConnectionArgs, IdentifyArgs, XPlaneArgs, XPlaneCheckArgs, XPlaneCommand};

use std::env;
use std::path::{Path, PathBuf};

use fcc_flight::config::{Config, XPlaneSection};
use fcc_xplane_check::Request;

use crate::exit::Exit;
use crate::output;

/// The configuration if none is given: X-Plane on this machine.
const DEFAULT: &str = "[x-plane]\n";

/// Carries out one of the commands.
pub(crate) fn x_plane(args: &XPlaneArgs) -> Exit {
    match &args.what {
        XPlaneCommand::Check(args) => check::check(args),
        XPlaneCommand::Steps { json } => steps::list(*json),
        XPlaneCommand::Identify(args) => identify::identify(args),
    }
}

/// What the commands begin with; prints the error.
fn request(connection: &ConnectionArgs, folder: PathBuf) -> Result<Request, Exit> {
    let program = env::current_exe()
        .map_err(|error| fail(&format!("its own program cannot be found: {error}")))?;
    let (section, text) = configuration(connection.config.as_deref()).map_err(|message| {
        output::message(message);
        Exit::Usage
    })?;
    Ok(Request {
        program,
        config: text,
        x_plane: (&section).into(),
        folder,
        only: Vec::new(),
        is_unattended: false,
        is_short: false,
        local_port: connection.local_port,
    })
}

/// Where X-Plane is, and the text of the configuration.
fn configuration(file: Option<&Path>) -> Result<(XPlaneSection, String), String> {
    let (config, text) = if let Some(file) = file {
        Config::load_with_text(file).map_err(|error| error.to_string())?
    } else {
        let config = Config::parse(DEFAULT, "the default").map_err(|error| error.to_string())?;
        (config, DEFAULT.to_owned())
    };
    let section = config.x_plane.ok_or(
        "fccd x-plane is for X-Plane: give a file with a section [x-plane], such as \
         config/x-plane.toml",
    )?;
    Ok((section, text))
}

fn fail(message: &str) -> Exit {
    output::message(format!("fccd: {message}"));
    Exit::Failure
}

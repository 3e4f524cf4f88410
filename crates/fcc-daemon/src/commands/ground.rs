//! `fccd ground`: starts the ground station, a program of its own.

use std::env;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::Command;

use super::failure::Failure;
use crate::cli::GroundArgs;
use crate::exit::Exit;

const PROGRAM: &str = "fcc-ground";

/// Becomes the station: the one beside this program, or else one of PATH.
pub(super) fn ground(args: &GroundArgs) -> Result<Exit, Failure> {
    let own = env::current_exe().ok();
    let beside = own.as_deref().and_then(Path::parent);
    let beside = beside.map(|folder| folder.join(PROGRAM));
    let program = beside.filter(|file| file.is_file());
    let program = program.unwrap_or_else(|| PROGRAM.into());
    let error = Command::new(&program).args(&args.options).exec();
    Err(Failure::new(format_args!(
        "{}: cannot be started: {error}; `make ground` builds it",
        program.display()
    )))
}

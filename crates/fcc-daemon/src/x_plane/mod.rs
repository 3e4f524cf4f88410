//! `fccd x-plane`: commands for a person with X-Plane.

mod args;
mod check;
mod terminal;

pub use args::{XPlaneArgs, XPlaneCheckArgs, XPlaneCommand};

use crate::exit::Exit;

/// Carries out one of the commands.
pub(crate) fn x_plane(args: &XPlaneArgs) -> Exit {
    match &args.what {
        XPlaneCommand::Check(args) => check::check(args),
    }
}

//! Commands of other users.
//!
//! Live telemetry is in a folder of the daemon's user, so only that user and
//! root can command by it. Users and groups of `[rights]` command by a socket in
//! a folder that all can enter; the kernel tells whose the program at its other
//! end is (`SO_PEERCRED`, unix(7)).

mod client;
mod connect;
mod line;
mod panel;
mod server;
mod wire;

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

pub use client::{OtherUserError, command_another_users};
#[cfg(fuzzing)]
pub use line::line_of_parts;
pub(super) use server::CommandSocket;
#[cfg(fuzzing)]
pub use wire::answer_as_received;
pub use wire::command_of;

/// The name of the folder that systemd, or root, makes for the service.
const FOLDER: &str = "fccd-commands";

/// The folder of a daemon's sockets: the service's, or one of this user.
fn own_folder(user: u32) -> PathBuf {
    let given = env::var_os("RUNTIME_DIRECTORY").unwrap_or_default();
    env::split_paths(&given)
        .find(|folder| folder.file_name() == Some(OsStr::new(FOLDER)))
        .unwrap_or_else(|| folder_of(user))
}

/// The folder of a user's daemons that are no service.
fn folder_of(user: u32) -> PathBuf {
    Path::new("/dev/shm").join(format!("{FOLDER}-{user}"))
}

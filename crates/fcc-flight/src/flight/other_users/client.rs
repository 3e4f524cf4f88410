//! Sends a command to a daemon of another user.

use std::fs;
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fcc_live::Command;
use fcc_telemetry::Instance;
use nix::sys::socket::{getsockopt, sockopt::PeerCredentials};
use nix::unistd::User;

use super::connect::connect_within;
use super::line::Line;
use super::wire::{answer_of, line_of};
use super::{FOLDER, folder_of};

/// A stop takes up to 12 s: the plant is prepared for its release first.
const PATIENCE: Duration = Duration::from_secs(15);
/// The kernel accepts a connection at once, unless the daemon's queue is full:
/// that of one that lives is emptied 50 times a second.
const CONNECTED_WITHIN: Duration = Duration::from_secs(5);

/// Why a command to another user's daemon was not carried out.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum OtherUserError {
    /// There is no such user.
    #[error("there is no user {0}")]
    NoUser(String),
    /// None of that name accepts commands of others.
    #[error(
        "no fccd '{0}' accepts commands of other users at {1}: it does not run, or its \
         configuration names nobody in rights.commanders"
    )]
    NotThere(Instance, PathBuf),
    /// The program at the socket is not that user's.
    #[error("{0} does not belong to the user of the daemon behind it: not trusted")]
    Foreign(PathBuf),
    /// It is for the daemon's own user alone.
    #[error(
        "a plan is replaced by the daemon's own user alone, since the daemon reads its file: sudo -u \
         USER fccd command plan replace FILE"
    )]
    OwnUserOnly,
    /// The daemon refused it.
    #[error("refused: {0}")]
    Refused(String),
    /// The daemon is stopped, or hangs, and its queue is full.
    #[error(
        "fccd did not accept the connection within {} s: it is stopped, or hangs; the command was \
         not carried out",
        CONNECTED_WITHIN.as_secs()
    )]
    NotAccepted,
    /// The daemon is stopped, or hangs.
    #[error(
        "fccd did not answer within {} s, so it is not known whether the command was carried out; \
         if it was not, it will not be",
        PATIENCE.as_secs()
    )]
    NoAnswer,
    /// The connection failed.
    #[error(
        "the connection to fccd failed, so it is not known whether the command was carried out: {0}"
    )]
    Io(#[from] io::Error),
}

/// Sends a command to the daemon of this name: that of `user`, or of the
/// service. Returns the tick that carried it out.
///
/// # Errors
/// When there is no such daemon, it refuses the command or does not answer
/// within 15 s.
pub fn command_another_users(
    instance: &Instance,
    user: Option<&str>,
    command: &Command,
) -> Result<u64, OtherUserError> {
    let folder = match user {
        None => Path::new("/run").join(FOLDER),
        Some(name) => {
            let found = number_of(name);
            let user = found.ok_or_else(|| OtherUserError::NoUser(name.to_owned()))?;
            let of_user = folder_of(user);
            // Others could have placed a folder of this name.
            if !is_of(&of_user, user) {
                return Err(OtherUserError::NotThere(instance.clone(), of_user));
            }
            of_user
        }
    };
    let path = folder.join(instance.to_string());
    let mut stream =
        connect_within(&path, CONNECTED_WITHIN).map_err(|error| match error.kind() {
            ErrorKind::WouldBlock => OtherUserError::NotAccepted,
            _ => OtherUserError::NotThere(instance.clone(), path.clone()),
        })?;
    let peer = getsockopt(&stream, PeerCredentials).map_err(io::Error::from)?;
    if !is_of(&folder, peer.uid()) {
        return Err(OtherUserError::Foreign(path));
    }
    let line = line_of(command).ok_or(OtherUserError::OwnUserOnly)?;
    let until = Instant::now() + PATIENCE;
    stream.set_write_timeout(Some(PATIENCE))?;
    // A refusal may come before the command was read.
    let sent = stream.write_all((line + "\n").as_bytes());
    let received = receive_line(&mut stream, until);
    if let Ok(line) = &received
        && let Some(answer) = answer_of(line)
    {
        return answer.map_err(OtherUserError::Refused);
    }
    let is_late = |error: &io::Error| error.kind() == ErrorKind::WouldBlock;
    if sent.as_ref().is_err_and(is_late) || received.as_ref().is_err_and(is_late) {
        return Err(OtherUserError::NoAnswer);
    }
    sent?;
    received?;
    Err(OtherUserError::Io(ErrorKind::UnexpectedEof.into()))
}

/// The line that comes until then, however slowly.
///
/// # Errors
/// `WouldBlock` if it is not complete by then; `UnexpectedEof` if it never will
/// be; `InvalidData` if it is none.
fn receive_line(stream: &mut UnixStream, until: Instant) -> io::Result<String> {
    let mut line = Line::default();
    let mut part = [0; 64];
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::WouldBlock.into());
        }
        stream.set_read_timeout(Some(left))?;
        let read = match stream.read(&mut part) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(read) => read,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        if let Some(line) = line.add(part.get(..read).unwrap_or_default()) {
            return line.map_err(|why| io::Error::new(ErrorKind::InvalidData, why));
        }
    }
}

/// The number of a user, who is given by name or, as sudo takes it, as `#1000`.
fn number_of(name: &str) -> Option<u32> {
    match name.strip_prefix('#') {
        Some(number) => number.parse().ok(),
        None => Some(User::from_name(name).ok()??.uid.as_raw()),
    }
}

/// Whether a folder, and no link, belongs to a user.
fn is_of(folder: &Path, user: u32) -> bool {
    fs::symlink_metadata(folder).is_ok_and(|found| found.is_dir() && found.uid() == user)
}

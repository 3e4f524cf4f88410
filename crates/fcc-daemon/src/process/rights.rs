//! Gives up the rights of root before a flight: its network input and its files
//! are not to be handled with them.
//!
//! As root, limits of real-time priority, of locked memory and of the nice value
//! are raised; then this process becomes that of the user, and runs the program
//! anew. The limits are kept, so the user needs no capability for `SCHED_FIFO`
//! and locked memory; the service gets the same limits from systemd.

use std::env;
use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::CommandExt;
use std::path::{self, Component, Path, PathBuf};
use std::process::Command;

use fcc_flight::config::{Config, RightsSection};
use nix::errno::Errno;
use nix::fcntl::{OFlag, open, openat};
use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit, rlim_t, setrlimit};
use nix::sys::stat::{Mode, fstat, mkdirat};
use nix::unistd::{Group, User, fchown, geteuid, initgroups, setresgid, setresuid};

use crate::output;

/// The user of the package's service.
const SERVICE_USER: &str = "fccd";
const HIGHEST_PRIORITY: rlim_t = 99;
/// A nice value of -20, getrlimit(2).
const LOWEST_NICE: rlim_t = 40;
/// The folders that systemd makes for the service.
const RUN_FOLDERS: [&str; 2] = ["/run/fccd", "/run/fccd-commands"];
/// Opens a folder, and no link.
const FOLDER: OFlag = OFlag::O_DIRECTORY
    .union(OFlag::O_NOFOLLOW)
    .union(OFlag::O_CLOEXEC);
/// The group, or all, may write.
const OTHERS_WRITE: u32 = 0o022;
/// Only its owner may rename or remove what is in such a folder.
const STICKY: u32 = 0o1000;

/// Why the rights of root could not be given up.
#[derive(thiserror::Error, Debug)]
pub(crate) enum RightsError {
    /// There is no such user.
    #[error(
        "rights.user is \"{0}\": there is no such user: choose another, or \"root\" to keep root's \
         rights"
    )]
    NoUser(String),
    /// A call of the system failed.
    #[error("the rights of root cannot be given up: {0}: {1}")]
    System(String, io::Error),
}

/// Without the rights of root, returns at once; with them, continues as the
/// user of the configuration, or of the service if there is one, in a new
/// program with the same arguments: then it does not return.
///
/// # Errors
/// When there is no such user, or the system refuses.
pub(crate) fn give_up(config: &Config) -> Result<(), RightsError> {
    if !geteuid().is_root() {
        return Ok(());
    }
    let configured = config.rights.user.as_deref();
    let name = configured.unwrap_or(SERVICE_USER);
    let failed = |what: &str, error: io::Error| RightsError::System(what.to_owned(), error);
    let found = User::from_name(name).map_err(|errno| failed(name, errno.into()))?;
    let user = match (found, configured) {
        (Some(user), _) if user.uid.is_root() => {
            output::message("runs as root, as rights.user says: a bug has root's rights");
            return Ok(());
        }
        (Some(user), _) => user,
        (None, Some(name)) => return Err(RightsError::NoUser(name.to_owned())),
        (None, None) => {
            output::message(format_args!(
                "runs as root, since there is no user {SERVICE_USER}: a bug has root's rights; set \
                 rights.user"
            ));
            return Ok(());
        }
    };
    raise_limits();
    // Another user has folders of its own, which it makes itself.
    let is_given = env::var_os("RUNTIME_DIRECTORY").is_some() || name != SERVICE_USER;
    let run_folders: &[&str] = if is_given { &[] } else { &RUN_FOLDERS };
    let recordings = config.recording.enabled.then_some(&config.recording.folder);
    let folders = run_folders.iter().map(|folder| (Path::new(folder), 0o700));
    for (folder, mode) in folders.chain(recordings.map(|folder| (folder.as_path(), 0o750))) {
        create_for(&user, folder, mode)
            .map_err(|error| failed(&folder.display().to_string(), error))?;
    }
    become_user(&user).map_err(|error| failed(name, error))?;
    let used = run_folders.iter().map(Path::new);
    for folder in used.chain(recordings.map(PathBuf::as_path)) {
        report_owner(folder, &user);
    }
    output::message(format_args!(
        "was started as root, continues as user {name} (rights.user)"
    ));
    // The thread that prints ends with this program.
    output::wait_until_printed();
    if let Ok(program) = env::current_exe() {
        run_anew(&program, &user, run_folders);
    }
    // The file was replaced, or its folder is closed to the user.
    let error = run_anew(Path::new("/proc/self/exe"), &user, run_folders);
    Err(failed("the program cannot be run anew", error))
}

/// The users and groups of a configuration that this machine does not have, each
/// as a remark: it may be for another machine.
pub(crate) fn unknown_names(rights: &RightsSection) -> Vec<String> {
    let is_no_user = |name: &&String| !matches!(User::from_name(name), Ok(Some(_)));
    let is_no_group = |name: &&String| !matches!(Group::from_name(name), Ok(Some(_)));
    let own = rights.user.iter().filter(is_no_user).map(|name| {
        format!(
            "rights.user is {name:?}: there is no such user on this machine: `fccd run` as root \
             is refused here"
        )
    });
    let here = "on this machine: nobody commands by it here";
    let users = rights.commanders.iter().filter(is_no_user);
    let users =
        users.map(|name| format!("rights.commanders has {name:?}: there is no such user {here}"));
    let groups = rights.commander_groups.iter().filter(is_no_group);
    let groups = groups
        .map(|name| format!("rights.commander_groups has {name:?}: there is no such group {here}"));
    own.chain(users).chain(groups).collect()
}

/// Raises limits that are lower. A container's root may not: then the flight
/// reports which real-time request was denied.
fn raise_limits() {
    for (resource, limit) in [
        (Resource::RLIMIT_RTPRIO, HIGHEST_PRIORITY),
        (Resource::RLIMIT_NICE, LOWEST_NICE),
        (Resource::RLIMIT_MEMLOCK, RLIM_INFINITY),
    ] {
        if getrlimit(resource).is_ok_and(|(soft, _)| soft < limit) {
            let _ = setrlimit(resource, limit, limit);
        }
    }
}

/// Creates a folder of the user if it is missing, as root, where only root can
/// put anything in its place. Elsewhere the user creates it later, with its own
/// rights: a link there does not lead root to another folder.
fn create_for(user: &User, folder: &Path, mode: u32) -> io::Result<()> {
    let folder = path::absolute(folder)?;
    let Some((parent, name)) = folder.parent().zip(folder.file_name()) else {
        return Ok(());
    };
    let Some(parent) = of_root_alone(parent)? else {
        return Ok(());
    };
    match mkdirat(&parent, name, Mode::from_bits_truncate(mode)) {
        Ok(()) => {
            let made = openat(&parent, name, FOLDER, Mode::empty())?;
            Ok(fchown(made, Some(user.uid), Some(user.gid))?)
        }
        Err(Errno::EEXIST) => Ok(()),
        Err(errno) => Err(errno.into()),
    }
}

/// Opens a folder in which only root can write, by way of folders whose entries
/// only root can exchange, and by no link; creates what is missing. None if it
/// is not such a folder.
fn of_root_alone(path: &Path) -> io::Result<Option<OwnedFd>> {
    let mut folder = open("/", FOLDER, Mode::empty())?;
    for name in path.components().skip(1).map(Component::as_os_str) {
        // With the sticky bit, as in `/tmp`, others cannot exchange what is root's.
        let found = fstat(&folder)?;
        let only_root_writes = found.st_mode & OTHERS_WRITE == 0;
        if found.st_uid != 0 || !(only_root_writes || found.st_mode & STICKY != 0) {
            return Ok(None);
        }
        let next = match openat(&folder, name, FOLDER, Mode::empty()) {
            Err(Errno::ENOENT) if only_root_writes => {
                mkdirat(&folder, name, Mode::from_bits_truncate(0o755))?;
                openat(&folder, name, FOLDER, Mode::empty())
            }
            next => next,
        };
        let Ok(next) = next else { return Ok(None) };
        folder = next;
    }
    let found = fstat(&folder)?;
    Ok((found.st_uid == 0 && found.st_mode & OTHERS_WRITE == 0).then_some(folder))
}

/// Reports whose an existing folder is, if it is another user's. It is left as it
/// is: that was decided by somebody else.
fn report_owner(folder: &Path, user: &User) {
    let Ok(found) = fs::metadata(folder) else {
        return;
    };
    let (owner, folder) = (found.uid(), folder.display());
    if owner != user.uid.as_raw() {
        output::message(format_args!(
            "{folder} belongs to user {owner}, and this flight's files to {0}: if it cannot write \
             there, run chown {0} {folder}",
            user.name
        ));
    }
}

/// From here on with the rights of the user only, in all three identities: they
/// cannot be taken back.
fn become_user(user: &User) -> io::Result<()> {
    let name = std::ffi::CString::new(user.name.as_bytes())?;
    initgroups(&name, user.gid)?;
    setresgid(user.gid, user.gid, user.gid)?;
    setresuid(user.uid, user.uid, user.uid)?;
    Ok(())
}

/// Replaces this process; returns only if that fails.
fn run_anew(program: &Path, user: &User, run_folders: &[&str]) -> io::Error {
    let mut command = Command::new(program);
    command
        .arg0("fccd")
        .args(env::args_os().skip(1))
        // Of root's session.
        .env_remove("XDG_RUNTIME_DIR")
        .env("HOME", &user.dir)
        .env("USER", &user.name)
        .env("LOGNAME", &user.name);
    if !run_folders.is_empty() {
        command.env("RUNTIME_DIRECTORY", run_folders.join(":"));
    }
    command.exec()
}

//! Gives up the rights of root before a flight: its network input and its files
//! are not to be handled with them.
//!
//! As root, limits of real-time priority, of locked memory and of the nice value
//! are raised; then this process becomes that of the user, and runs the program
//! anew. The limits are kept, so the user needs no capability for `SCHED_FIFO`
//! and locked memory; the service gets the same limits from systemd.

use std::env;
use std::fs::{self, DirBuilder};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, chown};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

use fcc_flight::config::{Config, RightsSection};
use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit, rlim_t, setrlimit};
use nix::unistd::{Group, User, geteuid, initgroups, setresgid, setresuid};

use crate::output;

/// The user of the package's service.
const SERVICE_USER: &str = "fccd";
const HIGHEST_PRIORITY: rlim_t = 99;
/// A nice value of -20, getrlimit(2).
const LOWEST_NICE: rlim_t = 40;
/// The folders that systemd makes for the service.
const RUN_FOLDERS: [&str; 2] = ["/run/fccd", "/run/fccd-commands"];

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
            output::message("runs as root, by rights.user: its errors have root's rights");
            return Ok(());
        }
        (Some(user), _) => user,
        (None, Some(name)) => return Err(RightsError::NoUser(name.to_owned())),
        (None, None) => {
            output::message(format_args!(
                "runs as root, for there is no user {SERVICE_USER}: its errors have root's rights; \
                 give another user in rights.user"
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
        own(folder, mode, &user).map_err(|error| failed(&folder.display().to_string(), error))?;
    }
    become_user(&user).map_err(|error| failed(name, error))?;
    output::message(format_args!(
        "was started as root, continues as user {name} (rights.user)"
    ));
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
            "rights.user is {name:?}: there is no such user on this machine: a flight that root \
             starts here is refused"
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

/// Creates a folder of the user, if it is missing. One that exists is left as it
/// is: whose it is was decided by somebody else.
fn own(folder: &Path, mode: u32, user: &User) -> io::Result<()> {
    if let Some(parent) = folder.parent().filter(|of| !of.as_os_str().is_empty()) {
        fs::create_dir_all(parent)?;
    }
    match DirBuilder::new().mode(mode).create(folder) {
        Ok(()) => chown(folder, Some(user.uid.as_raw()), Some(user.gid.as_raw())),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            let owner = fs::metadata(folder)?.uid();
            if owner != user.uid.as_raw() {
                output::message(format_args!(
                    "{} belongs to user {owner}, and this flight's files to {}: if it cannot \
                     write there, run chown {} {}",
                    folder.display(),
                    user.name,
                    user.name,
                    folder.display()
                ));
            }
            Ok(())
        }
        Err(error) => Err(error),
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

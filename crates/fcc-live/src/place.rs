//! Where the shared memory of an instance is: a folder of its user alone.
//!
//! ```text
//! live-INSTANCE/current      locked by who publishes; contains a folder's name
//! live-INSTANCE/PID-TIME/    all files of iceoryx2, new for each start
//! ```
//!
//! Whoever publishes removes what earlier ones left, and never opens it.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::{FileExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use iceoryx2::config::Config;
use iceoryx2::prelude::SemanticString;
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc;

use super::PublishError;
use fcc_telemetry::file_lock::{is_locked, whole_file};
use fcc_telemetry::{Instance, RunFolder};

/// The name of an instance's folder begins so.
const FOLDER: &str = "live-";
const CURRENT: &str = "current";
/// How long the process of a daemon that was killed may take to end.
const ENDS_WITHIN: Duration = Duration::from_secs(1);
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// In a file's mode: the access of other users.
const OTHERS: u32 = 0o077;
/// The longest name of a start's folder.
const NAME_BYTES: usize = 64;

fn folder_of(instance: &Instance) -> String {
    format!("{FOLDER}{instance}")
}

/// The files of a program that publishes. Dropping it removes them.
#[derive(Debug)]
pub(super) struct Place {
    folder: RunFolder,
    current: File,
    start: RunFolder,
    name: String,
}

impl Place {
    /// Takes the name, and makes a new folder. Other programs find it when it
    /// is [announced](Self::announce).
    ///
    /// # Errors
    /// When another program of this user publishes by this name, or no folder
    /// can be used.
    pub(super) fn take(instance: &Instance) -> Result<Self, PublishError> {
        let deadline = Instant::now() + ENDS_WITHIN;
        loop {
            match Self::try_take(instance) {
                Err(PublishError::NameTaken(_)) if Instant::now() < deadline => {
                    std::thread::sleep(LOOK_EVERY);
                }
                result => return result,
            }
        }
    }

    fn try_take(instance: &Instance) -> Result<Self, PublishError> {
        let folder = folder_of(instance);
        let taken = || PublishError::NameTaken(instance.clone());
        let of_user = RunFolder::all_of_this_user();
        let mut all = of_user.iter().filter_map(|all| all.existing(&folder));
        if all.any(|folder| lock_of(&folder).is_some_and(|file| is_locked(&file))) {
            return Err(taken());
        }
        let mut refused = Vec::new();
        let run = RunFolder::in_memory(&mut |why| refused.push(why))
            .ok_or_else(|| PublishError::NoSharedMemory(refused.join("; ")))?;
        let folder = run.inside(&folder).map_err(PublishError::NoSharedMemory)?;
        let current = Self::lock(&folder)
            .map_err(|error| failed(&folder.path(CURRENT), &error))?
            .ok_or_else(taken)?;
        remove_all_in(&folder);
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let name = format!(
            "{}-{}",
            std::process::id(),
            now.map_or(0, |now| now.as_nanos())
        );
        let start = folder.inside(&name).map_err(PublishError::NoSharedMemory)?;
        Ok(Self {
            folder,
            current,
            start,
            name,
        })
    }

    /// Opens and locks the file; none if another program has locked it.
    fn lock(folder: &RunFolder) -> std::io::Result<Option<File>> {
        loop {
            let file = folder.open(CURRENT).or_else(|_| {
                // Not a file as it should be: it is in the user's own folder.
                fs::remove_file(folder.path(CURRENT))?;
                folder.open(CURRENT)
            })?;
            if fcntl(&file, FcntlArg::F_OFD_SETLK(&whole_file(libc::F_WRLCK))).is_err() {
                return Ok(None);
            }
            // Otherwise the program that had locked it has removed it.
            if is_at(&file, &folder.path(CURRENT)) {
                return Ok(Some(file));
            }
        }
    }

    /// From here on other programs find the folder.
    pub(super) fn announce(&self) -> Result<(), PublishError> {
        self.close_to_others()
            .and_then(|()| self.current.set_len(0))
            .and_then(|()| self.current.write_all_at(self.name.as_bytes(), 0))
            .map_err(|error| failed(&self.folder.path(CURRENT), &error))
    }

    /// The folder of this start.
    pub(super) fn root(&self) -> &RunFolder {
        &self.start
    }

    /// Takes from others the access that iceoryx2 gives to one file. The
    /// folder keeps them out already.
    fn close_to_others(&self) -> std::io::Result<()> {
        for path in entries(self.start.as_path()) {
            let found = fs::symlink_metadata(&path)?;
            if found.is_file() && found.mode() & OTHERS != 0 {
                let mode = found.mode() & !OTHERS;
                fs::set_permissions(&path, Permissions::from_mode(mode))?;
            }
        }
        Ok(())
    }

    /// Whether other programs can still find the folder.
    pub(super) fn is_found(&self) -> bool {
        is_at(&self.current, &self.folder.path(CURRENT))
            && read_name(&self.current).is_some_and(|name| name == self.name)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(self.start.as_path());
        let current = self.folder.path(CURRENT);
        if is_at(&self.current, &current) {
            let _ = fs::remove_file(current);
        }
        // Only if it is empty.
        let _ = fs::remove_dir(self.folder.as_path());
    }
}

/// The folder of a program that publishes, as others find it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct FoundPlace {
    folder: RunFolder,
    /// Of the start.
    pub(super) root: RunFolder,
    name: String,
}

/// What is known of an instance.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Presence {
    /// Nobody publishes by this name.
    Absent,
    /// Who published was killed or begins: perhaps it is published soon.
    Between,
    /// It is published.
    Here(FoundPlace),
}

/// Looks for who publishes by this name, in all folders of this user.
pub(super) fn look(instance: &Instance) -> Presence {
    let name = folder_of(instance);
    let of_user = RunFolder::all_of_this_user();
    let mut presence = Presence::Absent;
    for folder in of_user.iter().filter_map(|all| all.existing(&name)) {
        match look_in(folder) {
            Presence::Here(place) => return Presence::Here(place),
            Presence::Between => presence = Presence::Between,
            Presence::Absent => {}
        }
    }
    presence
}

/// The names by which this user's programs publish now, sorted.
pub fn running() -> Vec<Instance> {
    let of_user = RunFolder::all_of_this_user();
    let found = of_user.iter().flat_map(|all| entries(all.as_path()));
    let names = found.filter_map(|path| {
        let name = path.file_name()?.to_str()?.strip_prefix(FOLDER)?;
        name.parse::<Instance>().ok()
    });
    let is_here = |name: &Instance| matches!(look(name), Presence::Here(_));
    let mut names: Vec<_> = names.filter(is_here).collect();
    names.sort();
    names.dedup();
    names
}

/// What an error says of them.
pub(super) fn in_words(running: &[Instance]) -> String {
    let names: Vec<_> = running.iter().map(ToString::to_string).collect();
    match names.as_slice() {
        [] => String::new(),
        names => format!("; running here: {}", names.join(", ")),
    }
}

/// What is known of who else publishes by a name.
pub(super) enum Elsewhere {
    /// No other user does.
    Nobody,
    /// This user does, as `sudo -u` takes it.
    User(String),
    /// There are folders that this user may not look into.
    Hidden,
}

/// Looks for another user who publishes by this name.
pub(super) fn look_elsewhere(instance: &Instance) -> Elsewhere {
    let name = folder_of(instance);
    let mut found = Elsewhere::Nobody;
    for (user, folder) in RunFolder::of_other_users() {
        let current = OpenOptions::new()
            .read(true)
            .custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK)
            .open(folder.join(&name).join(CURRENT));
        match current {
            Ok(current) if is_locked(&current) => return Elsewhere::User(user),
            Err(error) if error.kind() == ErrorKind::PermissionDenied => found = Elsewhere::Hidden,
            _ => {}
        }
    }
    found
}

fn look_in(folder: RunFolder) -> Presence {
    let Some(current) = lock_of(&folder) else {
        return Presence::Absent;
    };
    if !is_locked(&current) {
        return Presence::Between;
    }
    let root = read_name(&current).and_then(|name| folder.existing(&name).zip(Some(name)));
    match root {
        Some((root, name)) => Presence::Here(FoundPlace { folder, root, name }),
        None => Presence::Between,
    }
}

impl FoundPlace {
    /// How it is now: the same place, another one, or none.
    pub(super) fn now(&self) -> Presence {
        look_in(self.folder.clone())
    }
}

/// The configuration of iceoryx2 for this folder.
pub(super) fn config(root: &RunFolder) -> Result<Config, String> {
    let mut config = Config::default();
    let path = root.as_path().as_os_str().as_encoded_bytes();
    let path = iceoryx2::prelude::Path::new(path).map_err(|error| format!("{error:?}"))?;
    config.global.set_root_path(&path);
    // All is complete before it is announced. Only a file that was cut off is
    // waited for longer.
    config.global.creation_timeout = Duration::from_millis(200);
    Ok(config)
}

fn lock_of(folder: &RunFolder) -> Option<File> {
    folder.open_existing(CURRENT).ok()
}

fn is_at(file: &File, path: &Path) -> bool {
    let [ours, there] = [file.metadata(), fs::symlink_metadata(path)];
    ours.is_ok_and(|ours| there.is_ok_and(|there| ours.ino() == there.ino()))
}

/// The name of a start's folder; none if it is not one.
fn read_name(file: &File) -> Option<String> {
    let mut bytes = [0; NAME_BYTES];
    let length = file.read_at(&mut bytes, 0).ok()?;
    let name = std::str::from_utf8(bytes.get(..length)?).ok()?;
    let is_name = |byte: u8| byte.is_ascii_digit() || byte == b'-';
    (!name.is_empty() && name.bytes().all(is_name)).then(|| name.to_owned())
}

/// What earlier starts have left. Nothing of it is opened.
fn remove_all_in(folder: &RunFolder) {
    for path in entries(folder.as_path()) {
        if path.file_name().is_some_and(|name| name != CURRENT) {
            let removed = fs::remove_dir_all(&path);
            if removed.is_err() {
                let _ = fs::remove_file(&path);
            }
        }
    }
}

pub(super) fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let found = fs::read_dir(folder).into_iter().flatten();
    found.flatten().map(|entry| entry.path())
}

fn failed(path: &Path, error: &std::io::Error) -> PublishError {
    PublishError::NoSharedMemory(format!("{}: {error}", path.display()))
}

//! The folder of what this user's programs share: locks and marks of plants,
//! and the shared memory of live telemetry.
//!
//! Names in a folder of the user's own can be taken by no other user, unlike
//! those of the abstract namespace (unix(7)) or in a folder for all.

use std::env;
use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use nix::libc::{O_NOFOLLOW, O_NONBLOCK};
use nix::sys::statfs::{TMPFS_MAGIC, statfs};
use nix::unistd::{Uid, User, geteuid};

const OWNER_ONLY: u32 = 0o700;
const OTHERS: u32 = 0o077;

/// That of the service, and of root.
const OF_SERVICE: &str = "/run/fccd";

/// A folder that only this user can use: it belongs to the user, nobody else
/// has access to it (mode 0700), and it is not a link.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RunFolder(PathBuf);

impl RunFolder {
    /// The first of these that can be used, created if it is missing: systemd's
    /// for the service, the user's of the session, root's, one in shared memory.
    /// Those that are refused are reported.
    pub fn of_this_process(report: &mut dyn FnMut(String)) -> Option<Self> {
        usable(report).next()
    }

    /// The first of the same that is in memory and not on a disk, else the
    /// first.
    pub fn in_memory(report: &mut dyn FnMut(String)) -> Option<Self> {
        let mut first = None;
        for folder in usable(report) {
            if folder.is_in_memory() {
                return Some(folder);
            }
            first.get_or_insert(folder);
        }
        first
    }

    /// All that exist, whatever this process' environment is: those that
    /// programs of the same user may have chosen.
    pub fn all_of_this_user() -> Vec<Self> {
        let user = geteuid();
        let others = [
            PathBuf::from(OF_SERVICE),
            PathBuf::from(format!("/run/user/{user}/fccd")),
        ];
        let mut found = Vec::new();
        for path in chosen(user).chain(others) {
            let folder = Self(path);
            if folder.refused(user).is_none() && !found.contains(&folder) {
                found.push(folder);
            }
        }
        found
    }

    /// The folders that programs of other users may have chosen, as far as this
    /// user sees them: each with its user, as `sudo -u` takes it.
    pub fn of_other_users() -> Vec<(String, PathBuf)> {
        let user = geteuid();
        let entries = |of: &str| fs::read_dir(of).into_iter().flatten().flatten();
        let in_memory = entries("/dev/shm")
            .map(|entry| entry.path())
            .filter(|path| {
                let name = path.file_name().unwrap_or_default();
                name.to_string_lossy().starts_with("fccd-run-")
            });
        let of_sessions = entries("/run/user").map(|entry| entry.path().join("fccd"));
        in_memory
            .chain(of_sessions)
            .chain([PathBuf::from(OF_SERVICE)])
            .filter_map(|path| Some((fs::symlink_metadata(&path).ok()?, path)))
            .filter(|(found, _)| found.is_dir() && found.uid() != user.as_raw())
            .map(|(found, path)| (login(found.uid()), path))
            .collect()
    }

    /// The folder at `path`, created if it is missing.
    ///
    /// # Errors
    /// Why it is not used, as text.
    pub fn at(path: PathBuf) -> Result<Self, String> {
        Self::of(path, geteuid())
    }

    fn of(path: PathBuf, user: Uid) -> Result<Self, String> {
        let this = Self(path);
        let why = match DirBuilder::new().mode(OWNER_ONLY).create(&this.0) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                Some(format!("it cannot be created: {error}"))
            }
            _ => this.refused(user),
        };
        match why {
            None => Ok(this),
            Some(why) => Err(format!(
                "the folder {} is not used: {why}",
                this.0.display()
            )),
        }
    }

    /// Why it is not used; none if it can be.
    fn refused(&self, user: Uid) -> Option<String> {
        // Not through a link.
        let found = match fs::symlink_metadata(&self.0) {
            Ok(found) => found,
            Err(error) => return Some(error.to_string()),
        };
        let mode = found.mode() & 0o777;
        if !found.is_dir() {
            Some("it is not a folder; remove it".to_owned())
        } else if found.uid() != user.as_raw() {
            let owner = found.uid();
            Some(format!(
                "it belongs to user {owner} and not to user {user}; remove it"
            ))
        } else if mode & OTHERS != 0 {
            Some(format!(
                "other users have access to it (mode {mode:o}); run chmod 700 {}",
                self.0.display()
            ))
        } else {
            None
        }
    }

    /// A folder in this one, with the same conditions; created if it is
    /// missing.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn inside(&self, name: &str) -> Result<Self, String> {
        Self::at(self.path(name))
    }

    /// A folder in this one, with the same conditions; none if it is missing.
    pub fn existing(&self, name: &str) -> Option<Self> {
        let inside = Self(self.path(name));
        inside.refused(geteuid()).is_none().then_some(inside)
    }

    /// Where the file of this name is.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The folder's path.
    pub fn as_path(&self) -> &Path {
        &self.0
    }

    /// Whether its files are in memory: nothing is written to a disk.
    pub fn is_in_memory(&self) -> bool {
        statfs(&self.0).is_ok_and(|found| found.filesystem_type() == TMPFS_MAGIC)
    }

    /// Opens a file of this user, for reading and writing; creates it if it is
    /// missing.
    ///
    /// # Errors
    /// Also if it is a link, no regular file of this user, or open to others.
    pub fn open(&self, name: &str) -> io::Result<File> {
        self.open_with(name, OpenOptions::new().write(true).create(true))
    }

    /// Opens a file of this user for reading, if it exists.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_existing(&self, name: &str) -> io::Result<File> {
        self.open_with(name, &mut OpenOptions::new())
    }

    fn open_with(&self, name: &str, options: &mut OpenOptions) -> io::Result<File> {
        let file = options
            .read(true)
            .truncate(false)
            .mode(0o600)
            .custom_flags(O_NOFOLLOW | O_NONBLOCK)
            .open(self.path(name))?;
        let found = file.metadata()?;
        if !found.is_file() || found.uid() != geteuid().as_raw() {
            return Err(io::Error::other("it is not a file of this user"));
        }
        if found.mode() & OTHERS != 0 {
            return Err(io::Error::other("other users have access to it: remove it"));
        }
        Ok(file)
    }
}

/// Those that this process may choose, in their order.
fn chosen(user: Uid) -> impl Iterator<Item = PathBuf> {
    let of_service =
        env::var_os("RUNTIME_DIRECTORY").and_then(|folders| env::split_paths(&folders).next());
    let of_session = env::var_os("XDG_RUNTIME_DIR")
        .map(PathBuf::from)
        .or_else(|| session_folder(Path::new("/run/user"), user))
        .map(|folder| folder.join("fccd"));
    let of_root = user.is_root().then(|| PathBuf::from(OF_SERVICE));
    let of_user = Some(PathBuf::from(format!("/dev/shm/fccd-run-{user}")));
    [of_service, of_session, of_root, of_user]
        .into_iter()
        .flatten()
        .filter(|path| path.is_absolute())
}

/// What `XDG_RUNTIME_DIR` names in a session of this user (`pam_systemd(8)`), if there
/// is one now: a daemon that was started without the variable, as by `sudo` or
/// `cron`, then has the locks of one that was started with it.
fn session_folder(of_sessions: &Path, user: Uid) -> Option<PathBuf> {
    let folder = of_sessions.join(user.to_string());
    folder.is_dir().then_some(folder)
}

fn usable(report: &mut dyn FnMut(String)) -> impl Iterator<Item = RunFolder> {
    let user = geteuid();
    chosen(user).filter_map(move |path| RunFolder::of(path, user).map_err(&mut *report).ok())
}

/// The user's name as `sudo -u` takes it.
fn login(user: u32) -> String {
    match User::from_uid(Uid::from_raw(user)) {
        Ok(Some(found)) => found.name,
        _ => format!("#{user}"),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::Permissions;
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn a_folder_is_of_its_user_alone_or_refused() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("fccd");
        let at = |user| RunFolder::of(path.clone(), user).map(|_| ());
        at(geteuid()).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().mode() & 0o777, 0o700);
        at(geteuid()).unwrap();
        let stranger = Uid::from_raw(geteuid().as_raw() + 12_345);
        assert!(at(stranger).unwrap_err().contains("belongs to user"));
        fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
        assert!(at(geteuid()).unwrap_err().contains("mode 755"));
        fs::remove_dir(&path).unwrap();
        symlink(root.path(), &path).unwrap();
        assert!(at(geteuid()).unwrap_err().contains("not a folder"));
        fs::remove_file(&path).unwrap();
        fs::write(&path, "").unwrap();
        assert!(at(geteuid()).unwrap_err().contains("not a folder"));
    }

    #[test]
    fn without_a_session_no_folder_of_one_is_tried() {
        let root = tempfile::tempdir().unwrap();
        let user = Uid::from_raw(1000);
        assert_eq!(session_folder(root.path(), user), None);
        let folder = root.path().join("1000");
        fs::create_dir(&folder).unwrap();
        assert_eq!(session_folder(root.path(), user), Some(folder));
    }

    #[test]
    fn neither_links_nor_pipes_nor_what_others_may_read_is_opened() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(root.path().join("fccd")).unwrap();
        let target = root.path().join("target");
        fs::write(&target, "").unwrap();
        symlink(&target, folder.path("link")).unwrap();
        assert!(folder.open("link").is_err());
        nix::unistd::mkfifo(&folder.path("pipe"), nix::sys::stat::Mode::S_IRWXU).unwrap();
        assert!(folder.open("pipe").is_err());
        assert!(folder.open_existing("file").is_err());
        assert!(folder.open("file").is_ok());
        assert!(folder.open_existing("file").is_ok());
        fs::set_permissions(folder.path("file"), Permissions::from_mode(0o644)).unwrap();
        assert!(folder.open("file").is_err());
    }
}

//! The folder of what this user's daemons share: locks and marks of plants.
//!
//! Names in a folder of the user's own can be taken by no other user, unlike
//! those of the abstract namespace (unix(7)) or in a folder for all.

use std::env;
use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use nix::libc::{O_NOFOLLOW, O_NONBLOCK};
use nix::unistd::{Uid, geteuid};

const OWNER_ONLY: u32 = 0o700;

/// A folder that only this user can use.
#[derive(Clone, Debug)]
pub(super) struct Folder(PathBuf);

impl Folder {
    /// The first of these that can be used: systemd's for the service, the
    /// user's of the session, root's, one beside the shared memory. Those that
    /// are refused are reported.
    pub(super) fn of_this_process(report: &mut dyn FnMut(String)) -> Option<Self> {
        let user = geteuid();
        let of_service =
            env::var_os("RUNTIME_DIRECTORY").and_then(|folders| env::split_paths(&folders).next());
        let of_session =
            env::var_os("XDG_RUNTIME_DIR").map(|folder| Path::new(&folder).join("fccd"));
        let of_root = user.is_root().then(|| PathBuf::from("/run/fccd"));
        let of_user = Some(PathBuf::from(format!("/dev/shm/fccd-run-{user}")));
        [of_service, of_session, of_root, of_user]
            .into_iter()
            .flatten()
            .filter(|path| path.is_absolute())
            .find_map(|path| Self::at(path, user).map_err(&mut *report).ok())
    }

    /// Creates the folder if it is missing, and verifies it.
    fn at(path: PathBuf, user: Uid) -> Result<Self, String> {
        let refused =
            |why: String| Err(format!("the folder {} is not used: {why}", path.display()));
        match DirBuilder::new().mode(OWNER_ONLY).create(&path) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                return refused(format!("it cannot be created: {error}"));
            }
            _ => {}
        }
        // Not through a link.
        let found = match fs::symlink_metadata(&path) {
            Ok(found) => found,
            Err(error) => return refused(error.to_string()),
        };
        if !found.is_dir() {
            return refused("it is not a folder; remove it".to_owned());
        }
        if found.uid() != user.as_raw() {
            let owner = found.uid();
            return refused(format!(
                "it belongs to user {owner} and not to user {user}; remove it"
            ));
        }
        if found.mode() & 0o077 != 0 {
            let mode = found.mode() & 0o777;
            return refused(format!(
                "other users have access to it (mode {mode:o}); run chmod 700 {}",
                path.display()
            ));
        }
        Ok(Self(path))
    }

    /// Where the file of this name is.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Opens a file of this user, for reading and writing; creates it if it is
    /// missing.
    ///
    /// # Errors
    /// Also if it is a link, or no regular file of this user.
    pub(super) fn open(&self, name: &str) -> io::Result<File> {
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .mode(0o600)
            .custom_flags(O_NOFOLLOW | O_NONBLOCK)
            .open(self.path(name))?;
        let found = file.metadata()?;
        if found.is_file() && found.uid() == geteuid().as_raw() {
            Ok(file)
        } else {
            Err(io::Error::other("it is not a file of this user"))
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::fs::Permissions;
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    /// A folder of this user, removed with the returned value.
    pub(in crate::process) fn folder() -> (tempfile::TempDir, Folder) {
        let root = tempfile::tempdir().unwrap();
        let folder = Folder::at(root.path().join("fccd"), geteuid()).unwrap();
        (root, folder)
    }

    #[test]
    fn a_folder_is_of_its_user_alone_or_refused() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("fccd");
        let at = |user| Folder::at(path.clone(), user).map(|_| ());
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
    fn neither_links_nor_pipes_are_opened() {
        let (root, folder) = folder();
        let target = root.path().join("target");
        fs::write(&target, "").unwrap();
        symlink(&target, folder.path("link")).unwrap();
        assert!(folder.open("link").is_err());
        nix::unistd::mkfifo(&folder.path("pipe"), nix::sys::stat::Mode::S_IRWXU).unwrap();
        assert!(folder.open("pipe").is_err());
        assert!(folder.open("file").is_ok());
    }
}

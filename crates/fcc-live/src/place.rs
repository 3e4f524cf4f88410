//! Where a user's shared memory is: a folder of that user alone, and a prefix
//! for the names in `/dev/shm`.
//!
//! By default iceoryx2 puts the files of all users into one folder, which then
//! belongs to the user who came first, and gives the shared memory of two
//! services of one name the same name. Here each user has a folder that no
//! other user can open. It is in `/dev/shm` and not in `/tmp`: it is removed
//! together with the shared memory (a reboot, `RemoveIPC` of systemd-logind),
//! and no cleaner of old files removes it while a daemon runs for weeks.

use std::fs::{self, DirBuilder, Metadata, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};

use iceoryx2::config::Config;
use iceoryx2::prelude::{FileName, SemanticString};
use nix::unistd::{Uid, User, geteuid};

use super::space::SHARED_MEMORY;

/// The beginning of the name of a user's folder; the user's number follows.
const FOLDER: &str = "fccd-";
const OWNER_ONLY: u32 = 0o700;

/// The folder and the file names of a user's shared memory.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Place {
    /// The user.
    user: Uid,
    /// Where shared memory is mounted.
    root: PathBuf,
}

impl Place {
    /// For the user who runs this program.
    pub(super) fn of_this_user() -> Self {
        Self {
            user: geteuid(),
            root: SHARED_MEMORY.into(),
        }
    }

    /// The configuration of iceoryx2.
    fn config(&self) -> Result<Config, String> {
        let mut config = Config::default();
        let root = self.folder();
        let path = root.as_os_str().as_encoded_bytes();
        let path = iceoryx2::prelude::Path::new(path).map_err(|error| format!("{error:?}"))?;
        config.global.set_root_path(&path);
        config.global.prefix =
            FileName::new(self.prefix().as_bytes()).map_err(|error| format!("{error:?}"))?;
        Ok(config)
    }

    fn folder(&self) -> PathBuf {
        self.root.join(format!("{FOLDER}{}", self.user))
    }

    /// The beginning of the names of the user's files beside the folder.
    fn prefix(&self) -> String {
        format!("{FOLDER}{}_", self.user)
    }

    /// Creates the folder if it is missing, and makes it accessible to the user
    /// only.
    ///
    /// # Errors
    /// Why it cannot be used, as text.
    pub(super) fn prepare(&self) -> Result<Config, String> {
        let folder = self.folder();
        let made = DirBuilder::new().mode(OWNER_ONLY).create(&folder);
        match made {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                return Err(format!("{} cannot be created: {error}", folder.display()));
            }
            _ => {}
        }
        // Not through a link that another user has placed there.
        let found = fs::symlink_metadata(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
        self.check(&folder, &found)?;
        if found.permissions().mode() & 0o777 != OWNER_ONLY {
            fs::set_permissions(&folder, Permissions::from_mode(OWNER_ONLY))
                .map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        self.config()
    }

    fn check(&self, path: &Path, found: &Metadata) -> Result<(), String> {
        let owner = Uid::from_raw(found.uid());
        if owner != self.user {
            return Err(format!(
                "{} belongs to {} and not to {}: remove it (sudo rm -r {})",
                path.display(),
                name_of(owner),
                name_of(self.user),
                path.display()
            ));
        }
        if path == self.folder() && !found.is_dir() {
            return Err(format!("{} is not a folder: remove it", path.display()));
        }
        Ok(())
    }

    /// Explains a failure by the first of this user's files that belongs to
    /// another user; none if all are the user's own.
    pub(super) fn foreign_file(&self) -> Option<String> {
        let beside = entries(&self.root).filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(&self.prefix())
        });
        let folder = self.folder();
        let inside = ["nodes", "services"].map(|part| folder.join(part));
        let inside = inside.iter().flat_map(|part| entries(part));
        beside
            .chain(entries(&folder))
            .chain(inside)
            .find_map(|path| {
                let found = fs::symlink_metadata(&path).ok()?;
                self.check(&path, &found).err()
            })
    }

    /// This user's files with one of these texts in their names.
    pub(super) fn files_of(&self, texts: &[String]) -> Vec<PathBuf> {
        let files = entries(&self.root).chain(entries(&self.folder().join("services")));
        let is_meant = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(&self.prefix()) && texts.iter().any(|text| name.contains(text))
        };
        files.filter(is_meant).collect()
    }

    /// The other users who have a folder here, as text: the daemon may be
    /// theirs.
    pub(super) fn other_users(&self) -> Vec<String> {
        let mut users: Vec<_> = entries(&self.root)
            .filter_map(|path| {
                let found = fs::symlink_metadata(&path).ok()?;
                let owner = Uid::from_raw(found.uid());
                let name = path.file_name()?.to_str()?.strip_prefix(FOLDER)?;
                let is_theirs = found.is_dir() && owner != self.user && name == owner.to_string();
                is_theirs.then(|| login(owner))
            })
            .collect();
        users.sort();
        users
    }
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let found = fs::read_dir(folder).into_iter().flatten();
    found.flatten().map(|entry| entry.path())
}

/// The user's name as `sudo -u` takes it.
fn login(user: Uid) -> String {
    match User::from_uid(user) {
        Ok(Some(found)) => found.name,
        _ => format!("#{user}"),
    }
}

fn name_of(user: Uid) -> String {
    format!("user {}", login(user))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(root: &Path, user: Uid) -> Place {
        Place {
            user,
            root: root.to_owned(),
        }
    }

    fn stranger() -> Uid {
        Uid::from_raw(geteuid().as_raw() + 12_345)
    }

    fn mode(folder: &Path) -> u32 {
        fs::metadata(folder).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn two_users_share_neither_folder_nor_names() {
        let root = tempfile::tempdir().unwrap();
        let [ours, theirs] = [geteuid(), stranger()].map(|user| place(root.path(), user));
        let [ours, theirs] = [&ours, &theirs].map(|place| place.config().unwrap().global);
        assert_ne!(ours.root_path(), theirs.root_path());
        assert_ne!(ours.prefix, theirs.prefix);
        // Neither is a prefix of the other: user 1 has no file of user 11.
        assert!(ours.prefix.as_bytes().ends_with(b"_"));
    }

    #[test]
    fn the_folder_is_accessible_to_its_user_only() {
        let root = tempfile::tempdir().unwrap();
        let ours = place(root.path(), geteuid());
        ours.prepare().unwrap();
        assert_eq!(mode(&ours.folder()), 0o700);
        fs::set_permissions(ours.folder(), Permissions::from_mode(0o777)).unwrap();
        ours.prepare().unwrap();
        assert_eq!(mode(&ours.folder()), 0o700);
    }

    #[test]
    fn a_foreign_file_is_reported_with_both_users() {
        let root = tempfile::tempdir().unwrap();
        // For another user, the folder created here belongs to a stranger.
        let theirs = place(root.path(), stranger());
        fs::create_dir(theirs.folder()).unwrap();
        let words = theirs.prepare().unwrap_err();
        assert!(words.contains("belongs to user"), "{words}");
        assert!(words.contains("sudo rm -r"), "{words}");
        assert!(words.contains(&format!("#{}", stranger())), "{words}");

        let ours = place(root.path(), geteuid());
        assert_eq!(ours.foreign_file(), None);
        fs::write(root.path().join(format!("{}x", theirs.prefix())), "").unwrap();
        assert!(theirs.foreign_file().is_some());
        assert_eq!(ours.foreign_file(), None);
    }

    #[test]
    fn neither_a_file_nor_a_link_is_a_folder() {
        let root = tempfile::tempdir().unwrap();
        let ours = place(root.path(), geteuid());
        fs::write(ours.folder(), "").unwrap();
        assert!(ours.prepare().unwrap_err().contains("not a folder"));
        fs::remove_file(ours.folder()).unwrap();
        std::os::unix::fs::symlink(root.path(), ours.folder()).unwrap();
        assert!(ours.prepare().unwrap_err().contains("not a folder"));
    }

    #[test]
    fn other_users_are_found_by_their_folders() {
        let root = tempfile::tempdir().unwrap();
        let ours = place(root.path(), geteuid());
        ours.prepare().unwrap();
        assert_eq!(ours.other_users(), Vec::<String>::new());
        let theirs = place(root.path(), stranger());
        assert_eq!(theirs.other_users(), [login(geteuid())]);
    }
}

//! Opens files that others may have placed: a pipe, a device or a link.
//!
//! What is opened is examined, not the name: between the two another program
//! could exchange the file. A pipe is opened without waiting for its writer.

use std::fs::{self, DirBuilder, File, Metadata, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Read as _};
use std::os::unix::fs::{
    DirBuilderExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _,
};
use std::path::Path;

use nix::libc::{O_CLOEXEC, O_NOFOLLOW, O_NONBLOCK};
use nix::unistd::geteuid;

const ROOT: u32 = 0;
/// The mode of a file that nobody but its owner opens.
const OF_OWNER: u32 = 0o600;
/// The mode of a recording: whatever the umask is, only its owner may write it.
pub(super) const RECORDING: u32 = 0o644;
/// In a folder's mode: every user may write, and only a file's owner may delete it.
const OTHERS_WRITE: u32 = 0o002;
const STICKY: u32 = 0o1000;

/// Whether a file or a folder is this user's, or root's.
pub(super) fn is_owned(found: &Metadata) -> bool {
    [geteuid().as_raw(), ROOT].contains(&found.uid())
}

fn refused<T>(kind: ErrorKind, why: impl Into<String>) -> io::Result<T> {
    Err(io::Error::new(kind, why.into()))
}

/// Opens a regular file, with these flags.
fn regular(path: &Path, options: &mut OpenOptions, flags: i32) -> io::Result<(File, Metadata)> {
    let opened = options
        .custom_flags(flags | O_NONBLOCK | O_CLOEXEC)
        .open(path);
    let file = match opened {
        // What a link gives with O_NOFOLLOW, open(2).
        Err(_) if flags & O_NOFOLLOW != 0 && path.is_symlink() => {
            let why = "it is a symbolic link, which is not followed here: give or place the file \
                       itself";
            return refused(ErrorKind::InvalidInput, why);
        }
        opened => opened?,
    };
    let found = file.metadata()?;
    if found.is_dir() {
        return refused(ErrorKind::IsADirectory, "it is a folder");
    }
    if !found.is_file() {
        let why = "it is not a regular file: it is a pipe or a device";
        return refused(ErrorKind::InvalidInput, why);
    }
    Ok((file, found))
}

/// Opens a file that the user has named, to read it. A link is followed if it
/// belongs to this user, to root, or to the owner of its folder: the kernel's
/// rule for folders of all (`protected_symlinks`, proc(5)), here for each folder.
///
/// # Errors
/// The system's error, or that it is a link of another user or no regular file.
pub(super) fn open(path: &Path) -> io::Result<File> {
    named(path, OpenOptions::new().read(true))
}

/// The same, to write it, too, if that is possible.
///
/// # Errors
/// As [`open`].
pub(super) fn open_to_lock(path: &Path) -> io::Result<File> {
    named(path, OpenOptions::new().read(true).write(true)).or_else(|_| open(path))
}

fn named(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    if let Ok(link) = fs::symlink_metadata(path)
        && link.is_symlink()
    {
        let folder = path.parent().filter(|of| !of.as_os_str().is_empty());
        let of_folder = fs::metadata(folder.unwrap_or(Path::new(".")))?.uid();
        let owner = link.uid();
        if ![geteuid().as_raw(), ROOT, of_folder].contains(&owner) {
            let why = format!(
                "it is a symbolic link of user {owner}, which is not followed: give the file \
                 itself"
            );
            return refused(ErrorKind::PermissionDenied, why);
        }
    }
    let (file, _) = regular(path, options, 0)?;
    Ok(file)
}

/// Opens a file that was found in a folder, to read it: no link.
pub(super) fn open_found(path: &Path) -> io::Result<File> {
    let (file, _) = regular(path, OpenOptions::new().read(true), O_NOFOLLOW)?;
    Ok(file)
}

/// Reads a regular file of at most `most_bytes` that the user has named.
///
/// # Errors
/// The system's error, or that it is larger, a link of another user or not a
/// regular file.
pub fn read_file(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read_all(open(path)?, most_bytes)
}

/// As [`read_file`], of a file that this program has written: no link, and
/// belonging to this user or root.
///
/// # Errors
/// As [`read_file`], or that it is a link or belongs to another user.
pub fn read_own_file(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    let (file, found) = regular(path, OpenOptions::new().read(true), O_NOFOLLOW)?;
    let owner = found.uid();
    if !is_owned(&found) {
        let why = format!("it belongs to user {owner}: remove it, or choose another name");
        return refused(ErrorKind::PermissionDenied, why);
    }
    read_all(file, most_bytes)
}

fn read_all(file: File, most_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        let why = format!("it has more than {most_bytes} bytes: choose another file");
        return refused(ErrorKind::FileTooLarge, why);
    }
    Ok(bytes)
}

/// Opens a file to lock it; creates it if it is missing, and changes nothing in
/// it. Nobody else may open it.
///
/// # Errors
/// The system's error, or that it is a link or no regular file.
pub fn open_lock(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).mode(OF_OWNER);
    // In a file system that is frozen, opening a file to create it waits even if it is
    // there.
    let opened = regular(path, &mut options, O_NOFOLLOW).or_else(|error| match error.kind() {
        ErrorKind::NotFound => regular(path, options.create(true).truncate(false), O_NOFOLLOW),
        _ => Err(error),
    });
    let (file, found) = opened?;
    if found.permissions().mode() & !OF_OWNER & 0o777 != 0 {
        // Of an earlier version. Another user's stays as it is.
        let _ = file.set_permissions(Permissions::from_mode(OF_OWNER));
    }
    Ok(file)
}

/// Creates a new file that nobody but its owner opens, instead of one, or of a
/// link, of this name.
///
/// # Errors
/// The system's error.
pub fn create_anew(path: &Path) -> io::Result<File> {
    create_with(path, OF_OWNER)
}

/// The same, of a recording, which others may read.
pub(super) fn create_recording_anew(path: &Path) -> io::Result<File> {
    create_with(path, RECORDING)
}

fn create_with(path: &Path, mode: u32) -> io::Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(mode)
        .open(path)
}

/// Creates a folder, and those above it that are missing. Whatever the umask
/// is, nobody but the owner may write in them.
///
/// # Errors
/// The system's error.
pub fn create_folder(path: &Path) -> io::Result<()> {
    // In a file system that is frozen, creating waits even if it is there.
    if path.is_dir() {
        return Ok(());
    }
    let created = DirBuilder::new().recursive(true).mode(0o755).create(path);
    created.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => io::Error::new(
            ErrorKind::NotADirectory,
            "it is a file, or is below one: give the name of a folder",
        ),
        _ => error,
    })
}

/// Who else can delete what is in a folder; none if only this user and root can, or it
/// is not known.
pub(super) fn others_in(folder: &Path) -> Option<String> {
    let found = fs::metadata(folder).ok()?;
    let owner = found.uid();
    if !is_owned(&found) {
        return Some(format!("belongs to user {owner}, who"));
    }
    let mode = found.permissions().mode();
    (mode & OTHERS_WRITE != 0 && mode & STICKY == 0)
        .then(|| "may be written by every user, and each".to_owned())
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{lchown, symlink};
    use std::os::unix::net::UnixListener;
    use std::process::Command;

    use super::*;

    fn why<T>(result: io::Result<T>) -> String {
        result.map_or_else(|error| error.to_string(), |_| "opened".to_owned())
    }

    #[test]
    fn pipes_devices_folders_and_sockets_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(
            Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            for said in [
                why(open(path)),
                why(read_file(path, 10)),
                why(read_own_file(path, 10)),
                why(open_lock(path)),
            ] {
                assert!(said.contains("a pipe or a device"), "{said}");
            }
        }
        assert!(why(open(folder.path())).contains("folder"));
        let socket = folder.path().join("socket");
        let _listener = UnixListener::bind(&socket).unwrap();
        assert!(open(&socket).is_err());
    }

    #[test]
    fn only_a_link_that_the_user_has_named_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target", "link"].map(|name| folder.path().join(name));
        fs::write(&target, "kept").unwrap();
        symlink(&target, &link).unwrap();
        assert_eq!(read_file(&link, 10).unwrap(), b"kept");
        for said in [
            why(open_found(&link)),
            why(read_own_file(&link, 10)),
            why(open_lock(&link)),
        ] {
            assert!(
                said.contains("symbolic link, which is not followed"),
                "{said}"
            );
        }
        create_anew(&link).unwrap();
        assert!(!link.is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"kept");
    }

    #[test]
    fn what_belongs_to_another_user_is_not_trusted() {
        if !geteuid().is_root() {
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target", "link"].map(|name| folder.path().join(name));
        fs::write(&target, "x").unwrap();
        symlink(&target, &link).unwrap();
        lchown(&link, Some(65_534), None).unwrap();
        assert!(why(open(&link)).contains("a symbolic link of user 65534"));
        // It could replace the target as well.
        lchown(folder.path(), Some(65_534), None).unwrap();
        assert_eq!(why(open(&link)), "opened");
        lchown(&target, Some(65_534), None).unwrap();
        assert!(why(read_own_file(&target, 10)).contains("belongs to user 65534"));
        assert_eq!(read_file(&target, 10).unwrap(), b"x");
    }

    #[test]
    fn what_is_too_large_is_refused_and_a_lock_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "12345678901").unwrap();
        assert!(why(read_file(&path, 10)).contains("more than 10 bytes"));
        assert_eq!(read_file(&path, 11).unwrap().len(), 11);
        drop(open_lock(&path).unwrap());
        assert_eq!(fs::metadata(&path).unwrap().len(), 11);
    }

    #[test]
    fn a_folder_in_which_others_may_delete_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let mode = |mode| fs::set_permissions(folder.path(), Permissions::from_mode(mode));
        for (bits, expected) in [
            (0o755, None),
            (0o1777, None),
            (0o777, Some("may be written by every user, and each")),
        ] {
            mode(bits).unwrap();
            assert_eq!(others_in(folder.path()).as_deref(), expected, "{bits:o}");
        }
        assert_eq!(others_in(&folder.path().join("missing")), None);
        // Only root may give it away.
        mode(0o755).unwrap();
        if lchown(folder.path(), Some(65_534), None).is_ok() {
            let said = others_in(folder.path());
            assert_eq!(said.as_deref(), Some("belongs to user 65534, who"));
        }
    }
}

//! Files that commands write: what a person has made, or a flight has, is not replaced by them.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;

use super::disk::is_same_file;

/// What tells a plan is in its first bytes.
const BEGIN: u64 = 4_096;

/// Creates a file, or replaces its content, unless it is one of the files that
/// are read, under whatever name, a recording, a flight plan or a configuration.
///
/// # Errors
/// The system's error, or what it is.
pub fn create_output<P: AsRef<Path>>(path: &Path, inputs: &[P]) -> io::Result<File> {
    keeps(path, inputs, Kept::of(path))?;
    File::create(path)
}

/// Writes a whole file as [`create_output`] does. Where that fails, what was there before is
/// still there.
///
/// # Errors
/// As [`create_output`].
pub fn write_output<P: AsRef<Path>>(path: &Path, inputs: &[P], content: &[u8]) -> io::Result<()> {
    keeps(path, inputs, Kept::of(path))?;
    replace(path, content)
}

/// The same for a plan, which another one replaces.
///
/// # Errors
/// As [`create_output`].
pub fn write_plan<P: AsRef<Path>>(path: &Path, inputs: &[P], content: &[u8]) -> io::Result<()> {
    let kept = Kept::of(path).filter(|kept| *kept != Kept::Plan);
    keeps(path, inputs, kept)?;
    replace(path, content)
}

/// Writes beside it first, unless it is a pipe or the like, or a link of this user.
fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) {
        return File::create(path)?.write_all(content);
    }
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let beside = path.with_file_name(name);
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&beside)
        .and_then(|mut file| file.write_all(content))
        .and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // What could not be written is of no use; if this fails, too, it is left.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Whether a file may be created or replaced as an output.
///
/// # Errors
/// What it is, if it may not.
pub fn may_be_output(path: &Path) -> io::Result<()> {
    let inputs: [&Path; 0] = [];
    keeps(path, &inputs, Kept::of(path))
}

fn keeps<P: AsRef<Path>>(path: &Path, inputs: &[P], kept: Option<Kept>) -> io::Result<()> {
    let mut inputs = inputs.iter().map(AsRef::as_ref);
    if let Some(input) = inputs.find(|input| is_same_file(path, input)) {
        let input = input.display();
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("it is {input}, which this command uses, too: choose another name"),
        ));
    }
    refuse_what_is_of_another(path)?;
    let what = match kept {
        None => return Ok(()),
        Some(Kept::Recording) => "recording",
        Some(Kept::Plan) => "flight plan",
        Some(Kept::Configuration) => "configuration",
    };
    Err(io::Error::new(
        io::ErrorKind::AlreadyExists,
        format!("it is a {what}, which is not replaced: choose another name"),
    ))
}

/// A link of another user would be followed to a file of this one, a pipe waited for, and a
/// file could be changed afterwards; but whoever administers the machine may write anybody's.
fn refuse_what_is_of_another(path: &Path) -> io::Result<()> {
    let Ok(there) = fs::symlink_metadata(path) else {
        return Ok(());
    };
    let own = nix::unistd::geteuid();
    if there.is_dir() || [0, own.as_raw()].contains(&there.uid()) {
        return Ok(());
    }
    let what = if there.is_symlink() {
        "link"
    } else if !there.is_file() {
        "pipe or device"
    } else if own.is_root() {
        return Ok(());
    } else {
        "file"
    };
    Err(io::Error::new(
        io::ErrorKind::PermissionDenied,
        format!(
            "it is a {what} of another user ({}), which is not used: choose another name",
            there.uid()
        ),
    ))
}

/// What is not replaced.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kept {
    Recording,
    Plan,
    Configuration,
}

impl Kept {
    fn of(path: &Path) -> Option<Self> {
        // Opening a pipe would wait for its other end.
        if !fs::metadata(path).is_ok_and(|found| found.is_file()) {
            return None;
        }
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            return Some(Self::Configuration);
        }
        let mut begin = Vec::new();
        File::open(path)
            .and_then(|file| file.take(BEGIN).read_to_end(&mut begin))
            .ok()?;
        let has = |word: &[u8]| begin.windows(word.len()).any(|here| here == word);
        if begin.starts_with(mcap::MAGIC) {
            Some(Self::Recording)
        } else if begin.starts_with(b"QGC WPL") || (has(b"\"fileType\"") && has(b"\"Plan\"")) {
            Some(Self::Plan)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first bytes of a recording (the specification of MCAP), of both formats of plans
    /// (QGroundControl's), and a configuration.
    #[test]
    fn an_output_replaces_nothing_that_was_made() {
        let folder = tempfile::tempdir().unwrap();
        let inputs: [&Path; 0] = [];
        let made: [(&str, &[u8], &str); 4] = [
            ("a.mcap", b"\x89MCAP0\r\n\x01\0\0", "a recording"),
            ("a.waypoints", b"QGC WPL 110\n", "a flight plan"),
            ("a.json", b"{\n  \"fileType\": \"Plan\",\n", "a flight plan"),
            ("a.toml", b"rate_hz = 40.0\n", "a configuration"),
        ];
        for (name, content, what) in made {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            let refused = create_output(&path, &inputs).unwrap_err().to_string();
            assert!(refused.contains(what), "{name}: {refused}");
            assert_eq!(fs::read(&path).unwrap(), content);
            let plan = write_plan(&path, &inputs, b"QGC WPL 110\n");
            assert_eq!(plan.is_ok(), what == "a flight plan");
        }
        let page = folder.path().join("page");
        fs::write(&page, "an earlier page").unwrap();
        may_be_output(&page).unwrap();
        create_output(&page, &inputs).unwrap();
        assert_eq!(fs::metadata(&page).unwrap().len(), 0);
        write_output(&page, &inputs, b"a page").unwrap();
        assert_eq!(fs::read(&page).unwrap(), b"a page");
        let names = fs::read_dir(folder.path()).unwrap();
        assert_eq!(names.count(), made.len() + 1, "nothing is left beside");
    }

    /// Only root can make what another user has.
    #[test]
    fn a_link_of_another_user_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (own, link) = (folder.path().join("own"), folder.path().join("link"));
        fs::write(&own, "mine").unwrap();
        std::os::unix::fs::symlink(&own, &link).unwrap();
        let inputs: [&Path; 0] = [];
        write_output(&link, &inputs, b"a page").unwrap();
        assert_eq!(fs::read(&own).unwrap(), b"a page");
        if std::os::unix::fs::lchown(&link, Some(65_534), None).is_ok() {
            let refused = write_output(&link, &inputs, b"theirs").unwrap_err();
            assert!(refused.to_string().contains("link of another user"));
            assert!(create_output(&link, &inputs).is_err());
            assert_eq!(fs::read(&own).unwrap(), b"a page");
        }
    }
}

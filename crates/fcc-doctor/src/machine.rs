//! Reads the files of a machine.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Longer than any file read: `/proc/cpuinfo` of 256 CPUs fits.
const MAX_BYTES: u64 = 1 << 20;
/// More than any folder's entries.
const MAX_ENTRIES: usize = 4_096;

/// A machine, as a folder with its files.
#[derive(Debug)]
pub(super) struct Machine {
    root: PathBuf,
}

impl Machine {
    pub(super) fn under(root: &Path) -> Self {
        Self {
            root: root.to_owned(),
        }
    }

    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    /// A file's text without surrounding white space; none if it is missing,
    /// unreadable or empty.
    pub(super) fn text(&self, path: &str) -> Option<String> {
        let mut bytes = Vec::new();
        File::open(self.root.join(path))
            .ok()?
            .take(MAX_BYTES)
            .read_to_end(&mut bytes)
            .ok()?;
        // Texts of the device tree end with a zero.
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim_matches(|c: char| c.is_whitespace() || c == '\0');
        (!text.is_empty()).then(|| text.to_owned())
    }

    /// The first word of a file as a number.
    pub(super) fn number<T: std::str::FromStr>(&self, path: &str) -> Option<T> {
        self.text(path)?.split_whitespace().next()?.parse().ok()
    }

    pub(super) fn exists(&self, path: &str) -> bool {
        self.root.join(path).exists()
    }

    /// Whether this user may not read a file that exists or may exist.
    pub(super) fn is_forbidden(&self, path: &str) -> bool {
        let opened = File::open(self.root.join(path));
        opened.is_err_and(|error| error.kind() == ErrorKind::PermissionDenied)
    }

    /// The paths of a folder's entries that begin with `prefix`, in order.
    pub(super) fn entries(&self, folder: &str, prefix: &str) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.root.join(folder))
            .into_iter()
            .flatten()
            .take(MAX_ENTRIES)
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| name.starts_with(prefix))
            .collect();
        // cpu10 after cpu9.
        names.sort_by_key(|name| (name.len(), name.clone()));
        names
            .into_iter()
            .map(|name| format!("{folder}/{name}"))
            .collect()
    }

    /// The value of `field` in a file of `field: value` lines.
    pub(super) fn field(&self, path: &str, field: &str) -> Option<String> {
        field_of(&self.text(path)?, field).map(str::to_owned)
    }

    /// As `uname -r -v` prints it.
    pub(super) fn kernel(&self) -> String {
        let part = |name| self.text(&format!("proc/sys/kernel/{name}"));
        [part("osrelease"), part("version")]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// The value of `field` in lines of `field: value`.
pub(super) fn field_of<'a>(text: &'a str, field: &str) -> Option<&'a str> {
    text.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == field).then(|| value.trim())
    })
}

//! The link of a ground station that runs, for the other programs of its user.

use std::fs::File;
use std::io::{self, Read as _, Write as _};

use crate::file_lock::{is_locked, try_lock};
use crate::run_folder::RunFolder;

const FILE: &str = "ground-link";
/// A longer one is none, bytes.
const LONGEST: u64 = 400;

/// A link that is published while this exists.
#[derive(Debug)]
pub struct StationLink {
    _locked: File,
}

impl StationLink {
    /// Publishes a link; none if another station of this user has published its own, or there is no
    /// folder for it.
    pub fn publish(link: &str) -> Option<Self> {
        Self::publish_in(&RunFolder::of_this_process(&mut drop)?, link).ok()?
    }

    fn publish_in(folder: &RunFolder, link: &str) -> io::Result<Option<Self>> {
        let mut file = folder.open(FILE)?;
        if !try_lock(&file)? {
            return Ok(None);
        }
        file.set_len(0)?;
        file.write_all(link.as_bytes())?;
        Ok(Some(Self { _locked: file }))
    }

    /// The links of the stations of this user that run.
    pub fn all() -> Vec<String> {
        let folders = RunFolder::all_of_this_user();
        folders.iter().filter_map(Self::published_in).collect()
    }

    fn published_in(folder: &RunFolder) -> Option<String> {
        let file = folder.open_existing(FILE).ok()?;
        if !is_locked(&file) {
            return None;
        }
        let mut link = String::new();
        file.take(LONGEST).read_to_string(&mut link).ok()?;
        let is_link =
            link.starts_with("http://") && link.bytes().all(|byte| byte.is_ascii_graphic());
        is_link.then_some(link)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_published_while_its_station_runs() {
        let folder = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(folder.path().join("run")).unwrap();
        let link = "http://127.0.0.1:8460/#token=0123";
        let published = StationLink::publish_in(&folder, link).unwrap();
        assert_eq!(StationLink::published_in(&folder).as_deref(), Some(link));
        let second = StationLink::publish_in(&folder, "http://127.0.0.1:1/").unwrap();
        assert!(second.is_none());
        drop(published);
        assert_eq!(StationLink::published_in(&folder), None);
        // A text that would write to a terminal is no link.
        let _published = StationLink::publish_in(&folder, "http://a/\u{1b}[2J").unwrap();
        assert_eq!(StationLink::published_in(&folder), None);
    }
}

//! A file in a folder of recordings, whether it can be read or not.

use std::path::PathBuf;

use serde::Serialize;

use super::list::{Entry, entry, glance};
use super::name;

/// A file in a folder of recordings.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(untagged)]
pub enum Listed {
    /// A recording.
    Recording(Entry),
    /// A file that cannot be read, or is not a recording.
    Unreadable {
        /// The file.
        #[serde(serialize_with = "name::serialize")]
        path: PathBuf,
        /// The reason, beginning with the path.
        error: String,
    },
}

impl Listed {
    /// Reads a file; a `quick` look reads only its beginning and its end, and
    /// does not detect damage between.
    pub fn of(path: PathBuf, quick: bool) -> Self {
        // The user has named the folder and not the link.
        if path.is_symlink() {
            let error = format!(
                "{}: is a symbolic link, which is not followed: list the folder of the file itself",
                path.display()
            );
            return Self::Unreadable { path, error };
        }
        let read = if quick { glance(&path) } else { entry(&path) };
        match read {
            Ok(entry) => Self::Recording(entry),
            Err(error) => Self::Unreadable {
                path,
                error: error.to_string(),
            },
        }
    }

    /// What is wrong with the file, as text: empty for an undamaged recording.
    pub fn errors(&self) -> Vec<String> {
        match self {
            Self::Recording(entry) => {
                let path = entry.path.display();
                let damages = entry.damages.iter();
                damages
                    .map(|damage| format!("{path}: is {damage}"))
                    .collect()
            }
            Self::Unreadable { error, .. } => vec![error.clone()],
        }
    }

    /// The recording, if it is one.
    pub fn entry(self) -> Option<Entry> {
        match self {
            Self::Recording(entry) => Some(entry),
            Self::Unreadable { .. } => None,
        }
    }
}

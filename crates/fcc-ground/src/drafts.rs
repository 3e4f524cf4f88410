//! Flight plans that are being drawn, on the board: each edit is on the disk before it is
//! answered.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use axum::extract::ws::Utf8Bytes;
use fcc_plan::Plan;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::sync::broadcast;

use crate::failure::Failure;
use crate::files;
use crate::orders::utc_ms;
use crate::plans::{hash_text, within_limits};

const MOST_DRAFTS: usize = 500;
const LONGEST_NAME: usize = 64;
const MOST_FILE_BYTES: u64 = 8 << 20;
const EXTENSION: &str = ".json";

/// A draft, as in its file.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Draft {
    pub(crate) name: String,
    /// Grows with each edit, also when a draft is removed and made again.
    pub(crate) revision: u64,
    pub(crate) changed_utc_s: f64,
    pub(crate) plan: Plan,
}

impl Draft {
    pub(crate) fn to_json(&self) -> Value {
        json!({
            "name": self.name,
            "revision": self.revision,
            "changed_utc_s": self.changed_utc_s,
            "hash": hash_text(&self.plan),
            "plan": self.plan,
        })
    }
}

/// All drafts.
#[derive(Debug)]
pub(crate) struct Drafts {
    folder: PathBuf,
    /// Held while a draft is changed.
    turn: Mutex<()>,
    pub(crate) changes: broadcast::Sender<Utf8Bytes>,
}

/// Why a draft is not changed.
pub(crate) enum Refused {
    Newer(Box<Draft>),
    Other(Failure),
}

impl Drafts {
    pub(crate) fn new(folder: PathBuf) -> io::Result<Self> {
        fs::create_dir_all(&folder)?;
        Ok(Self {
            folder,
            turn: Mutex::default(),
            changes: broadcast::Sender::new(64),
        })
    }

    fn path(&self, name: &str) -> Result<PathBuf, Failure> {
        let is_valid = (1..=LONGEST_NAME).contains(&name.len())
            && !name.starts_with(['.', ' '])
            && !name.ends_with(' ')
            && name
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || " ._-".contains(c));
        if !is_valid {
            return Err(Failure::bad(format!(
                "the name of a draft has 1 to {LONGEST_NAME} letters, digits, spaces, '.', '_' and \
                 '-', and begins with a letter or digit"
            )));
        }
        Ok(self.folder.join(format!("{name}{EXTENSION}")))
    }

    fn find(&self, name: &str) -> Result<Option<Draft>, Failure> {
        let path = self.path(name)?;
        let text = match files::read_limited(&path, MOST_FILE_BYTES) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => {
                return Err(Failure::internal(format!("{}: {error}", path.display())));
            }
        };
        let read = serde_json::from_str(&text);
        let read = read.map_err(|error| {
            let path = path.display();
            Failure::internal(format!("{path}: is no draft: {error}: move it away"))
        })?;
        Ok(Some(read))
    }

    /// The newest revision of a draft.
    pub(crate) fn get(&self, name: &str) -> Result<Draft, Failure> {
        let found = self.find(name)?;
        found.ok_or_else(|| Failure::missing(format!("there is no draft {name:?}")))
    }

    fn names(&self) -> io::Result<Vec<String>> {
        let files = fs::read_dir(&self.folder)?.flatten();
        let names = files.filter_map(|file| {
            let name = file.file_name().into_string().ok()?;
            name.strip_suffix(EXTENSION).map(str::to_owned)
        });
        let mut names: Vec<_> = names.collect();
        names.sort();
        Ok(names)
    }

    pub(crate) fn list(&self) -> Result<Vec<Value>, Failure> {
        let names = self.names().map_err(Failure::internal)?;
        let drafts = names
            .iter()
            .filter_map(|name| self.find(name).ok().flatten());
        let listed = drafts.map(|draft| {
            json!({
                "name": draft.name,
                "revision": draft.revision,
                "changed_utc_s": draft.changed_utc_s,
                "items": draft.plan.items.len(),
                "hash": hash_text(&draft.plan),
            })
        });
        Ok(listed.collect())
    }

    pub(crate) fn put(&self, name: &str, based_on: u64, plan: Plan) -> Result<Draft, Refused> {
        let path = self.path(name).map_err(Refused::Other)?;
        within_limits(&plan).map_err(|problem| Refused::Other(Failure::bad(problem)))?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let before = self.find(name).map_err(Refused::Other)?;
        let newest = before.as_ref().map_or(0, |before| before.revision);
        if let Some(before) = before.filter(|_| newest != based_on) {
            return Err(Refused::Newer(Box::new(before)));
        }
        let failed = |error: io::Error| {
            Refused::Other(Failure::internal(format!("{}: {error}", path.display())))
        };
        if newest == 0 && self.names().map_err(failed)?.len() >= MOST_DRAFTS {
            let what = format!("there are {MOST_DRAFTS} drafts: remove one");
            return Err(Refused::Other(Failure::refused(what)));
        }
        let draft = Draft {
            name: name.to_owned(),
            revision: utc_ms().max(newest + 1),
            changed_utc_s: utc_ms() as f64 * 1e-3,
            plan,
        };
        let text = serde_json::to_vec(&draft).map_err(|error| failed(error.into()))?;
        files::replace(&path, &text).map_err(failed)?;
        self.tell(name, Some(draft.revision));
        Ok(draft)
    }

    pub(crate) fn delete(&self, name: &str) -> Result<(), Failure> {
        let path = self.path(name)?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        match files::remove(&path) {
            Ok(()) => {
                self.tell(name, None);
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Err(Failure::missing(format!("there is no draft {name:?}")))
            }
            Err(error) => Err(Failure::internal(format!("{}: {error}", path.display()))),
        }
    }

    fn tell(&self, name: &str, revision: Option<u64>) {
        let text = json!({ "name": name, "revision": revision }).to_string();
        // Perhaps nobody listens.
        let _ = self.changes.send(text.into());
    }
}

//! The mark: a file that says what is held, for the next start of the app.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fcc_core::framework::PlantId;
use fcc_flight::release::Line;

/// Its name in the folder of recordings.
pub(super) const NAME: &str = "held";

/// The file, there or not.
pub(super) struct Mark {
    path: PathBuf,
}

impl Mark {
    pub(super) fn in_folder(folder: &Path) -> Self {
        Self {
            path: folder.join(NAME),
        }
    }

    pub(super) fn is_there(&self) -> bool {
        self.path.exists()
    }

    /// Stores, wholly or not at all, that this plant is held.
    pub(super) fn set(&self, config: &str, plant: &PlantId) -> io::Result<()> {
        let new = self.path.with_extension("new");
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder)?;
        }
        let mut file = File::create(&new)?;
        write!(file, "{config}\n{}\n", Line::Held(1, *plant))?;
        file.sync_all()?;
        fs::rename(new, &self.path)
    }

    /// Nothing is held any more.
    pub(super) fn remove(&self) {
        // It may never have been there.
        let _ = fs::remove_file(&self.path);
    }
}

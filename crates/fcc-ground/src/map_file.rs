//! The user's own map, and the ground below.

use std::fs::File;
use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};

/// A map in one file.
#[derive(Debug)]
pub(crate) struct MapFile {
    pub(crate) path: PathBuf,
    pub(crate) file: File,
    pub(crate) attribution: String,
}

impl MapFile {
    /// # Errors
    /// When it cannot be opened, or is none.
    pub(crate) fn open(path: &Path, attribution: &str) -> Result<Self, String> {
        let failed = |error| format!("{}: {error}", path.display());
        let file = File::open(path).map_err(failed)?;
        let mut begin = [0_u8; 7];
        file.read_exact_at(&mut begin, 0).map_err(failed)?;
        if begin != *b"PMTiles" {
            return Err(format!("{}: is no PMTiles file", path.display()));
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            attribution: attribution.to_owned(),
        })
    }
}

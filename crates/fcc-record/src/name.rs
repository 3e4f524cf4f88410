//! File names of recordings.

use std::path::{Path, PathBuf};

use serde::{Serialize as _, Serializer};

use super::utc;

/// The file extension of recordings.
pub(crate) const EXTENSION: &str = "mcap";

/// `2026-11-20T04-21-33.512Z-built-in-01.mcap`: start of the flight, plant
/// and part number. Names sort by date.
pub(super) fn file_name(started_unix_ns: u64, plant: &str, part: u32) -> String {
    let plant: String = plant
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let stamp = utc::file_stamp(started_unix_ns);
    format!("{stamp}-{plant}-{part:02}.{EXTENSION}")
}

/// Whether a file has the name of a recording. No other file is deleted or
/// repaired.
pub(super) fn is_recording(path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
        return false;
    };
    let stamp = "0000-00-00T00-00-00.000Z-";
    name.len() > stamp.len()
        && Path::new(name).extension().is_some_and(|e| e == EXTENSION)
        && name
            .bytes()
            .zip(stamp.bytes())
            .all(|(byte, pattern)| match pattern {
                b'0' => byte.is_ascii_digit(),
                other => byte == other,
            })
}

/// The times that a flight tries for its name, each a millisecond later: of one
/// at which another flight began, the name is taken.
pub(super) const MAX_NAMES: u64 = 100;
pub(super) const NAMES_APART_NS: u64 = 1_000_000;

/// Writes a path into JSON: what is not UTF-8 is replaced.
///
/// # Errors
/// The serializer's.
pub(super) fn serialize<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(&path.display())
}

/// As [`serialize`].
#[expect(clippy::ref_option, reason = "serde passes the field")]
pub(super) fn serialize_option<S: Serializer>(
    path: &Option<PathBuf>,
    to: S,
) -> Result<S::Ok, S::Error> {
    path.as_ref()
        .map(|path| path.to_string_lossy())
        .serialize(to)
}

/// The temporary file that will replace `path`.
pub(super) fn unfinished(path: &Path) -> PathBuf {
    with_ending(path, ".unfinished")
}

/// The name under which a damaged file is kept after it is replaced: the first
/// that is free.
pub(super) fn damaged(path: &Path) -> PathBuf {
    let first = with_ending(path, ".damaged");
    let more = (2..1_000).map(|number| with_ending(path, &format!(".damaged-{number}")));
    std::iter::once(first.clone())
        .chain(more)
        .find(|kept| !kept.exists())
        .unwrap_or(first)
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_contains_start_and_aircraft_and_is_recognised() {
        let name = file_name(1_795_148_493_512_000_000, "X-Plane: c172/2", 3);
        assert_eq!(name, "2026-11-20T04-21-33.512Z-X-Plane--c172-2-03.mcap");
        assert!(is_recording(Path::new(&name)));
        for other in [
            "flight.mcap",
            "2026-11-20T04-21-33.512Z-c172-01.mcap.unfinished",
            "2026-11-20T04-21-33.512Z-c172-01.txt",
            "2026-11-20.mcap",
        ] {
            assert!(!is_recording(Path::new(other)), "{other}");
        }
    }
}

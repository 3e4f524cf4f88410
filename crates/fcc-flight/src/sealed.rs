//! Files that this program writes for itself in the state folder: a first line
//! with name, version and a CRC-32 of the rest.
//!
//! They are written to a temporary file, synced and renamed, so that an
//! interruption leaves either the old or the new file and never a part of one;
//! the CRC is for disks that do not honour a sync.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// What is wrong with the content of a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Unsealed {
    /// It was not written by this program.
    Foreign,
    /// It is of another version.
    Version(u32),
    /// It differs from what was written.
    Damaged,
}

/// The content of a file with this body.
pub(crate) fn seal(name: &str, version: u32, body: &[u8]) -> Vec<u8> {
    let mut bytes = format!("{name} {version} {:08x}\n", crc32fast::hash(body)).into_bytes();
    bytes.extend(body);
    bytes
}

/// The body of a file.
pub(crate) fn open<'a>(name: &str, version: u32, bytes: &'a [u8]) -> Result<&'a [u8], Unsealed> {
    let (head, body) = match bytes.iter().position(|byte| *byte == b'\n') {
        Some(end) => bytes.split_at(end),
        None => (bytes, [].as_slice()),
    };
    let head = std::str::from_utf8(head).map_err(|_| Unsealed::Foreign)?;
    let Some(words) = head.strip_prefix(name) else {
        return Err(if bytes.is_empty() {
            Unsealed::Damaged
        } else {
            Unsealed::Foreign
        });
    };
    let mut words = words.split(' ');
    if words.next() != Some("") {
        return Err(Unsealed::Foreign);
    }
    let found = words.next().and_then(|word| word.parse().ok());
    let found: u32 = found.ok_or(Unsealed::Damaged)?;
    if found != version {
        return Err(Unsealed::Version(found));
    }
    let crc = words
        .next()
        .and_then(|word| u32::from_str_radix(word, 16).ok());
    let body = body.get(1..).unwrap_or_default();
    if crc != Some(crc32fast::hash(body)) || words.next().is_some() {
        return Err(Unsealed::Damaged);
    }
    Ok(body)
}

/// Writes a file; when this returns, it is on the disk. Until then its content
/// is in a file with the extension `new`.
pub(crate) fn replace(path: &Path, new: &str, bytes: &[u8]) -> io::Result<()> {
    let new = path.with_extension(new);
    let written = fcc_record::create_anew(&new).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_data()
    });
    if let Err(error) = written {
        // A part of it is of no use.
        let _ = fs::remove_file(&new);
        return Err(error);
    }
    fs::rename(&new, path)?;
    sync_folder(path)
}

/// Writes the folder of a file to the disk.
pub(crate) fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    File::open(folder)?.sync_all()
}

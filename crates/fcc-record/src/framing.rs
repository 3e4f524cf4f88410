//! Finds where the next record of a file begins after a damaged one.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};

use mcap::records::op;
use nix::errno::Errno;
use nix::unistd::{Whence, lseek64};

use super::parse::is_chunk_of;

/// Opcode and length.
pub(super) const HEAD_BYTES: usize = 1 + 8;

/// No longer record is read. A chunk of ours has 1 MiB, of another program as
/// much as it was told. A flight's computer may read it.
pub(super) const MAX_RECORD_BYTES: u64 = 64 << 20;

/// The footer: its opcode and length, two offsets and a checksum.
pub(super) const FOOTER_BYTES: u64 = HEAD_BYTES as u64 + 8 + 8 + 4;

/// The magic number that begins and ends a file.
pub(super) const MAGIC_BYTES: u64 = mcap::MAGIC.len() as u64;

/// Bytes that suffice to identify a record by its beginning.
const SIGNATURE_BYTES: usize = 256;

/// Bytes searched at once.
const BLOCK_BYTES: usize = 256 << 10;

/// The opcode and the length at the beginning of `bytes`.
pub(super) fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let ([opcode, length @ ..], _) = bytes.split_first_chunk::<HEAD_BYTES>()?;
    Some((*opcode, u64::from_le_bytes(*length)))
}

/// Whether a record at `position` of a file of `file_bytes` is identified by
/// its beginning: its lengths are consistent, which random bytes are once in
/// some billion positions.
fn is_known(bytes: &[u8], position: u64, file_bytes: u64) -> bool {
    let Some((opcode, length)) = head(bytes) else {
        return false;
    };
    // Damaged lengths are any number.
    let record_bytes = length.saturating_add(HEAD_BYTES as u64);
    let end = position.saturating_add(record_bytes);
    if length > MAX_RECORD_BYTES || end > file_bytes {
        return false;
    }
    let body = bytes.get(HEAD_BYTES..).unwrap_or_default();
    let u32_at = |at: usize| -> Option<u64> {
        let bytes = body.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes).into())
    };
    match opcode {
        op::CHUNK => is_chunk_of(body, length),
        // A channel, and an array of pairs of numbers.
        op::MESSAGE_INDEX => u32_at(2).is_some_and(|bytes| bytes + 6 == length && bytes % 16 == 0),
        // A name, and another or a map.
        op::HEADER | op::METADATA => u32_at(0)
            .and_then(|name| Some((name, u32_at(usize::try_from(name).ok()?.checked_add(4)?)?)))
            .is_some_and(|(name, map)| name + map + 8 == length),
        // Two times, a name, a media type, the data and a checksum.
        op::ATTACHMENT => u32_at(16)
            .and_then(|name| {
                let media = u32_at(usize::try_from(20 + name).ok()?)?;
                let data_at = usize::try_from(24 + name + media).ok()?;
                let data = u64::from_le_bytes(*body.get(data_at..)?.first_chunk()?);
                (data_at as u64 + 12).checked_add(data)
            })
            .is_some_and(|bytes| bytes == length),
        op::DATA_END => length == 4,
        op::FOOTER => end + MAGIC_BYTES == file_bytes && length + HEAD_BYTES as u64 == FOOTER_BYTES,
        _ => false,
    }
}

/// Whether a record can be identified at `position`.
pub(super) fn is_at(file: &mut File, position: u64, file_bytes: u64) -> io::Result<bool> {
    let mut bytes = Vec::new();
    read_at(file, position, SIGNATURE_BYTES, &mut bytes)?;
    Ok(is_known(&bytes, position, file_bytes))
}

/// The first record from `start` on that can be identified.
pub(super) fn find(file: &mut File, start: u64, file_bytes: u64) -> io::Result<Option<u64>> {
    let mut bytes = Vec::new();
    let mut at = start;
    while let Some(data) = next_data(file, at)
        && data < file_bytes
    {
        at = data;
        read_at(file, at, BLOCK_BYTES + SIGNATURE_BYTES, &mut bytes)?;
        let found = (at..file_bytes)
            .take(BLOCK_BYTES)
            .enumerate()
            .find(|&(offset, position)| {
                let record = bytes.get(offset..).unwrap_or_default();
                is_known(record, position, file_bytes)
            });
        if let Some((_, position)) = found {
            return Ok(Some(position));
        }
        at += BLOCK_BYTES as u64;
    }
    Ok(None)
}

/// Where the next bytes are that the file system stores: a hole, which may have any
/// length, contains no record. None if the rest is one.
/// (`lseek` takes 32 bits on a 32-bit board.)
fn next_data(file: &File, at: u64) -> Option<u64> {
    match lseek64(file, i64::try_from(at).ok()?, Whence::SeekData) {
        Ok(data) => u64::try_from(data).ok(),
        Err(Errno::ENXIO) => None,
        // Not every file system tells.
        Err(_) => Some(at),
    }
}

/// Reads up to `length` bytes at `position`.
fn read_at(file: &mut File, position: u64, length: usize, into: &mut Vec<u8>) -> io::Result<()> {
    into.clear();
    file.seek(SeekFrom::Start(position))?;
    file.take(length as u64).read_to_end(into)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by fuzzing: the sum overflowed.
    #[test]
    fn a_length_may_be_any_number() {
        for length in [u64::MAX, u64::MAX - 8, MAX_RECORD_BYTES + 1, 992] {
            for opcode in 0..=u8::MAX {
                let record = [&[opcode][..], &length.to_le_bytes(), &[255; 40]].concat();
                assert!(!is_known(&record, 0, 1_000), "{opcode}, {length}");
            }
        }
    }
}

//! The end of a whole file: its footer, and what its index leads to.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::ops::Range;

use mcap::records::Record;

use super::end::{END, End};
use super::parse::parse;

/// The magic number that begins and ends a file.
const MAGIC_BYTES: u64 = mcap::MAGIC.len() as u64;
/// Opcode, length, two offsets and a checksum.
const FOOTER_BYTES: u64 = 1 + 8 + 8 + 8 + 4;
/// No summary of ours is longer: an hour's is 400 kB.
const MAX_SUMMARY_BYTES: u64 = 64 << 20;
/// Nor an account.
const MAX_METADATA_BYTES: u64 = 1 << 20;

/// Where the index of a whole file is; none if the file is cut.
pub(super) fn read_footer(file: &mut File, bytes: u64) -> Option<Range<u64>> {
    let footer_at = bytes.checked_sub(FOOTER_BYTES + MAGIC_BYTES)?;
    let tail = read_at(file, footer_at, FOOTER_BYTES + MAGIC_BYTES)?;
    let (footer, magic) = tail.split_at_checked(FOOTER_BYTES as usize)?;
    if magic != mcap::MAGIC {
        return None;
    }
    let Some((Some(Record::Footer(footer)), _)) = split_record(footer) else {
        return None;
    };
    Some(footer.summary_start..footer_at)
}

/// The account that an index points to.
pub(super) fn read_end(file: &mut File, index: &Range<u64>) -> Option<End> {
    let length = index.end.checked_sub(index.start)?;
    if index.start == 0 || length > MAX_SUMMARY_BYTES {
        return None;
    }
    let summary = read_at(file, index.start, length)?;
    let mut rest = summary.as_slice();
    let index = loop {
        let (record, after) = split_record(rest)?;
        match record {
            Some(Record::MetadataIndex(index)) if index.name == END => break index,
            _ => rest = after,
        }
    };
    if index.length > MAX_METADATA_BYTES {
        return None;
    }
    match split_record(&read_at(file, index.offset, index.length)?)?.0 {
        Some(Record::Metadata(metadata)) => Some(End::from_fields(&metadata.metadata)),
        _ => None,
    }
}

/// The record that bytes begin with, if it can be understood, and what follows
/// it.
fn split_record(bytes: &[u8]) -> Option<(Option<Record<'_>>, &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (body, after) = rest.split_at_checked(length)?;
    Some((parse(*opcode, body).ok(), after))
}

fn read_at(file: &mut File, offset: u64, length: u64) -> Option<Vec<u8>> {
    file.seek(SeekFrom::Start(offset)).ok()?;
    let mut bytes = Vec::new();
    let read = file.take(length).read_to_end(&mut bytes).ok()?;
    (read as u64 == length).then_some(bytes)
}

//! The end of a finished file: its footer and its index.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::ops::Range;

use mcap::records::{Record, op};

use super::about::RECORDING;
use super::end::{END, End};
use super::framing::{FOOTER_BYTES, HEAD_BYTES, MAGIC_BYTES, head};
use super::parse::parse;
use super::schema::Topic;

/// Longer than any index of ours: an hour's has 400 kB.
const MAX_SUMMARY_BYTES: u64 = 64 << 20;
/// Longer than any statistics.
const MAX_METADATA_BYTES: u64 = 1 << 20;
/// The footer's checksum, of all bytes before it.
const CHECKSUM_BYTES: u64 = 4;

/// The content of a file's index.
#[derive(Debug, Default)]
pub(super) struct Summary {
    /// Where the chunks are.
    chunks: Vec<Range<u64>>,
    /// The records that declare schemas and channels, in sequence.
    pub(super) declarations: Vec<u8>,
    /// Where the statistics of the flight are.
    end: Option<Range<u64>>,
    /// How often the metadata of a recording is in the file.
    pub(super) recordings: usize,
    /// Whether it declares topics, and none is ours.
    pub(super) is_foreign: bool,
}

impl Summary {
    /// Whether a chunk overlaps these bytes.
    pub(super) fn has_chunk_in(&self, bytes: &Range<u64>) -> bool {
        self.chunks
            .iter()
            .any(|chunk| chunk.start < bytes.end && bytes.start < chunk.end)
    }
}

/// Where the index of a finished file is; none if the file is unfinished.
pub(super) fn read_footer(file: &mut File, bytes: u64) -> Option<Range<u64>> {
    let footer_at = bytes.checked_sub(FOOTER_BYTES + MAGIC_BYTES)?;
    let tail = read_at(file, footer_at, FOOTER_BYTES + MAGIC_BYTES)?;
    let (footer, magic) = tail.split_at_checked(FOOTER_BYTES as usize)?;
    if magic != mcap::MAGIC || head(footer) != Some(FOOTER_HEAD) {
        return None;
    }
    match split_record(footer) {
        Some((Some(Record::Footer(footer)), _)) => Some(footer.summary_start..footer_at),
        _ => None,
    }
}

const FOOTER_HEAD: (u8, u64) = (op::FOOTER, FOOTER_BYTES - HEAD_BYTES as u64);

/// Whether the file ends with at least a part of a footer.
pub(super) fn has_end(file: &mut File, bytes: u64) -> bool {
    let length = FOOTER_BYTES + MAGIC_BYTES;
    bytes
        .checked_sub(length)
        .and_then(|at| read_at(file, at, length))
        .is_some_and(|tail| tail.ends_with(mcap::MAGIC) || head(&tail) == Some(FOOTER_HEAD))
}

/// The end of a finished file whose index begins at `at`, if other bytes follow it.
pub(super) fn end(file: &mut File, mut at: u64) -> Option<u64> {
    loop {
        let record = head(&read_at(file, at, HEAD_BYTES as u64)?)?;
        at = at.checked_add(HEAD_BYTES as u64)?.checked_add(record.1)?;
        if record == FOOTER_HEAD {
            let is_end = read_at(file, at, MAGIC_BYTES)? == mcap::MAGIC;
            return is_end.then_some(at + MAGIC_BYTES);
        }
    }
}

/// The content of a finished file's index.
///
/// # Errors
/// What is wrong with it, as text.
pub(super) fn read(file: &mut File, index: &Range<u64>) -> Result<Summary, &'static str> {
    let length = index.end.checked_sub(index.start).unwrap_or(u64::MAX);
    if index.start == 0 {
        return Ok(Summary::default());
    }
    if length > MAX_SUMMARY_BYTES {
        return Err("the index is too long");
    }
    let bytes = read_at(file, index.start, length + FOOTER_BYTES).ok_or("it cannot be read")?;
    let (covered, checksum) = bytes
        .split_last_chunk::<{ CHECKSUM_BYTES as usize }>()
        .ok_or("the index is too short")?;
    let checksum = u32::from_le_bytes(*checksum);
    if checksum != 0 && crc32fast::hash(covered) != checksum {
        return Err("the index's checksum does not match");
    }
    let mut summary = Summary::default();
    let (mut topics, mut is_ours) = (0, false);
    let mut rest = bytes.get(..length as usize).unwrap_or_default();
    while !rest.is_empty() {
        let (record, after) = split_record(rest).ok_or("a record of the index has no end")?;
        match record {
            Some(Record::ChunkIndex(chunk)) => summary.chunks.push(
                chunk.chunk_start_offset
                    ..chunk.chunk_start_offset.saturating_add(chunk.chunk_length),
            ),
            Some(declaration @ (Record::Schema { .. } | Record::Channel(_))) => {
                if let Record::Channel(channel) = &declaration {
                    topics += 1;
                    is_ours |= channel.topic == Topic::Record.name();
                }
                let length = rest.len() - after.len();
                summary.declarations.extend(rest.iter().take(length));
            }
            Some(Record::MetadataIndex(index)) if index.name == RECORDING => {
                summary.recordings += 1;
            }
            Some(Record::MetadataIndex(index)) if index.name == END => {
                summary.end = Some(index.offset..index.offset.saturating_add(index.length));
            }
            _ => {}
        }
        rest = after;
    }
    summary.is_foreign = topics > 0 && !is_ours;
    Ok(summary)
}

/// The statistics that an index points to.
pub(super) fn read_end(file: &mut File, summary: &Summary) -> Option<End> {
    let at = summary.end.clone()?;
    let length = at.end - at.start;
    if length > MAX_METADATA_BYTES {
        return None;
    }
    match split_record(&read_at(file, at.start, length)?)?.0 {
        Some(Record::Metadata(metadata)) if metadata.name == END => {
            Some(End::from_fields(&metadata.metadata))
        }
        _ => None,
    }
}

/// The record at the beginning of `bytes`, if it can be parsed, and the bytes
/// after it.
fn split_record(bytes: &[u8]) -> Option<(Option<Record<'_>>, &[u8])> {
    let (opcode, length) = head(bytes)?;
    let rest = bytes.get(HEAD_BYTES..)?;
    let (body, after) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((parse(opcode, body).ok(), after))
}

fn read_at(file: &mut File, offset: u64, length: u64) -> Option<Vec<u8>> {
    file.seek(SeekFrom::Start(offset)).ok()?;
    let mut bytes = Vec::new();
    let read = file.take(length).read_to_end(&mut bytes).ok()?;
    (read as u64 == length).then_some(bytes)
}

//! Reads the MCAP records of an untrusted file in sequence: no length is
//! allocated before that many bytes are known to be there, and nothing of a
//! chunk is returned before its checksum matches. Damage is reported and
//! skipped: reading continues at the next record that can be identified.
//!
//! The `mcap` crate's own reader (0.26) panics on some invalid lengths and
//! allocates what a file claims: it is used in tests only, for files of our
//! own.

use std::cell::OnceCell;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek as _, SeekFrom};
use std::mem;
use std::ops::Range;

use mcap::records::{Record, op};

use super::chunk;
use super::framing::{self, FOOTER_BYTES, HEAD_BYTES, MAGIC_BYTES, MAX_RECORD_BYTES};
use super::parse::{parse, parse_outside};
use super::summary::{self, Summary};

/// Where and why reading ended before the end of the recording.
#[derive(thiserror::Error, Debug)]
pub(super) enum Cut {
    /// The file ends here, unfinished.
    #[error("cut off after {0} bytes")]
    Off(u64),
    /// It is unfinished because a program writes it.
    #[error("still being written, {0} bytes so far")]
    NotYet(u64),
    /// It ends before it says what it is.
    #[error("too short: {0} bytes")]
    TooShort(u64),
    /// It does not begin like a recording.
    #[error("not an MCAP file")]
    NotMcap,
    /// The system could not read the next bytes.
    #[error("unreadable after {after} bytes: {source}")]
    Unreadable {
        /// Bytes read before.
        after: u64,
        /// The system's error.
        source: io::Error,
    },
}

impl Cut {
    /// The same of a file that a program writes, or not.
    pub(super) fn of_file(self, is_being_written: bool) -> Self {
        match self {
            Self::Off(bytes) | Self::TooShort(bytes) if is_being_written => Self::NotYet(bytes),
            cut => cut,
        }
    }
}

/// The next thing in a file.
pub(super) enum Next<T> {
    /// A record.
    Record(T),
    /// Damaged bytes; reading continues after them.
    Damage(DamagedBytes),
    /// The end of a finished file.
    End,
}

/// Bytes that are not what was written.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct DamagedBytes {
    /// From the first to the one after the last.
    pub(super) bytes: Range<u64>,
    /// What is wrong with them, as text.
    pub(super) why: String,
    /// Whether messages may have been in them, and not only an index or
    /// metadata.
    pub(super) messages: bool,
}

/// Reads the records of a file and of its chunks in sequence, from the header
/// to the end of the data. Indexes are verified and skipped.
pub(super) struct RawReader {
    file: BufReader<File>,
    /// Length of the file when opened: what is appended later is ignored.
    length: u64,
    position: u64,
    /// The current record, without its opcode and length.
    body: Vec<u8>,
    /// The current chunk, its place in the file, and the read position in it.
    chunk: Vec<u8>,
    chunk_bytes: Range<u64>,
    chunk_position: usize,
    /// Whether a message was outside of the chunks.
    is_unchunked: bool,
    /// Of all bytes read; none after damage was skipped.
    checksum: Option<crc32fast::Hasher>,
    /// The content of the index, once it was read.
    summary: OnceCell<Option<Summary>>,
    finished: bool,
}

impl RawReader {
    pub(super) fn new(file: File) -> io::Result<Self> {
        Ok(Self {
            length: file.metadata()?.len(),
            file: BufReader::with_capacity(64 << 10, file),
            position: 0,
            body: Vec::new(),
            chunk: Vec::new(),
            chunk_bytes: 0..0,
            chunk_position: 0,
            is_unchunked: false,
            checksum: Some(crc32fast::Hasher::new()),
            summary: OnceCell::new(),
            finished: false,
        })
    }

    /// Bytes read so far, to show progress.
    pub(super) const fn bytes_read(&self) -> u64 {
        self.position
    }

    /// The place of the last record in the file, or of the chunk that contains
    /// it.
    pub(super) fn last_bytes(&self) -> Range<u64> {
        self.chunk_bytes.clone()
    }

    /// Passes the next record to `take`.
    ///
    /// # Errors
    /// Where the file is cut off; nothing can be read after that.
    pub(super) fn next<T>(&mut self, take: impl FnOnce(Record<'_>) -> T) -> Result<Next<T>, Cut> {
        if self.position == 0
            && let Some(why) = self.read_magic()?
        {
            return self.skip(0, why);
        }
        loop {
            if self.finished {
                return Ok(Next::End);
            }
            if self.chunk_position < self.chunk.len() {
                let parsed = framed(&self.chunk, self.chunk_position)
                    .ok_or("a chunk's records overlap its end")
                    .and_then(|(opcode, body, end)| {
                        self.chunk_position = end;
                        parse(opcode, body)
                    });
                match parsed {
                    Ok(record) => return Ok(Next::Record(take(record))),
                    Err(why) => {
                        // Where the next record begins is not known.
                        self.chunk_position = self.chunk.len();
                        return Ok(Next::Damage(DamagedBytes {
                            bytes: self.chunk_bytes.clone(),
                            why: why.to_owned(),
                            messages: true,
                        }));
                    }
                }
            }
            let start = self.position;
            let checksum_before = self.checksum.clone();
            let opcode = match self.read_record()? {
                Ok(opcode) => opcode,
                Err(why) => return self.skip(start, why),
            };
            if opcode == op::FOOTER {
                self.finished = true;
                return Ok(Next::End);
            }
            self.chunk_bytes = start..self.position;
            let damage = match parse_outside(opcode, &self.body) {
                Ok(Record::Chunk { header, data }) => {
                    self.chunk.clear();
                    self.chunk_position = 0;
                    match chunk::open(&header, &data, &mut self.chunk) {
                        Ok(()) => None,
                        Err(why) => Some(self.damaged_chunk(why)?),
                    }
                }
                Ok(Record::DataEnd(end)) => {
                    let computed = checksum_before.map(crc32fast::Hasher::finalize);
                    self.end_of_data(start, computed, end.data_section_crc)?
                }
                // An index of the chunk before it.
                Ok(Record::Unknown { .. }) => None,
                Ok(record) => {
                    self.is_unchunked |= matches!(record, Record::Message { .. });
                    return Ok(Next::Record(take(record)));
                }
                Err(why) => return self.skip(start, why),
            };
            if let Some(damage) = damage {
                return Ok(Next::Damage(damage));
            }
        }
    }

    /// Reads the magic number; returns what is wrong with it.
    fn read_magic(&mut self) -> Result<Option<&'static str>, Cut> {
        if self.length < MAGIC_BYTES {
            return Err(Cut::TooShort(self.length));
        }
        self.read_body(MAGIC_BYTES)?;
        Ok((self.body != mcap::MAGIC).then_some(NO_MAGIC))
    }

    /// Reads the next record of the file; returns its opcode, or what is wrong
    /// with its length.
    fn read_record(&mut self) -> Result<Result<u8, &'static str>, Cut> {
        if self.left() < HEAD_BYTES as u64 {
            return Ok(Err(TOO_LONG));
        }
        self.read_body(HEAD_BYTES as u64)?;
        let Some((opcode, length)) = framing::head(&self.body) else {
            return Ok(Err(TOO_LONG));
        };
        if length > self.left() {
            return Ok(Err(TOO_LONG));
        }
        if length > MAX_RECORD_BYTES {
            return Ok(Err("a record claims more bytes than any has"));
        }
        let is_footer =
            length + HEAD_BYTES as u64 == FOOTER_BYTES && length + MAGIC_BYTES == self.left();
        if opcode == op::FOOTER && !is_footer {
            return Ok(Err("a footer that is not at the end"));
        }
        self.read_body(length)?;
        Ok(Ok(opcode))
    }

    const fn left(&self) -> u64 {
        self.length.saturating_sub(self.position)
    }

    /// Reads `length` bytes, which the file has.
    fn read_body(&mut self, length: u64) -> Result<(), Cut> {
        self.body.resize(length as usize, 0);
        match self.file.read_exact(&mut self.body) {
            Ok(()) => {
                self.position += length;
                if let Some(checksum) = &mut self.checksum {
                    checksum.update(&self.body);
                }
                Ok(())
            }
            Err(error) => Err(self.unreadable(error)),
        }
    }

    /// A chunk with a correct length and damaged content.
    fn damaged_chunk(&mut self, why: String) -> Result<DamagedBytes, Cut> {
        self.checksum = None;
        self.repeat_declarations();
        self.seek()?;
        Ok(DamagedBytes {
            bytes: self.chunk_bytes.clone(),
            why,
            messages: true,
        })
    }

    /// Continues after a record at `start` whose end is not known.
    fn skip<T>(&mut self, start: u64, why: &str) -> Result<Next<T>, Cut> {
        self.checksum = None;
        // Its claimed end, if a record is there.
        let claimed = self.position;
        let next = self
            .seek_next(start, claimed)
            .map_err(|error| self.unreadable(error))?;
        match why {
            TOO_LONG if next.is_none() => return Err(Cut::Off(self.length)),
            NO_MAGIC if next.is_none() => return Err(Cut::NotMcap),
            _ => {}
        }
        self.position = next.unwrap_or(self.length);
        let bytes = start..self.position;
        let messages = bytes.end > MAGIC_BYTES
            && self
                .summary()
                .is_none_or(|summary| summary.has_chunk_in(&bytes));
        if messages {
            self.repeat_declarations();
        }
        self.seek()?;
        Ok(Next::Damage(DamagedBytes {
            bytes,
            why: why.to_owned(),
            messages,
        }))
    }

    fn seek_next(&mut self, start: u64, claimed: u64) -> io::Result<Option<u64>> {
        let file = self.file.get_mut();
        if claimed > start + HEAD_BYTES as u64 && framing::is_at(file, claimed, self.length)? {
            return Ok(Some(claimed));
        }
        framing::find(file, start + 1, self.length)
    }

    fn seek(&mut self) -> Result<(), Cut> {
        self.file
            .seek(SeekFrom::Start(self.position))
            .map(drop)
            .map_err(|error| self.unreadable(error))
    }

    /// The content of the index; none if it is damaged or missing. Moves the
    /// file's position.
    fn summary(&mut self) -> Option<&mut Summary> {
        let (file, length) = (&mut self.file, self.length);
        self.summary.get_or_init(|| {
            let file = file.get_mut();
            let index = summary::read_footer(file, length)?;
            summary::read(file, &index).ok()
        });
        self.summary.get_mut()?.as_mut()
    }

    /// Returns, once, the index's copy of the declared topics: the chunk that
    /// declared them may be damaged.
    fn repeat_declarations(&mut self) {
        let summary = self.summary();
        let declarations = summary.map(|summary| mem::take(&mut summary.declarations));
        self.chunk = declarations.unwrap_or_default();
        self.chunk_position = 0;
    }

    /// Verifies the index, which follows the data.
    fn end_of_data(
        &mut self,
        start: u64,
        computed: Option<u32>,
        checksum: u32,
    ) -> Result<Option<DamagedBytes>, Cut> {
        let mut index = self.position..self.length;
        let file = self.file.get_mut();
        let footer = summary::read_footer(file, self.length);
        let is_here = |at: &Range<u64>| at.start == 0 || at.start == index.start;
        let why = match (footer, summary::end(file, index.start)) {
            (_, Some(end)) if end < self.length => {
                index.start = end;
                Some("these bytes follow the file's end")
            }
            (Some(at), _) if is_here(&at) => summary::read(file, &at).err(),
            (Some(_), _) => Some("the footer does not point to the index"),
            (None, _) if summary::has_end(file, self.length) => Some("the footer is damaged"),
            (None, _) => return Err(Cut::Off(self.length)),
        };
        self.finished = true;
        self.position = self.length;
        let damaged = |bytes, why: &str, messages| DamagedBytes {
            bytes,
            why: why.to_owned(),
            messages,
        };
        if let Some(why) = why {
            return Ok(Some(damaged(index, why, false)));
        }
        let differs = checksum != 0 && computed.is_some_and(|computed| computed != checksum);
        Ok(differs.then(|| {
            let why = "something between the chunks is damaged: the checksum of the data \
                       does not match";
            damaged(0..start, why, self.is_unchunked)
        }))
    }

    fn unreadable(&self, source: io::Error) -> Cut {
        Cut::Unreadable {
            after: self.position,
            source,
        }
    }
}

/// It may still be a recording, if records follow.
const NO_MAGIC: &str = "the magic number is wrong";

/// Either the file was cut off, or the length is damaged.
const TOO_LONG: &str = "a record claims more bytes than there are";

/// The record at `position` of a chunk: opcode, body, and where it ends.
fn framed(chunk: &[u8], position: usize) -> Option<(u8, &[u8], usize)> {
    let bytes = chunk.get(position..)?;
    let (opcode, length) = framing::head(bytes)?;
    let length = usize::try_from(length).ok()?;
    let body = bytes.get(HEAD_BYTES..)?.get(..length)?;
    Some((opcode, body, position + HEAD_BYTES + length))
}

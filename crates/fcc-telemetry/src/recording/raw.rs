//! MCAP records one after the other, from a file of which nothing is believed:
//! no length it claims is allocated before it is known to be there, and nothing
//! of a chunk is handed on before its checksum holds.
//!
//! The `mcap` crate's own reader (0.26) panics on some lengths that no writer
//! writes, and allocates what a file claims: it is used for files of our own
//! making only, in tests.

use std::fs::File;
use std::io::{self, BufReader, Read};

use mcap::records::{Record, op};

use super::chunk;
use super::parse::parse;

/// No record of ours is longer: a chunk is 1 MiB, a configuration less.
pub(super) const MAX_RECORD_BYTES: u64 = 16 << 20;

/// Opcode and length.
const HEAD_BYTES: usize = 1 + 8;

/// Where and why there is no more to read in a file that did not say it was
/// over.
#[derive(thiserror::Error, Debug)]
pub(super) enum Cut {
    /// The file ends here: whoever wrote it got no further.
    #[error("cut off after {0} bytes")]
    Off(u64),
    /// What is here is not what was written.
    #[error("damaged before byte {before}: {why}")]
    Damaged {
        /// Where the damage ends.
        before: u64,
        /// What is wrong.
        why: String,
    },
    /// The system could not read what is here.
    #[error("unreadable after {after} bytes: {source}")]
    Unreadable {
        /// What was read.
        after: u64,
        /// What the system said.
        source: io::Error,
    },
}

/// Reads the records of a file one after the other, with those of its chunks,
/// from the header to the footer. Indexes are passed over.
pub(super) struct RawReader {
    file: BufReader<File>,
    /// How long the file was at first: what is appended later is left.
    length: u64,
    position: u64,
    /// The record at hand, without its opcode and length.
    body: Vec<u8>,
    /// The chunk at hand, and how far it is read.
    chunk: Vec<u8>,
    chunk_position: usize,
}

impl RawReader {
    pub(super) fn new(file: File) -> io::Result<Self> {
        Ok(Self {
            length: file.metadata()?.len(),
            file: BufReader::with_capacity(64 << 10, file),
            position: 0,
            body: Vec::new(),
            chunk: Vec::new(),
            chunk_position: 0,
        })
    }

    /// Bytes read so far, for who shows progress.
    pub(super) const fn bytes_read(&self) -> u64 {
        self.position
    }

    /// Hands the next record to `take`; none after the footer of a whole file.
    ///
    /// # Errors
    /// Where the file is cut or damaged; there is no use in going on then.
    pub(super) fn next<T>(&mut self, take: impl FnOnce(Record<'_>) -> T) -> Result<Option<T>, Cut> {
        if self.position == 0 {
            self.read_magic()?;
        }
        loop {
            if self.chunk_position < self.chunk.len() {
                let (opcode, body, end) = framed(&self.chunk, self.chunk_position)
                    .ok_or_else(|| self.damaged("a chunk's records overlap its end"))?;
                self.chunk_position = end;
                let record = parse(opcode, body).map_err(|why| self.damaged(why))?;
                return Ok(Some(take(record)));
            }
            let opcode = self.read_record()?;
            match opcode {
                op::CHUNK => self.open_chunk()?,
                op::FOOTER => {
                    self.read_magic()?;
                    return Ok(None);
                }
                op::HEADER
                | op::SCHEMA
                | op::CHANNEL
                | op::MESSAGE
                | op::ATTACHMENT
                | op::METADATA => {
                    let record = parse(opcode, &self.body).map_err(|why| self.damaged(why))?;
                    return Ok(Some(take(record)));
                }
                _ => {}
            }
        }
    }

    fn read_magic(&mut self) -> Result<(), Cut> {
        self.read_body(mcap::MAGIC.len() as u64)?;
        if self.body == mcap::MAGIC {
            Ok(())
        } else {
            Err(self.damaged("it is no MCAP file"))
        }
    }

    /// Reads the next record of the file; gives its opcode.
    fn read_record(&mut self) -> Result<u8, Cut> {
        self.read_body(HEAD_BYTES as u64)?;
        let head = self
            .body
            .split_first_chunk::<1>()
            .and_then(|(opcode, rest)| {
                let length = rest.first_chunk::<8>()?;
                Some((opcode[0], u64::from_le_bytes(*length)))
            });
        let Some((opcode, length)) = head else {
            return Err(self.cut_off());
        };
        if length > MAX_RECORD_BYTES {
            return Err(self.damaged(&format!("a record claims {length} bytes")));
        }
        self.read_body(length)?;
        Ok(opcode)
    }

    fn read_body(&mut self, length: u64) -> Result<(), Cut> {
        let end = self.position.saturating_add(length);
        if end > self.length {
            return Err(self.cut_off());
        }
        self.body.resize(length as usize, 0);
        self.file
            .read_exact(&mut self.body)
            .map_err(|source| Cut::Unreadable {
                after: self.position,
                source,
            })?;
        self.position = end;
        Ok(())
    }

    fn open_chunk(&mut self) -> Result<(), Cut> {
        self.chunk.clear();
        self.chunk_position = 0;
        let opened = match parse(op::CHUNK, &self.body) {
            Ok(Record::Chunk { header, data }) => chunk::open(&header, &data, &mut self.chunk),
            Ok(_) => Ok(()),
            Err(why) => Err(why.to_owned()),
        };
        opened.map_err(|why| {
            self.chunk.clear();
            self.damaged(&why)
        })
    }

    fn cut_off(&self) -> Cut {
        Cut::Off(self.length)
    }

    fn damaged(&self, why: &str) -> Cut {
        Cut::Damaged {
            before: self.position,
            why: why.to_owned(),
        }
    }
}

/// The record at a place in a chunk: opcode, body, and where it ends.
fn framed(chunk: &[u8], position: usize) -> Option<(u8, &[u8], usize)> {
    let (head, rest) = chunk.get(position..)?.split_first_chunk::<HEAD_BYTES>()?;
    let [opcode, length @ ..] = *head;
    let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
    let body = rest.get(..length)?;
    Some((opcode, body, position + HEAD_BYTES + length))
}

//! MCAP records one after the other, from a file of which nothing is believed.

use std::fs::File;
use std::io::Read;

use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record, records};

/// No record of ours is longer: a chunk is 1 MiB, a configuration less. What a
/// file claims beyond is refused before any memory is taken for it.
const MAX_RECORD_BYTES: usize = 16 << 20;
/// How much of a file is read at once.
const READ_BYTES: usize = 64 << 10;

/// Reads the records of a file one after the other, with those of its chunks.
pub(super) struct RawReader {
    file: File,
    reader: LinearReader,
    bytes_read: u64,
}

/// Why there are no more records in a file that did not say it was over.
pub(super) type Broken = String;

impl RawReader {
    pub(super) fn new(file: File) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(MAX_RECORD_BYTES);
        Self {
            file,
            reader: LinearReader::new_with_options(options),
            bytes_read: 0,
        }
    }

    /// Hands the next record to `take`.
    ///
    /// # Errors
    /// Where the file is cut or damaged; there are no records after that.
    pub(super) fn next<T>(
        &mut self,
        take: impl FnOnce(records::Record<'_>) -> T,
    ) -> Result<Option<T>, Broken> {
        loop {
            match self.reader.next_event() {
                None => return Ok(None),
                Some(Err(error)) => return Err(self.broken(&error)),
                Some(Ok(LinearReadEvent::ReadRequest(_))) => {}
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    return match parse_record(opcode, data) {
                        Ok(record) => Ok(Some(take(record))),
                        Err(error) => {
                            Err(format!("damaged within {} bytes: {error}", self.bytes_read))
                        }
                    };
                }
            }
            // However much the record claims to want: what there is of it.
            let into = self.reader.insert(READ_BYTES);
            match self.file.read(into) {
                Ok(read) => {
                    self.bytes_read += read as u64;
                    self.reader.notify_read(read);
                }
                Err(error) => return Err(format!("reading failed: {error}")),
            }
        }
    }

    fn broken(&self, error: &McapError) -> Broken {
        match error {
            McapError::UnexpectedEof => {
                format!("cut off after {} bytes", self.bytes_read)
            }
            error => format!("damaged within {} bytes: {error}", self.bytes_read),
        }
    }

    /// Bytes read so far, for who shows progress.
    pub(super) const fn bytes_read(&self) -> u64 {
        self.bytes_read
    }
}

//! The content of an MCAP chunk.

use std::io::{self, Read};

use mcap::records::ChunkHeader;

use super::framing::MAX_RECORD_BYTES;

/// The window of a chunk that was compressed at once is the whole chunk. It
/// bounds the decompression memory, whatever the file claims.
const MAX_WINDOW_LOG2: u32 = MAX_RECORD_BYTES.ilog2();

/// Decompresses a chunk into `records` and verifies its length and checksum.
pub(super) fn open(header: &ChunkHeader, data: &[u8], records: &mut Vec<u8>) -> Result<(), String> {
    let length = header.uncompressed_size;
    if length > MAX_RECORD_BYTES {
        return Err(format!("a chunk claims {length} bytes"));
    }
    // One byte more detects data beyond the claimed length.
    let limit = length + 1;
    let unpacked = match header.compression.as_str() {
        "" => data.take(limit).read_to_end(records),
        "lz4" => lz4::Decoder::new(data).and_then(|from| from.take(limit).read_to_end(records)),
        "zstd" => zstd(data).and_then(|from| from.take(limit).read_to_end(records)),
        other => {
            return Err(format!(
                "a chunk is compressed by {other}, which is not supported"
            ));
        }
    };
    unpacked.map_err(|error| format!("a chunk cannot be decompressed: {error}"))?;
    if records.len() as u64 != length {
        return Err("a chunk's length does not match its content".to_owned());
    }
    let sum = header.uncompressed_crc;
    if sum != 0 && crc32fast::hash(records) != sum {
        return Err("a chunk's checksum does not match".to_owned());
    }
    Ok(())
}

fn zstd(data: &[u8]) -> io::Result<zstd::Decoder<'_, &[u8]>> {
    let mut from = zstd::Decoder::with_buffer(data)?;
    from.window_log_max(MAX_WINDOW_LOG2)?;
    Ok(from)
}

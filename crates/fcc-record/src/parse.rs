//! Parses one MCAP record from untrusted bytes: no length is used before that
//! many bytes are there.

use std::borrow::Cow;
use std::collections::BTreeMap;

use mcap::records::{
    AttachmentHeader, Channel, ChunkHeader, ChunkIndex, DataEnd, Footer, Header, MessageHeader,
    Metadata, MetadataIndex, Record, SchemaHeader, op,
};

/// Parses a record without its opcode and length. Kinds that no reader here
/// uses are returned as unknown.
///
/// # Errors
/// What is wrong with it, as text.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, &'static str> {
    record(opcode, &mut Fields(body)).ok_or("a record is shorter than it claims")
}

/// As [`parse`], for a record outside of the chunks, which no checksum
/// protects: its lengths must add up to its own, and its kind must be allowed
/// there.
///
/// # Errors
/// What is wrong with it, as text.
pub(super) fn parse_outside(opcode: u8, body: &[u8]) -> Result<Record<'_>, &'static str> {
    let fields = &mut Fields(body);
    let record = match opcode {
        op::HEADER
        | op::CHUNK
        | op::METADATA
        | op::ATTACHMENT
        | op::SCHEMA
        | op::CHANNEL
        | op::MESSAGE => record(opcode, fields),
        op::MESSAGE_INDEX => message_index(fields),
        op::DATA_END => fields
            .u32()
            .map(|data_section_crc| Record::DataEnd(DataEnd { data_section_crc })),
        _ => return Err("a record of a kind that is not allowed here"),
    };
    let record = record.ok_or("a record is shorter than it claims")?;
    if !fields.0.is_empty() {
        return Err("a record is longer than its content");
    }
    match &record {
        Record::Attachment { crc, .. } if *crc != 0 => {
            let (covered, _) = body.split_at(body.len().saturating_sub(4));
            if crc32fast::hash(covered) != *crc {
                return Err("an attachment's checksum does not match");
            }
        }
        _ => {}
    }
    Ok(record)
}

/// Only its lengths; nothing else is used.
fn message_index<'a>(fields: &mut Fields<'a>) -> Option<Record<'a>> {
    fields.u16()?;
    let length = fields.u32()?;
    let data = Cow::Borrowed(fields.take(length.into())?);
    (length % 16 == 0).then_some(Record::Unknown {
        opcode: op::MESSAGE_INDEX,
        data,
    })
}

/// Whether the beginning of a chunk gives a total of `length` bytes and a
/// supported compression.
pub(super) fn is_chunk_of(beginning: &[u8], length: u64) -> bool {
    let fields = &mut Fields(beginning);
    chunk_header(fields).is_some_and(|header| {
        let header_bytes = (beginning.len() - fields.0.len()) as u64;
        matches!(header.compression.as_str(), "" | "lz4" | "zstd")
            && header.compressed_size.checked_add(header_bytes) == Some(length)
    })
}

fn chunk_header(fields: &mut Fields<'_>) -> Option<ChunkHeader> {
    Some(ChunkHeader {
        message_start_time: fields.u64()?,
        message_end_time: fields.u64()?,
        uncompressed_size: fields.u64()?,
        uncompressed_crc: fields.u32()?,
        compression: fields.string()?,
        compressed_size: fields.u64()?,
    })
}

fn record<'a>(opcode: u8, fields: &mut Fields<'a>) -> Option<Record<'a>> {
    Some(match opcode {
        op::HEADER => Record::Header(Header {
            profile: fields.string()?,
            library: fields.string()?,
        }),
        op::FOOTER => Record::Footer(Footer {
            summary_start: fields.u64()?,
            summary_offset_start: fields.u64()?,
            summary_crc: fields.u32()?,
        }),
        op::SCHEMA => Record::Schema {
            header: SchemaHeader {
                id: fields.u16()?,
                name: fields.string()?,
                encoding: fields.string()?,
            },
            data: {
                let length = fields.u32()?;
                Cow::Borrowed(fields.take(length.into())?)
            },
        },
        op::CHANNEL => Record::Channel(Channel {
            id: fields.u16()?,
            schema_id: fields.u16()?,
            topic: fields.string()?,
            message_encoding: fields.string()?,
            metadata: fields.map()?,
        }),
        op::MESSAGE => Record::Message {
            header: MessageHeader {
                channel_id: fields.u16()?,
                sequence: fields.u32()?,
                log_time: fields.u64()?,
                publish_time: fields.u64()?,
            },
            data: Cow::Borrowed(std::mem::take(&mut fields.0)),
        },
        op::CHUNK => {
            let header = chunk_header(fields)?;
            let data = Cow::Borrowed(fields.take(header.compressed_size)?);
            Record::Chunk { header, data }
        }
        op::ATTACHMENT => {
            let header = AttachmentHeader {
                log_time: fields.u64()?,
                create_time: fields.u64()?,
                name: fields.string()?,
                media_type: fields.string()?,
            };
            let length = fields.u64()?;
            Record::Attachment {
                header,
                data: Cow::Borrowed(fields.take(length)?),
                crc: fields.u32()?,
            }
        }
        op::METADATA => Record::Metadata(Metadata {
            name: fields.string()?,
            metadata: fields.map()?,
        }),
        op::CHUNK_INDEX => Record::ChunkIndex(ChunkIndex {
            message_start_time: fields.u64()?,
            message_end_time: fields.u64()?,
            chunk_start_offset: fields.u64()?,
            chunk_length: fields.u64()?,
            // The rest is not used.
            message_index_offsets: BTreeMap::new(),
            message_index_length: 0,
            compression: String::new(),
            compressed_size: 0,
            uncompressed_size: 0,
        }),
        op::METADATA_INDEX => Record::MetadataIndex(MetadataIndex {
            offset: fields.u64()?,
            length: fields.u64()?,
            name: fields.string()?,
        }),
        _ => Record::Unknown {
            opcode,
            data: Cow::Borrowed(fields.0),
        },
    })
}

/// The unread part of a record: little-endian numbers, and strings and maps
/// preceded by their length in bytes.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, length: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(length).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn string(&mut self) -> Option<String> {
        let length = self.u32()?;
        let bytes = self.take(length.into())?;
        Some(String::from_utf8_lossy(bytes).into_owned())
    }

    fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let length = self.u32()?;
        let mut entries = Fields(self.take(length.into())?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            map.insert(entries.string()?, entries.string()?);
        }
        Some(map)
    }
}

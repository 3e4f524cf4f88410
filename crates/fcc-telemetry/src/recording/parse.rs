//! One record of MCAP from its bytes, of which nothing is believed: no length
//! that it claims is taken before so many bytes are there.

use std::borrow::Cow;
use std::collections::BTreeMap;

use mcap::records::{
    AttachmentHeader, Channel, ChunkHeader, Footer, Header, MessageHeader, Metadata, MetadataIndex,
    Record, SchemaHeader, op,
};

/// A record without its opcode and length. Kinds that no reader here asks for
/// come as unknown.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, &'static str> {
    record(opcode, &mut Fields(body)).ok_or("a record is shorter than it claims")
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
            data: Cow::Borrowed(fields.0),
        },
        op::CHUNK => {
            let header = ChunkHeader {
                message_start_time: fields.u64()?,
                message_end_time: fields.u64()?,
                uncompressed_size: fields.u64()?,
                uncompressed_crc: fields.u32()?,
                compression: fields.string()?,
                compressed_size: fields.u64()?,
            };
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

/// What is left of a record: little-endian numbers, and strings and maps after
/// their lengths in bytes.
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

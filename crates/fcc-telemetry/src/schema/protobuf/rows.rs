//! Decodes untrusted messages into rows, by a description of their columns.

use std::collections::BTreeMap;

use fcc_core::framework::Time;

use super::decode::{DecodeError, Wire, split, unzigzag};
use crate::schema::words::put;
use crate::schema::{DescribedColumn, RecordDescription};

/// Decodes messages of a described record into its rows.
#[derive(Debug)]
pub struct RowDecoder {
    fields: Fields,
    bytes: usize,
    /// The offsets of the times of readings: never, where there is no reading.
    taken: Vec<usize>,
}

/// The fields of a message, by their numbers.
type Fields = BTreeMap<u32, Content>;

#[derive(Debug)]
enum Content {
    /// A value in a row: its offset, its bytes, and whether it is signed.
    Value(usize, usize, bool),
    Message(Fields),
}

impl RowDecoder {
    /// A decoder of this record.
    pub fn new(description: &RecordDescription) -> Self {
        let mut fields = Fields::new();
        for column in &description.columns {
            add(&mut fields, column, &column.numbers);
        }
        let is_taken = |column: &&DescribedColumn| {
            let reading = column.reading.as_deref();
            let field = reading.and_then(|reading| column.path.strip_prefix(reading));
            field == Some(".taken") && column.layout() == Some(('i', size_of::<u64>()))
        };
        let columns = description.columns.iter();
        Self {
            fields,
            bytes: description.row_bytes,
            taken: columns
                .filter(is_taken)
                .map(|column| column.offset)
                .collect(),
        }
    }

    /// The words of a row.
    pub const fn words(&self) -> usize {
        self.bytes / size_of::<u64>()
    }

    /// Decodes a message into a row of words, which are 0 before.
    ///
    /// # Errors
    /// When the bytes are not a message of this type.
    pub fn decode(&self, message: &[u8], row: &mut [u64]) -> Result<(), DecodeError> {
        let never = Time::NEVER.as_nanos() as u64;
        for offset in &self.taken {
            put(row, *offset, size_of::<u64>(), never);
        }
        fill(&self.fields, message, row).ok_or(DecodeError::Damaged)
    }
}

fn add(fields: &mut Fields, column: &DescribedColumn, numbers: &[u32]) {
    match (numbers, column.layout()) {
        ([number], Some((letter, bytes))) => {
            let value = Content::Value(column.offset, bytes, letter == 'i');
            fields.insert(*number, value);
        }
        ([number, inner @ ..], _) => {
            let message = Content::Message(Fields::new());
            if let Content::Message(fields) = fields.entry(*number).or_insert(message) {
                add(fields, column, inner);
            }
        }
        _ => {}
    }
}

fn fill(fields: &Fields, message: &[u8], row: &mut [u64]) -> Option<()> {
    let mut found = Vec::with_capacity(16);
    split(message, &mut found)?;
    for (number, wire) in found {
        let bits = match (fields.get(&number), wire) {
            // Derived from others, or of a later version.
            (None, _) => continue,
            (Some(Content::Message(inner)), Wire::Bytes(bytes)) => {
                fill(inner, bytes, row)?;
                continue;
            }
            (Some(Content::Message(_)), _) | (_, Wire::Bytes(_)) => return None,
            (Some(Content::Value(_, _, true)), Wire::Varint(value)) => unzigzag(value) as u64,
            (_, Wire::Varint(bits) | Wire::Fixed64(bits)) => bits,
            (_, Wire::Fixed32(bits)) => bits.into(),
        };
        if let Some(Content::Value(offset, bytes, _)) = fields.get(&number) {
            put(row, *offset, *bytes, bits);
        }
    }
    Some(())
}

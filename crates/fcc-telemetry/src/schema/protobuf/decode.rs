//! Decodes untrusted bytes.

use fcc_core::framework::schema::{Field, Kind, Schema, Source, Type, Unknown, Value};
use prost::encoding::{WireType, decode_key, decode_varint};

/// Why bytes cannot be decoded as a message of a type.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum DecodeError {
    /// They are not a message, or a field has another type.
    #[error("its bytes are not a message")]
    Damaged,
    /// A value is not one of those declared.
    #[error(transparent)]
    Unknown(#[from] Unknown),
}

/// Decodes a struct.
///
/// # Errors
/// When the bytes are not a message of this type.
pub fn decode<T: Schema>(bytes: &[u8]) -> Result<T, DecodeError> {
    let mut decoder = Decoder {
        fields: Vec::with_capacity(64),
        open: Vec::with_capacity(8),
        root: bytes,
        damaged: false,
    };
    let value = T::from_source(&mut decoder);
    if decoder.damaged {
        return Err(DecodeError::Damaged);
    }
    Ok(value?)
}

/// The value of a field in a message.
#[derive(Clone, Copy)]
pub(super) enum Wire<'a> {
    Varint(u64),
    Fixed64(u64),
    Fixed32(u32),
    Bytes(&'a [u8]),
}

/// Appends the fields of a message, each with its number; none if the bytes are
/// no message.
pub(super) fn split<'a>(mut bytes: &'a [u8], fields: &mut Vec<(u32, Wire<'a>)>) -> Option<()> {
    while !bytes.is_empty() {
        let (number, wire_type) = decode_key(&mut bytes).ok()?;
        let wire = match wire_type {
            WireType::Varint => Wire::Varint(decode_varint(&mut bytes).ok()?),
            WireType::SixtyFourBit => {
                let (taken, rest) = bytes.split_first_chunk()?;
                bytes = rest;
                Wire::Fixed64(u64::from_le_bytes(*taken))
            }
            WireType::ThirtyTwoBit => {
                let (taken, rest) = bytes.split_first_chunk()?;
                bytes = rest;
                Wire::Fixed32(u32::from_le_bytes(*taken))
            }
            WireType::LengthDelimited => {
                let length = usize::try_from(decode_varint(&mut bytes).ok()?).ok()?;
                let (taken, rest) = bytes.split_at_checked(length)?;
                bytes = rest;
                Wire::Bytes(taken)
            }
            WireType::StartGroup | WireType::EndGroup => return None,
        };
        fields.push((number, wire));
    }
    Some(())
}

/// A signed number from its encoding, in which small numbers are short.
pub(super) const fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

struct Decoder<'a> {
    /// The fields of the messages begun and not ended.
    fields: Vec<(u32, Wire<'a>)>,
    /// Index of the first field of each; none for a message that is missing.
    open: Vec<Option<usize>>,
    root: &'a [u8],
    damaged: bool,
}

impl<'a> Decoder<'a> {
    /// A field of the present message; the last, if there are several.
    fn find(&self, number: u32) -> Option<Wire<'a>> {
        let first = (*self.open.last()?)?;
        let fields = self.fields.get(first..)?;
        let found = fields.iter().rfind(|(known, _)| *known == number);
        found.map(|(_, wire)| *wire)
    }
}

impl Source for Decoder<'_> {
    fn begin(&mut self, field: &'static Field) {
        let bytes = if self.open.is_empty() {
            Some(self.root)
        } else {
            match self.find(field.number) {
                None => None,
                Some(Wire::Bytes(bytes)) => Some(bytes),
                Some(_) => {
                    self.damaged = true;
                    None
                }
            }
        };
        let first = self.fields.len();
        self.open.push(bytes.map(|_| first));
        if bytes.is_some_and(|bytes| split(bytes, &mut self.fields).is_none()) {
            self.damaged = true;
        }
    }

    fn end(&mut self, _: &'static Field) {
        if let Some(Some(first)) = self.open.pop() {
            self.fields.truncate(first);
        }
    }

    fn value(&mut self, field: &'static Field) -> Option<Value> {
        // Every value of a missing message is the default.
        (*self.open.last()?)?;
        let Type::Leaf(kind) = field.of else {
            return None;
        };
        let found = self.find(field.number);
        let value = match (kind, found) {
            (Kind::Number | Kind::Instant, None) => return None,
            (kind, None) => Value::from_bits(kind, 0),
            (Kind::Number, Some(Wire::Fixed64(bits))) => Some(Value::Number(f64::from_bits(bits))),
            (Kind::Instant, Some(Wire::Fixed64(bits))) => Some(Value::Instant(bits as i64)),
            (Kind::Flags, Some(Wire::Fixed64(bits))) => Some(Value::Flags(bits)),
            // As written while a set had up to 32 conditions.
            (Kind::Flags, Some(Wire::Fixed32(bits))) => Some(Value::Flags(bits.into())),
            (Kind::Bool, Some(Wire::Varint(value))) => Some(Value::Bool(value != 0)),
            (Kind::Code(_), Some(Wire::Varint(value))) => {
                Some(Value::Code(u8::try_from(value).unwrap_or(u8::MAX)))
            }
            (Kind::Count(_), Some(Wire::Varint(value))) => Some(Value::Count(value)),
            (Kind::Signed(_), Some(Wire::Varint(value))) => Some(Value::Signed(unzigzag(value))),
            _ => None,
        };
        self.damaged |= value.is_none();
        value
    }

    fn variant(&mut self, _: &'static Field) -> Option<u32> {
        let first = (*self.open.last()?)?;
        self.fields.get(first..)?.last().map(|(number, _)| *number)
    }
}

//! Encodes structs as messages.

use fcc_core::framework::schema::{Field, Schema, Sink, Type, Value};
use prost::encoding::{self, WireType, encode_key, encode_varint, encoded_len_varint};

/// Appends a struct as a message. A reading that was never taken, and whose
/// value is zero, is not in it.
pub fn encode<T: Schema>(value: &T, into: &mut Vec<u8>) {
    value.visit(&mut Encoder {
        into,
        open: Vec::with_capacity(8),
    });
}

/// Appends a text to a message, as the field with this number.
pub fn append_text(number: u32, text: &str, into: &mut Vec<u8>) {
    encode_key(number, WireType::LengthDelimited, into);
    encode_varint(text.len() as u64, into);
    into.extend_from_slice(text.as_bytes());
}

struct Encoder<'a> {
    into: &'a mut Vec<u8>,
    /// The messages begun and not ended.
    open: Vec<Open>,
}

struct Open {
    /// Offset of its key.
    key: usize,
    /// Offset of its first field.
    start: usize,
    /// Whether it is written even if empty, to select the field of a choice.
    is_choice: bool,
    /// Whether a value in it is neither zero nor never.
    has_value: bool,
}

impl Sink for Encoder<'_> {
    fn begin(&mut self, field: &'static Field) {
        let key = self.into.len();
        if field.number > 0 {
            encode_key(field.number, WireType::LengthDelimited, self.into);
        }
        self.open.push(Open {
            key,
            start: self.into.len(),
            is_choice: matches!(field.of, Type::Choice(_)),
            has_value: false,
        });
    }

    /// A message is preceded by its length, which is known at its end.
    fn end(&mut self, field: &'static Field) {
        let Some(ended) = self.open.pop() else {
            return;
        };
        let Open { key, start, .. } = ended;
        if let Some(around) = self.open.last_mut() {
            around.has_value |= ended.has_value;
        }
        if field.number == 0 {
            return;
        }
        if !ended.has_value && matches!(field.of, Type::Struct(of) if of.is_reading) {
            self.into.truncate(key);
            return;
        }
        let end = self.into.len();
        let length = (end - start) as u64;
        let room = encoded_len_varint(length);
        encode_varint(length, self.into);
        if let Some(moved) = self.into.get_mut(start..end + room) {
            moved.rotate_right(room);
        }
    }

    fn value(&mut self, field: &'static Field, value: Value) {
        let is_zero = value.is_never() || value.bits() == 0 && !matches!(value, Value::Instant(_));
        if let Some(open) = self.open.last_mut() {
            open.has_value |= !is_zero;
        }
        let said_by_absence = !self.open.last().is_some_and(|open| open.is_choice);
        let (number, into) = (field.number, &mut *self.into);
        match value {
            Value::Number(value) => encoding::double::encode(number, &value, into),
            Value::Instant(value) => encoding::sfixed64::encode(number, &value, into),
            value if value.bits() == 0 && said_by_absence => {}
            Value::Bool(value) => encoding::bool::encode(number, &value, into),
            Value::Code(value) => encoding::uint32::encode(number, &value.into(), into),
            Value::Flags(value) => encoding::fixed64::encode(number, &value, into),
            Value::Count(value) => encoding::uint64::encode(number, &value, into),
            Value::Signed(value) => encoding::sint64::encode(number, &value, into),
        }
    }

    fn derived(&mut self, field: &'static Field, value: f64) {
        encoding::double::encode(field.number, &value, self.into);
    }
}

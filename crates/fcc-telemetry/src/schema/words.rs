//! A struct as 64-bit words, with no undefined bytes between the fields: equal
//! structs have equal words.

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Source, Type, Unknown, Value};

const WORD: usize = size_of::<u64>();

/// The number of words of a `T`.
pub const fn words<T>() -> usize {
    size_of::<T>().div_ceil(WORD)
}

/// Writes a struct into words; bytes between its fields, and words beyond the
/// first [`words`], are left as they are.
pub fn write_words<T: Schema>(value: &T, words: &mut [u64]) {
    value.visit(&mut Writer { words, offset: 0 });
}

/// The struct in these words, which another process may have written.
///
/// # Errors
/// When a value is not one of those declared.
pub fn read_words<T: Schema>(words: &[u64]) -> Result<T, Unknown> {
    T::from_source(&mut Reader { words, offset: 0 })
}

/// Writes the lowest `bytes` bytes of a value at an offset that is a multiple of
/// them; without effect beyond the end.
pub(super) fn put(words: &mut [u64], offset: usize, bytes: usize, bits: u64) {
    let shift = shift(offset, bytes);
    let mask = u64::MAX >> (8 * (WORD - bytes));
    if let Some(word) = words.get_mut(offset / WORD) {
        *word = *word & !(mask << shift) | (bits & mask) << shift;
    }
}

/// The bits in the word before a value. No value is in two words, because each
/// is aligned to its size.
const fn shift(offset: usize, bytes: usize) -> usize {
    let before = offset % WORD;
    8 * if cfg!(target_endian = "big") {
        WORD - before - bytes
    } else {
        before
    }
}

const fn kind(field: &Field) -> Option<Kind> {
    match field.of {
        Type::Leaf(kind) => Some(kind),
        _ => None,
    }
}

struct Writer<'a> {
    words: &'a mut [u64],
    /// Offset of the struct being written.
    offset: usize,
}

impl Sink for Writer<'_> {
    fn begin(&mut self, field: &'static Field) {
        self.offset += field.offset;
    }

    fn end(&mut self, field: &'static Field) {
        self.offset -= field.offset;
    }

    fn value(&mut self, field: &'static Field, value: Value) {
        if let Some(kind) = kind(field) {
            let offset = self.offset + field.offset;
            put(self.words, offset, kind.bytes(), value.bits());
        }
    }
}

struct Reader<'a> {
    words: &'a [u64],
    /// Offset of the struct being read.
    offset: usize,
}

impl Source for Reader<'_> {
    fn begin(&mut self, field: &'static Field) {
        self.offset += field.offset;
    }

    fn end(&mut self, field: &'static Field) {
        self.offset -= field.offset;
    }

    fn value(&mut self, field: &'static Field) -> Option<Value> {
        let kind = kind(field)?;
        let offset = self.offset + field.offset;
        let word = self.words.get(offset / WORD)?;
        let bits = *word >> shift(offset, kind.bytes());
        // Invalid bits give an undeclared code.
        Some(Value::from_bits(kind, bits).unwrap_or(Value::Code(u8::MAX)))
    }
}

//! A struct as 64-bit words, with no undefined bytes between the fields: equal
//! structs have equal words.

use std::marker::PhantomData;

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Source, Type, Unknown, Value};

const WORD: usize = size_of::<u64>();

/// The 64-bit words of `T`. Another process may have written any bits: they are
/// read as a `T` only if every value is a declared one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(transparent)]
pub struct Words<T, const N: usize> {
    words: [u64; N],
    of: PhantomData<fn() -> T>,
}

/// The number of words of a `T`.
pub const fn words<T>() -> usize {
    size_of::<T>().div_ceil(WORD)
}

impl<T: Schema, const N: usize> Words<T, N> {
    /// The words of a struct.
    pub fn of(value: &T) -> Self {
        const { assert!(N == words::<T>(), "the words of the struct") };
        let mut words = [0; N];
        write_words(value, &mut words);
        Self {
            words,
            of: PhantomData,
        }
    }

    /// The struct in these words.
    ///
    /// # Errors
    /// When a value is not one of those declared.
    pub fn get(&self) -> Result<T, Unknown> {
        T::from_source(&mut Memory {
            words: &mut self.words.clone(),
            offset: 0,
        })
    }

    /// The words themselves.
    pub const fn as_words(&self) -> &[u64; N] {
        &self.words
    }
}

/// Writes a struct into words that are 0; those beyond the first
/// [`words`] stay so.
pub fn write_words<T: Schema>(value: &T, words: &mut [u64]) {
    value.visit(&mut Memory { words, offset: 0 });
}

struct Memory<'a> {
    words: &'a mut [u64],
    /// Offset of the struct being written or read.
    offset: usize,
}

impl Memory<'_> {
    /// The word that contains a field, and the bits before it. No field is in
    /// two words, because each is aligned to its size.
    fn place(&mut self, field: &Field) -> Option<(&mut u64, usize)> {
        let at = self.offset + field.offset;
        let bytes_before = at % WORD;
        let shift = if cfg!(target_endian = "big") {
            WORD - bytes_before - kind(field)?.bytes()
        } else {
            bytes_before
        };
        Some((self.words.get_mut(at / WORD)?, 8 * shift))
    }
}

const fn kind(field: &Field) -> Option<Kind> {
    match field.of {
        Type::Leaf(kind) => Some(kind),
        _ => None,
    }
}

impl Sink for Memory<'_> {
    fn begin(&mut self, field: &'static Field) {
        self.offset += field.offset;
    }

    fn end(&mut self, field: &'static Field) {
        self.offset -= field.offset;
    }

    fn value(&mut self, field: &'static Field, value: Value) {
        let bits = match value {
            // Sign bits beyond the value's own bytes belong to other fields.
            Value::Signed(signed) => {
                let above = 64 - 8 * kind(field).map_or(WORD, |kind| kind.bytes()) as u32;
                (signed as u64) << above >> above
            }
            value => value.bits(),
        };
        if let Some((word, shift)) = self.place(field) {
            *word |= bits << shift;
        }
    }
}

impl Source for Memory<'_> {
    fn begin(&mut self, field: &'static Field) {
        self.offset += field.offset;
    }

    fn end(&mut self, field: &'static Field) {
        self.offset -= field.offset;
    }

    fn value(&mut self, field: &'static Field) -> Option<Value> {
        let kind = kind(field)?;
        let (word, shift) = self.place(field)?;
        // Invalid bits give an undeclared code.
        Some(Value::from_bits(kind, *word >> shift).unwrap_or(Value::Code(u8::MAX)))
    }
}

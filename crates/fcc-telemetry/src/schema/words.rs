//! A struct as the words of its memory, with nothing undefined between the
//! fields: two equal structs have the same words.

use std::marker::PhantomData;

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Source, Type, Unknown, Value};

const WORD: usize = size_of::<u64>();

/// The words of `T`: what another process wrote may be anything, and is read
/// back as a `T` only if every value of it is one that is declared.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(transparent)]
pub struct Words<T, const N: usize> {
    words: [u64; N],
    of: PhantomData<fn() -> T>,
}

/// How many words a `T` takes.
pub const fn words<T>() -> usize {
    size_of::<T>().div_ceil(WORD)
}

impl<T: Schema, const N: usize> Words<T, N> {
    /// The words of a struct.
    pub fn of(value: &T) -> Self {
        const { assert!(N == words::<T>(), "as many words as the struct takes") };
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
    /// When a value is none of those that are declared.
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
    /// Of the struct that is being written or read.
    offset: usize,
}

impl Memory<'_> {
    /// The word that a field lies in, and the bits before it: no field lies
    /// across two words, as each is aligned to its size.
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
            // Sign bits beyond the value's own bytes are others' room.
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
        // Bits that are no value are none that is declared.
        Some(Value::from_bits(kind, *word >> shift).unwrap_or(Value::Code(u8::MAX)))
    }
}

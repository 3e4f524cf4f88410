//! Text of a fixed size.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// At most `N` bytes of UTF-8, padded with zeros: text in shared memory.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Text<const N: usize>([u8; N]);

impl<const N: usize> Text<N> {
    /// As much of the text as fits.
    pub fn new(words: &str) -> Self {
        let room = words
            .char_indices()
            .map(|(at, letter)| at + letter.len_utf8())
            .take_while(|end| *end <= N)
            .last()
            .unwrap_or(0);
        let mut bytes = [0; N];
        for (byte, letter) in bytes.iter_mut().zip(words.bytes().take(room)) {
            *byte = letter;
        }
        Self(bytes)
    }

    /// These bytes, as another program may have written them.
    #[cfg(fuzzing)]
    pub(crate) const fn of_bytes(bytes: [u8; N]) -> Self {
        Self(bytes)
    }

    /// The text. Another program may have written anything: it ends at the
    /// first byte that is zero or invalid UTF-8.
    pub fn as_str(&self) -> &str {
        let words = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        match std::str::from_utf8(words) {
            Ok(words) => words,
            Err(error) => words
                .get(..error.valid_up_to())
                .and_then(|valid| std::str::from_utf8(valid).ok())
                .unwrap_or_default(),
        }
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(f)
    }
}

impl<const N: usize> Serialize for Text<N> {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_str(self.as_str())
    }
}

impl<'de, const N: usize> Deserialize<'de> for Text<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Ok(Self::new(&String::deserialize(from)?))
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn no_character_is_cut_in_two() {
        // "µ" takes two bytes.
        assert_eq!(Text::<4>::new("10 µs").as_str(), "10 ");
        assert_eq!(Text::<5>::new("10 µs").as_str(), "10 µ");
        assert_eq!(Text::<6>::new("10 µs").as_str(), "10 µs");
        assert_eq!(Text::<0>::new("words").as_str(), "");
    }

    proptest! {
        #[test]
        fn any_bytes_are_read(bytes: [u8; 16]) {
            let read = Text(bytes);
            let words = read.as_str();
            prop_assert!(bytes.starts_with(words.as_bytes()));
            prop_assert!(!words.contains('\0'));
        }

        #[test]
        fn text_is_read_back(words in "[^\0]{0,8}") {
            let text = Text::<32>::new(&words);
            prop_assert_eq!(text.as_str(), words);
        }
    }
}

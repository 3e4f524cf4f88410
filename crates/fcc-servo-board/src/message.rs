//! X-Plane's messages, as X-Plane reads and writes them. All numbers are
//! little-endian.
//!
//! A path may end at its first NUL or with the message, so the padding that
//! X-Plane requires over UDP is [left out](shortened) on a serial line.

use core::fmt;

/// Four letters, and a byte that is NUL in what is sent to X-Plane.
pub(crate) const HEADER_BYTES: usize = 5;
const ROW_BYTES: usize = 36;
const PAIR_BYTES: usize = 8;
/// In a row: leave it as it is.
const AS_IT_IS: f32 = -999.0;

/// Why a message has no effect.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum NotForBoard {
    /// It is another message, or was cut off.
    Unknown,
    /// Its dataref or row is none of the board's.
    NoSuchValue,
    /// Its value is not finite.
    NotFinite,
    /// Another computer holds control.
    Stranger,
    /// Control of what it writes has not been taken.
    NotHeld,
    /// There is no room for another subscription.
    Full,
}

impl fmt::Display for NotForBoard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "the message is unknown or cut off",
            Self::NoSuchValue => "the board has no such value",
            Self::NotFinite => "the value is not finite",
            Self::Stranger => "another computer holds control",
            Self::NotHeld => "control was not taken before: set the override first",
            Self::Full => "there are too many subscriptions",
        })
    }
}

impl core::error::Error for NotForBoard {}

/// A message to the board.
#[derive(Clone, Debug)]
pub(crate) enum Request<'a> {
    /// RREF: send this value so many times a second under this index; 0 ends it.
    Subscribe {
        frequency_hz: i32,
        index: i32,
        path: &'a [u8],
    },
    /// DREF: set this value.
    Write { path: &'a [u8], value: f32 },
    /// DATA: set the columns of rows.
    Rows(Rows<'a>),
}

impl<'a> Request<'a> {
    pub(crate) fn parse(message: &'a [u8]) -> Result<Self, NotForBoard> {
        Self::read(message).ok_or(NotForBoard::Unknown)
    }

    fn read(message: &'a [u8]) -> Option<Self> {
        let (header, body) = message.split_first_chunk::<HEADER_BYTES>()?;
        match header {
            b"RREF\0" => {
                let (frequency_hz, body) = body.split_first_chunk::<4>()?;
                let (index, path) = body.split_first_chunk::<4>()?;
                Some(Self::Subscribe {
                    frequency_hz: i32::from_le_bytes(*frequency_hz),
                    index: i32::from_le_bytes(*index),
                    path: up_to_nul(path)?,
                })
            }
            b"DREF\0" => {
                let (value, path) = body.split_first_chunk::<4>()?;
                Some(Self::Write {
                    path: up_to_nul(path)?,
                    value: f32::from_le_bytes(*value),
                })
            }
            b"DATA\0" => {
                let (rows, rest) = body.as_chunks::<ROW_BYTES>();
                rest.is_empty().then(|| Self::Rows(Rows(rows.iter())))
            }
            _ => None,
        }
    }
}

/// A path that is not empty.
fn up_to_nul(path: &[u8]) -> Option<&[u8]> {
    let path = path.split(|byte| *byte == 0).next()?;
    (!path.is_empty()).then_some(path)
}

/// The rows of DATA: an index and eight columns each, `None` for one that is to
/// be left as it is.
#[derive(Clone, Debug)]
pub(crate) struct Rows<'a>(core::slice::Iter<'a, [u8; ROW_BYTES]>);

impl Iterator for Rows<'_> {
    type Item = (i32, [Option<f32>; 8]);

    fn next(&mut self) -> Option<Self::Item> {
        let (index, columns) = self.0.next()?.split_first_chunk::<4>()?;
        let (columns, _) = columns.as_chunks::<4>();
        let mut values = columns.iter().map(|column| {
            let value = f32::from_le_bytes(*column);
            // Exactly this number is sent; it is not computed.
            (value.to_bits() != AS_IT_IS.to_bits()).then_some(value)
        });
        Some((
            i32::from_le_bytes(*index),
            core::array::from_fn(|_| values.next().flatten()),
        ))
    }
}

/// A reply to RREF, written into the caller's buffer.
#[derive(Debug)]
pub(crate) struct Reply<'a> {
    into: &'a mut [u8],
    length: usize,
}

impl<'a> Reply<'a> {
    /// None if the buffer is shorter than a header.
    pub(crate) fn begin(into: &'a mut [u8]) -> Option<Self> {
        // The fifth byte is X-Plane's own; that of X-Plane 11.
        into.get_mut(..HEADER_BYTES)?.copy_from_slice(b"RREF,");
        Some(Self {
            into,
            length: HEADER_BYTES,
        })
    }

    /// Adds a value, if there is room for it.
    pub(crate) fn add(&mut self, index: i32, value: f32) {
        let room = self.into.get_mut(self.length..);
        if let Some((pair, _)) = room.and_then(|room| room.split_first_chunk_mut::<PAIR_BYTES>()) {
            let bytes = index.to_le_bytes().into_iter().chain(value.to_le_bytes());
            for (place, byte) in pair.iter_mut().zip(bytes) {
                *place = byte;
            }
            self.length += PAIR_BYTES;
        }
    }

    /// The message; none if it has no value.
    pub(crate) fn end(self) -> Option<&'a [u8]> {
        let is_empty = self.length == HEADER_BYTES;
        self.into.get(..self.length).filter(|_| !is_empty)
    }
}

/// A message to the board without the padding of its path: RREF of 413 bytes and
/// DREF of 509 become as long as their path. Any other message is unchanged.
///
/// ```
/// let mut request = [0; 413];
/// request[..13].copy_from_slice(b"RREF\0\x14\0\0\0\x07\0\0\0");
/// request[13..][..15].copy_from_slice(b"sim/time/paused");
/// assert_eq!(fcc_servo_board::shortened(&request).len(), 28);
/// ```
pub fn shortened(message: &[u8]) -> &[u8] {
    let path_at = match message.first_chunk::<HEADER_BYTES>() {
        Some(b"RREF\0") => HEADER_BYTES + 8,
        Some(b"DREF\0") => HEADER_BYTES + 4,
        _ => return message,
    };
    let path = message.get(path_at..).unwrap_or_default();
    let length = path.iter().position(|byte| *byte == 0);
    let end = length.map_or(message.len(), |length| path_at + length);
    message.get(..end).unwrap_or(message)
}

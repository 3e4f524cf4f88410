//! Frames on a serial line.
//!
//! A frame is a sequence number (1 byte), a message, and the CRC-32 of both (4
//! bytes, little-endian), encoded by COBS so that it contains no 0 (S. Cheshire
//! and M. Baker, *Consistent Overhead Byte Stuffing*, IEEE/ACM Transactions on
//! Networking 7(2), 1999), with a 0 before and after it. A receiver that lost
//! its place finds the next frame after the next 0.

use crc::{CRC_32_ISO_HDLC, Crc};

/// The longest message in a frame, bytes: so a frame has one byte of overhead by
/// COBS.
pub const MAX_MESSAGE: usize = 240;
const CRC_BYTES: usize = 4;
/// Sequence number, message and CRC, and COBS's one byte.
const MAX_ENCODED: usize = 1 + MAX_MESSAGE + CRC_BYTES + 1;
/// The longest frame with its two delimiters, bytes.
pub const MAX_FRAME: usize = MAX_ENCODED + 2;

/// That of Ethernet and zlib; of "123456789" it is 0xCBF43926.
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Puts messages into frames, and numbers them.
#[derive(Clone, Debug, Default)]
pub struct Encoder {
    sequence: u8,
}

impl Encoder {
    /// The first frame has number 0.
    pub const fn new() -> Self {
        Self { sequence: 0 }
    }

    /// The frame of a message, in the caller's buffer; `None` if the message is
    /// longer than [`MAX_MESSAGE`].
    pub fn frame<'a>(&mut self, message: &[u8], into: &'a mut [u8; MAX_FRAME]) -> Option<&'a [u8]> {
        let mut plain = [0; 1 + MAX_MESSAGE + CRC_BYTES];
        let body = plain.get_mut(..=message.len())?;
        let (sequence, text) = body.split_first_mut()?;
        *sequence = self.sequence;
        text.copy_from_slice(message);
        let crc = CRC.checksum(body).to_le_bytes();
        let end = 1 + message.len() + CRC_BYTES;
        plain.get_mut(1 + message.len()..end)?.copy_from_slice(&crc);
        // The delimiters are 0.
        into.fill(0);
        let room = into.get_mut(1..=MAX_ENCODED)?;
        let encoded = cobs::try_encode(plain.get(..end)?, room).ok()?;
        self.sequence = self.sequence.wrapping_add(1);
        into.get(..encoded + 2)
    }
}

/// What was received over a serial line, each count from 0 again after 2³² - 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct LineCounts {
    /// Frames with the right checksum.
    pub received: u32,
    /// What was between two delimiters and was no frame: its checksum is wrong, or
    /// it is too short or too long.
    pub corrupt: u32,
    /// Frames that did not arrive, by their numbers. A sender that was started
    /// again counts as up to 255.
    pub lost: u32,
}

/// Finds the frames in received bytes.
#[derive(Clone, Debug)]
pub struct Decoder {
    /// What arrived since the last delimiter.
    buffer: [u8; MAX_ENCODED],
    /// Its length; beyond the buffer's while more arrived.
    length: usize,
    /// The number of the next frame; none before the first one.
    next: Option<u8>,
    counts: LineCounts,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// Waits for a frame.
    pub const fn new() -> Self {
        Self {
            buffer: [0; MAX_ENCODED],
            length: 0,
            next: None,
            counts: LineCounts {
                received: 0,
                corrupt: 0,
                lost: 0,
            },
        }
    }

    /// What was received so far.
    pub const fn counts(&self) -> LineCounts {
        self.counts
    }

    /// The line was interrupted: what arrived of a frame is dropped, and a gap in
    /// the numbers is not counted.
    pub const fn reset(&mut self) {
        self.length = 0;
        self.next = None;
    }

    /// Takes the next byte; returns the message, if that byte completes a frame.
    pub fn push(&mut self, byte: u8) -> Option<&[u8]> {
        if byte != 0 {
            if let Some(place) = self.buffer.get_mut(self.length) {
                *place = byte;
            }
            self.length = self.length.saturating_add(1);
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if length == 0 {
            return None;
        }
        let Some((sequence, end)) = self.decode(length) else {
            self.counts.corrupt = self.counts.corrupt.wrapping_add(1);
            return None;
        };
        let lost = self.next.map_or(0, |next| sequence.wrapping_sub(next));
        self.next = Some(sequence.wrapping_add(1));
        self.counts.lost = self.counts.lost.wrapping_add(lost.into());
        self.counts.received = self.counts.received.wrapping_add(1);
        self.buffer.get(1..end)
    }

    /// The number of the frame in the buffer, and where its message ends there.
    fn decode(&mut self, length: usize) -> Option<(u8, usize)> {
        let encoded = self.buffer.get_mut(..length)?;
        let plain_length = cobs::decode_in_place(encoded).ok()?;
        let plain = self.buffer.get(..plain_length)?;
        let (body, crc) = plain.split_last_chunk::<CRC_BYTES>()?;
        let (sequence, _) = body.split_first()?;
        (CRC.checksum(body) == u32::from_le_bytes(*crc)).then_some((*sequence, body.len()))
    }
}

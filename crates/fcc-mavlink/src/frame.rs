//! Frames of MAVLink: found in bytes, and made.
//!
//! What arrives stays raw: a value that an enum does not have is no reason to lose a message
//! that needs an answer. Layout: mavlink.io, "Packet Serialization".

use mavlink::dialects::common::MavMessage;
use mavlink::{MavlinkVersion, Message as _, calculate_crc};

/// The longest frame: of version 2, signed.
const LONGEST: usize = 280;
const MAGIC_V1: u8 = 0xFE;
const MAGIC_V2: u8 = 0xFD;
/// Of `incompat_flags`: a signature follows. No other flag is known.
pub(crate) const SIGNED: u8 = 1;
/// Link, time stamp and the first 48 bits of a hash.
pub(crate) const SIGNATURE_BYTES: usize = 13;
const CRC_BYTES: usize = 2;
const HEADER_V1: usize = 6;
const HEADER_V2: usize = 10;

/// A frame whose checksum is right.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Frame {
    pub(crate) is_v2: bool,
    pub(crate) sequence: u8,
    pub(crate) system: u8,
    pub(crate) component: u8,
    pub(crate) id: u32,
    pub(crate) payload: Fields,
    /// All of its bytes.
    pub(crate) bytes: Vec<u8>,
}

impl Frame {
    /// The signature, and what it is the signature of.
    pub(crate) fn signature(&self) -> Option<(&[u8], &[u8])> {
        let is_signed = self.is_v2 && self.bytes.get(2)? & SIGNED != 0;
        let at = self.bytes.len().checked_sub(SIGNATURE_BYTES)?;
        is_signed.then(|| self.bytes.split_at(at))
    }
}

/// The fields of a payload by their offset; what was cut off at its end is 0.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Fields(Vec<u8>);

impl Fields {
    pub(crate) fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        for (to, from) in bytes.iter_mut().zip(self.0.iter().skip(at)) {
            *to = *from;
        }
        bytes
    }

    pub(crate) fn u8(&self, at: usize) -> u8 {
        let [byte] = self.bytes(at);
        byte
    }

    pub(crate) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.bytes(at))
    }

    pub(crate) fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.bytes(at))
    }

    pub(crate) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes(at))
    }

    pub(crate) fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.bytes(at))
    }

    pub(crate) fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.bytes(at))
    }

    pub(crate) fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.bytes(at))
    }
}

/// Finds frames in the bytes of a link. At most one frame's bytes are kept.
#[derive(Debug, Default)]
pub(crate) struct Deframer(Vec<u8>);

enum Found {
    Frame(Frame, usize),
    More,
    None,
}

impl Deframer {
    /// Takes bytes in pieces of any size; what is no frame is skipped byte by byte.
    pub(crate) fn push(&mut self, bytes: &[u8], mut take: impl FnMut(Frame)) {
        self.0.extend_from_slice(bytes);
        let mut rest = self.0.as_slice();
        while !rest.is_empty() {
            match find(rest) {
                Found::Frame(frame, length) => {
                    take(frame);
                    rest = rest.get(length..).unwrap_or_default();
                }
                Found::More => break,
                Found::None => rest = rest.get(1..).unwrap_or_default(),
            }
        }
        let done = self.0.len() - rest.len();
        self.0.drain(..done);
    }

    /// Forgets an unfinished frame: a datagram is whole.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

fn find(bytes: &[u8]) -> Found {
    let (header, is_v2) = match bytes.first() {
        Some(&MAGIC_V1) => (HEADER_V1, false),
        Some(&MAGIC_V2) => (HEADER_V2, true),
        _ => return Found::None,
    };
    if bytes.len() < header {
        return Found::More;
    }
    let at = |n: usize| bytes.get(n).copied().unwrap_or(0);
    if is_v2 && at(2) & !SIGNED != 0 {
        return Found::None;
    }
    let signature = if is_v2 && at(2) & SIGNED != 0 {
        SIGNATURE_BYTES
    } else {
        0
    };
    let payload_end = header + usize::from(at(1));
    let length = payload_end + CRC_BYTES + signature;
    debug_assert!(length <= LONGEST, "a length is a byte");
    let Some(whole) = bytes.get(..length) else {
        return Found::More;
    };
    let id = if is_v2 {
        u32::from_le_bytes([at(7), at(8), at(9), 0])
    } else {
        at(5).into()
    };
    let checked = whole.get(1..payload_end).unwrap_or_default();
    let crc = u16::from_le_bytes([at(payload_end), at(payload_end + 1)]);
    if calculate_crc(checked, MavMessage::extra_crc(id)) != crc {
        return Found::None;
    }
    let first = if is_v2 { 4 } else { 2 };
    let payload = whole.get(header..payload_end).unwrap_or_default();
    let frame = Frame {
        is_v2,
        sequence: at(first),
        system: at(first + 1),
        component: at(first + 2),
        id,
        payload: Fields(payload.to_vec()),
        bytes: whole.to_vec(),
    };
    Found::Frame(frame, length)
}

/// A message to send: what a frame has besides its header.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Body {
    pub(crate) id: u32,
    extra_crc: u8,
    payload: Vec<u8>,
}

impl From<MavMessage> for Body {
    fn from(message: MavMessage) -> Self {
        let mut payload = [0; 255];
        let length = message.ser(MavlinkVersion::V2, &mut payload);
        let id = message.message_id();
        let payload = payload.get(..length).unwrap_or_default();
        Self::raw(id, MavMessage::extra_crc(id), payload)
    }
}

impl Body {
    /// A message that the dialect does not have, or with values that its enums do not have.
    pub(crate) fn raw(id: u32, extra_crc: u8, payload: &[u8]) -> Self {
        let zeros = payload.iter().rev().take_while(|byte| **byte == 0).count();
        // At least one byte stays.
        let length = (payload.len() - zeros).max(1);
        Self {
            id,
            extra_crc,
            payload: payload.get(..length).unwrap_or_default().to_vec(),
        }
    }

    /// Its length in a frame without signature.
    pub(crate) fn bytes(&self) -> f64 {
        (HEADER_V2 + self.payload.len() + CRC_BYTES) as f64
    }

    /// The whole frame of version 2; `sign` adds a signature to a frame that has its flag.
    pub(crate) fn frame(
        &self,
        (system, component): (u8, u8),
        sequence: u8,
        sign: Option<impl FnOnce(&mut Vec<u8>)>,
    ) -> Vec<u8> {
        let [a, b, c, _] = self.id.to_le_bytes();
        let flags = if sign.is_some() { SIGNED } else { 0 };
        let length = self.payload.len() as u8;
        let mut bytes = vec![
            MAGIC_V2, length, flags, 0, sequence, system, component, a, b, c,
        ];
        bytes.extend_from_slice(&self.payload);
        let crc = calculate_crc(bytes.get(1..).unwrap_or_default(), self.extra_crc);
        bytes.extend_from_slice(&crc.to_le_bytes());
        if let Some(sign) = sign {
            sign(&mut bytes);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heartbeat of a ground station as pymavlink 2.4.50 packs it: version 2, then 1.
    const V2: [u8; 21] = [
        0xfd, 0x09, 0x00, 0x00, 0x07, 0xff, 0xbe, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06,
        0x08, 0x00, 0x00, 0x03, 0x1f, 0x99,
    ];

    fn found(pieces: &[&[u8]]) -> Vec<Frame> {
        let (mut deframer, mut frames) = (Deframer::default(), Vec::new());
        for piece in pieces {
            deframer.push(piece, |frame| frames.push(frame));
        }
        frames
    }

    #[test]
    fn a_frame_of_another_program_is_found_in_any_pieces() {
        for cut in 0..V2.len() {
            let (a, b) = V2.split_at(cut);
            let frames = found(&[&[0xfd, 0x00, 0x7e], a, b]);
            assert_eq!(frames.len(), 1, "cut at {cut}");
            assert_eq!((frames[0].system, frames[0].component), (255, 190));
            assert_eq!(frames[0].payload.u8(4), 6, "MAV_TYPE_GCS");
        }
    }

    #[test]
    fn a_changed_byte_makes_it_none() {
        for n in 0..V2.len() {
            let mut changed = V2;
            changed[n] ^= 0x10;
            assert!(found(&[&changed, &[0; LONGEST]]).is_empty(), "byte {n}");
        }
    }
}

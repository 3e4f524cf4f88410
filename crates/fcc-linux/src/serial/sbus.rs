//! Futaba's SBUS: 16 channels and two flags, every 7 or 14 ms, at 100,000 baud
//! with 8 data bits, even parity, two stop bits and inverted levels.
//!
//! Futaba publishes no specification; frames and flags as in the description of
//! Bolder Flight Systems (github.com/bolderflight/sbus).

use super::channels::{ReceiverFrame, unpack};
use super::{Begin, Protocol};

const FRAME: usize = 25;
const HEADER: u8 = 0x0f;
const FRAME_LOST: u8 = 0x04;
const FAILSAFE: u8 = 0x08;
/// Channels 17 and 18 and the two above: the others are always 0.
const KNOWN_FLAGS: u8 = 0x0f;
/// The last byte of SBUS, and of the four kinds of frames of SBUS 2.
const ENDS: [u8; 5] = [0x00, 0x04, 0x14, 0x24, 0x34];

/// The protocol. It has no checksum: only the silence between two frames
/// ([`Frames::restart`](super::Frames::restart)) tells with certainty where one
/// begins.
#[derive(Clone, Copy, Debug)]
pub struct Sbus;

impl Protocol for Sbus {
    type Frame = ReceiverFrame;

    const LONGEST: usize = FRAME;

    fn begin(bytes: &[u8]) -> Begin<ReceiverFrame> {
        if bytes.first() != Some(&HEADER) {
            return Begin::Noise;
        }
        let Some([_, channels @ .., flags, end]) = bytes.first_chunk::<FRAME>() else {
            return Begin::Incomplete;
        };
        if !ENDS.contains(end) || flags & !KNOWN_FLAGS != 0 {
            return Begin::Damaged;
        }
        let frame = ReceiverFrame::Channels {
            channels: unpack(channels),
            is_lost: flags & FRAME_LOST != 0,
            is_failsafe: flags & FAILSAFE != 0,
        };
        Begin::Frame(frame, FRAME)
    }
}

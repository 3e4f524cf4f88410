//! Crossfire (CRSF), of the receivers of TBS and many others: 16 channels and the
//! quality of the link, at 420,000 baud.
//!
//! By TBS' specification (github.com/tbs-fpv/tbs-crsf-spec, 2024): frames in
//! "Broadcast Frame", 0x14 and 0x16, the checksum in "CRC".

use super::channels::{ReceiverFrame, unpack};
use super::{Begin, Protocol};

/// The first byte of what a receiver sends; in older ones the address of the
/// flight controller, which is the same.
const SYNC: u8 = 0xc8;
/// Before the payload: sync, length and type; after it the checksum. The length
/// counts type, payload and checksum.
const HEADER: usize = 3;
const CHANNELS_PACKED: u8 = 0x16;
const LINK_STATISTICS: u8 = 0x14;
/// Types that are used, with the length of their payloads.
const KNOWN: [(u8, usize); 2] = [(CHANNELS_PACKED, 22), (LINK_STATISTICS, 10)];
/// Of the statistics' payload: the share of packets that the receiver got, %.
const UPLINK_QUALITY: usize = 2;

/// The protocol, as far as it is used.
#[derive(Clone, Copy, Debug)]
pub struct Crsf;

impl Protocol for Crsf {
    type Frame = ReceiverFrame;

    const LONGEST: usize = HEADER + 22 + 1;

    fn begin(bytes: &[u8]) -> Begin<ReceiverFrame> {
        let known = |at: usize, expected: u8| bytes.get(at).is_none_or(|byte| *byte == expected);
        let is = |(kind, payload): &&(u8, usize)| {
            known(0, SYNC) && known(1, *payload as u8 + 2) && known(2, *kind)
        };
        let Some((kind, payload)) = KNOWN.iter().find(is) else {
            return Begin::Noise;
        };
        let length = HEADER + payload + 1;
        let Some([_, _, checked @ .., sent]) = bytes.get(..length) else {
            return Begin::Incomplete;
        };
        if crc8(checked) != *sent {
            return Begin::Damaged;
        }
        let payload = checked.get(1..).unwrap_or_default();
        let frame = if *kind == CHANNELS_PACKED {
            ReceiverFrame::Channels {
                channels: unpack(payload),
                is_lost: false,
                is_failsafe: false,
            }
        } else {
            ReceiverFrame::Link {
                quality_percent: payload.get(UPLINK_QUALITY).copied().unwrap_or_default(),
            }
        };
        Begin::Frame(frame, length)
    }
}

/// CRC-8 with the polynomial 0xD5, as of DVB-S2, over type and payload.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc: u8, _| {
            let shifted = crc << 1;
            if crc & 0x80 != 0 {
                shifted ^ 0xd5
            } else {
                shifted
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-8/DVB-S2 in G. Cook's *Catalogue of parametrised CRC
    /// algorithms*.
    #[test]
    fn the_checksum_is_dvb_s2s() {
        assert_eq!(crc8(b"123456789"), 0xbc);
    }
}

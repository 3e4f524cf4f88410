//! u-blox's binary protocol: position, velocity and time (UBX-NAV-PVT), and how
//! a receiver is configured to send it.
//!
//! By the *u-blox F9 HPG 1.32 interface description* (UBX-22008968): frames in
//! 3.2, the checksum in 3.4, the messages in 3.10 to 3.15, the configuration
//! items in 6.9.

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::schema::in_range;

use super::{Begin, Protocol};

const SYNC: [u8; 2] = [0xb5, 0x62];
/// Before the payload: sync, class, identifier, length; after it the checksum.
const HEADER: usize = 6;
const CHECKSUM: usize = 2;
/// Class and identifier.
const NAV_PVT: [u8; 2] = [0x01, 0x07];
const ACK_NAK: [u8; 2] = [0x05, 0x00];
const ACK_ACK: [u8; 2] = [0x05, 0x01];
const CFG_VALSET: [u8; 2] = [0x06, 0x8a];
const NAV_PVT_LENGTH: usize = 92;
const ACK_LENGTH: usize = 2;

/// The protocol, as far as it is used.
#[derive(Clone, Copy, Debug)]
pub struct Ubx;

/// A message of the receiver.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum UbxMessage {
    /// Position, velocity and time.
    NavPvt(NavPvt),
    /// Whether it accepted the configuration that was sent.
    Configured(bool),
}

/// Position, velocity and time of one navigation epoch.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NavPvt {
    /// GPS time of week of the epoch, ms.
    pub time_of_week_ms: u32,
    /// 0 none, 1 dead reckoning, 2 two-dimensional, 3 three-dimensional, 4 with
    /// dead reckoning, 5 time only.
    pub fix_type: u8,
    /// Whether the receiver vouches for the fix: it is within its limits of
    /// accuracy, and the position is valid.
    pub is_valid: bool,
    /// What is used of it, valid or not.
    pub fix: GnssFix,
}

impl NavPvt {
    /// The fix, if it is valid and has an altitude that was measured: of a
    /// two-dimensional one it is assumed, and dead reckoning measures nothing.
    pub fn usable(&self) -> Option<GnssFix> {
        (self.is_valid && matches!(self.fix_type, 3 | 4)).then_some(self.fix)
    }
}

impl Protocol for Ubx {
    type Frame = UbxMessage;

    const LONGEST: usize = HEADER + NAV_PVT_LENGTH + CHECKSUM;

    fn begin(bytes: &[u8]) -> Begin<UbxMessage> {
        let known = |at: usize, expected: u8| bytes.get(at).is_none_or(|byte| *byte == expected);
        let is = |[class, id]: [u8; 2], length: usize| {
            let header = [SYNC[0], SYNC[1], class, id, length as u8, 0];
            (0..HEADER).zip(header).all(|(at, byte)| known(at, byte))
        };
        let length = if is(NAV_PVT, NAV_PVT_LENGTH) {
            NAV_PVT_LENGTH
        } else if is(ACK_ACK, ACK_LENGTH) || is(ACK_NAK, ACK_LENGTH) {
            ACK_LENGTH
        } else {
            return Begin::Noise;
        };
        let Some(frame) = bytes.get(..HEADER + length + CHECKSUM) else {
            return Begin::Incomplete;
        };
        let Some((body, sent)) = frame.split_last_chunk::<CHECKSUM>() else {
            return Begin::Damaged;
        };
        let (head, payload) = body.split_at(HEADER);
        if checksum(body.get(SYNC.len()..).unwrap_or_default()) != *sent {
            return Begin::Damaged;
        }
        let message = if length == NAV_PVT_LENGTH {
            let possible = nav_pvt(payload).filter(|pvt| in_range(&pvt.fix.position));
            match possible {
                Some(pvt) => UbxMessage::NavPvt(pvt),
                None => return Begin::Damaged,
            }
        } else if payload == CFG_VALSET {
            UbxMessage::Configured(head.get(2..4) == Some(&ACK_ACK))
        } else {
            return Begin::Noise;
        };
        Begin::Frame(message, frame.len())
    }
}

/// Fletcher's with 8 bits, over class, identifier, length and payload.
fn checksum(bytes: &[u8]) -> [u8; 2] {
    bytes.iter().fold([0_u8, 0], |[a, b], byte| {
        let a = a.wrapping_add(*byte);
        [a, b.wrapping_add(a)]
    })
}

fn nav_pvt(payload: &[u8]) -> Option<NavPvt> {
    let u32_at = |at: usize| Some(u32::from_le_bytes(*payload.get(at..)?.first_chunk()?));
    let i32_at = |at: usize| u32_at(at).map(u32::cast_signed);
    let angle = |at: usize| Some((f64::from(i32_at(at)?) * 1e-7).to_radians());
    // mm and mm/s.
    let thousandths = |at: usize| Some(f64::from(i32_at(at)?) * 1e-3);
    let accuracy = |at: usize| Some(f64::from(u32_at(at)?) * 1e-3);
    let is_within_limits = payload.get(21)? & 1 != 0;
    let is_position_invalid = payload.get(78)? & 1 != 0;
    Some(NavPvt {
        time_of_week_ms: u32_at(0)?,
        fix_type: *payload.get(20)?,
        is_valid: is_within_limits && !is_position_invalid,
        fix: GnssFix {
            position: Position {
                latitude_rad: angle(28)?,
                longitude_rad: angle(24)?,
                altitude_m: thousandths(36)?,
            },
            velocity: Velocity {
                north_mps: thousandths(48)?,
                east_mps: thousandths(52)?,
                down_mps: thousandths(56)?,
            },
            horizontal_accuracy_m: accuracy(40)?,
            vertical_accuracy_m: accuracy(44)?,
            speed_accuracy_mps: accuracy(68)?,
        },
    })
}

/// An item of the configuration: its key, and its value in the key's size.
type Item<'a> = (u32, &'a [u8]);

/// From generation 9 on (protocol 27): at each of its ports, five fixes a second
/// as UBX-NAV-PVT, and no NMEA; for an aircraft with less than 2 g. Kept until
/// it is switched off. Items of ports that a receiver does not have would make it
/// refuse all, so each port has a message of its own.
pub fn configuration() -> [Vec<u8>; 3] {
    // CFG-RATE-MEAS in ms, CFG-RATE-NAV in measurements, and CFG-NAVSPG-DYNMODEL
    // (7: airborne, less than 2 g).
    let rate: [Item<'_>; 3] = [
        (0x3021_0001, &200_u16.to_le_bytes()),
        (0x3021_0002, &1_u16.to_le_bytes()),
        (0x2011_0021, &[7]),
    ];
    // CFG-MSGOUT-UBX_NAV_PVT_.., CFG-..OUTPROT-UBX, CFG-..OUTPROT-NMEA.
    let uart1: [Item<'_>; 3] = [
        (0x2091_0007, &[1]),
        (0x1074_0001, &[1]),
        (0x1074_0002, &[0]),
    ];
    let usb: [Item<'_>; 3] = [
        (0x2091_0009, &[1]),
        (0x1078_0001, &[1]),
        (0x1078_0002, &[0]),
    ];
    [valset(&rate), valset(&uart1), valset(&usb)]
}

/// UBX-CFG-VALSET, version 0, into the layer RAM (bit 0).
fn valset(items: &[Item<'_>]) -> Vec<u8> {
    let mut payload = vec![0, 1, 0, 0];
    for (key, value) in items {
        payload.extend(key.to_le_bytes());
        payload.extend(*value);
    }
    let mut frame = [SYNC, CFG_VALSET].concat();
    frame.extend((payload.len() as u16).to_le_bytes());
    frame.extend(payload);
    let sum = checksum(frame.get(SYNC.len()..).unwrap_or_default());
    frame.extend(sum);
    frame
}

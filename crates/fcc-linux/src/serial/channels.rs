//! The channels of an RC receiver.

/// How many channels a frame has.
pub const CHANNELS: usize = 16;
const BITS: usize = 11;

/// A frame of a receiver, SBUS or CRSF.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ReceiverFrame {
    /// Channels, 0 to 2047 each.
    Channels {
        /// In the receiver's order.
        channels: [u16; CHANNELS],
        /// Whether the receiver got no packet for this frame, and repeats the
        /// last channels.
        is_lost: bool,
        /// Whether it lost the transmitter, and sends what it is set to.
        is_failsafe: bool,
    },
    /// The state of the radio link.
    Link {
        /// The share of packets that arrive, 0 to 100 %; 0 if the transmitter is
        /// lost.
        quality_percent: u8,
    },
}

/// Channels of 11 bits, the lowest bit first; of bytes that are missing 0.
pub(super) fn unpack(bytes: &[u8]) -> [u16; CHANNELS] {
    core::array::from_fn(|channel| {
        (0..BITS).fold(0, |value, bit| {
            let at = channel * BITS + bit;
            let byte = bytes.get(at / 8).copied().unwrap_or_default();
            value | u16::from(byte >> (at % 8) & 1) << bit
        })
    })
}

/// A channel as a servo's pulse, µs: 992 is 1500, and 1.6 steps are 1 µs (TBS'
/// CRSF specification; SBUS has the same scale).
pub fn pulse_us(channel: u16) -> f64 {
    (f64::from(channel) - 992.0) * 0.625 + 1_500.0
}

/// A channel as a position, -1 to 1: 172 and 1811, 988 and 2012 µs, are the ends
/// of a transmitter's travel.
pub fn position(channel: u16) -> f64 {
    ((pulse_us(channel) - 1_500.0) / 512.0).clamp(-1.0, 1.0)
}

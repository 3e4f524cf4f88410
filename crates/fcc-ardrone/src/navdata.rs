//! Navdata: what the drone sends of its state.

/// Bits of the state word (developer guide, section 7.1.2).
pub(crate) mod bits {
    pub(crate) const FLIES: u32 = 1 << 0;
    pub(crate) const HOLDS_ALTITUDE: u32 = 1 << 4;
    pub(crate) const ACKNOWLEDGED: u32 = 1 << 6;
    pub(crate) const DEMO: u32 = 1 << 10;
    pub(crate) const BOOTSTRAP: u32 = 1 << 11;
    pub(crate) const LINK_LOST: u32 = 1 << 13;
    pub(crate) const BATTERY_LOW: u32 = 1 << 15;
    pub(crate) const THREADS: u32 = 0b1011 << 23;
    pub(crate) const WATCHDOG: u32 = 1 << 30;
    pub(crate) const EMERGENCY: u32 = 1 << 31;
}

/// The longest datagram that is sent, bytes.
pub const NAVDATA_BYTES: usize = HEADER_BYTES + DEMO_BYTES + CHECKSUM_BYTES;
const HEADER_BYTES: usize = 16;
const DEMO_BYTES: usize = 148;
const CHECKSUM_BYTES: usize = 8;
const HEADER: u32 = 0x5566_7788;
const CHECKSUM: u16 = 0xffff;
/// Below this the battery is low, percent.
pub(crate) const LOW_PERCENT: f64 = 20.0;

/// What it does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Flight {
    /// Stands, with its motors off.
    #[default]
    Landed,
    /// Takes off.
    TakesOff,
    /// Holds its place.
    Hovers,
    /// Follows the stick.
    Flies,
    /// Lands.
    Lands,
}

impl Flight {
    /// The number of `CTRL_STATES`.
    const fn code(self) -> u32 {
        match self {
            Self::Landed => 2,
            Self::Flies => 3,
            Self::Hovers => 4,
            Self::TakesOff => 6,
            Self::Lands => 8,
        }
    }
}

/// The state of the vehicle.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Seen {
    /// What it does.
    pub flight: Flight,
    /// Charge of the battery, 0 to 1.
    pub battery: f64,
    /// Roll, pitch, heading, rad.
    pub attitude_rad: [f64; 3],
    /// Above the take-off, m.
    pub height_m: f64,
    /// Forward, right and down along its own axes, m/s.
    pub velocity_mps: [f64; 3],
}

/// Writes a datagram; its length.
pub(crate) fn write(to: &mut [u8; NAVDATA_BYTES], state: u32, sequence: u32, seen: &Seen) -> usize {
    let mut writer = Writer { to, at: 0 };
    for word in [HEADER, state, sequence, 0] {
        writer.put(&word.to_le_bytes());
    }
    if state & bits::BOOTSTRAP == 0 {
        let begun = writer.at;
        writer.option(0, DEMO_BYTES);
        writer.put(&(seen.flight.code() << 16).to_le_bytes());
        let percent = (100.0 * seen.battery).clamp(0.0, 100.0) as u32;
        writer.put(&percent.to_le_bytes());
        let [roll, pitch, heading] = seen.attitude_rad;
        for angle_rad in [pitch, roll, heading] {
            writer.float(1e3 * angle_rad.to_degrees());
        }
        writer.put(&((1e3 * seen.height_m) as i32).to_le_bytes());
        for speed_mps in seen.velocity_mps {
            writer.float(1e3 * speed_mps);
        }
        // No picture, no tag was seen.
        writer.at = begun + DEMO_BYTES;
    }
    let sum = writer.sum();
    writer.option(CHECKSUM, CHECKSUM_BYTES);
    writer.put(&sum.to_le_bytes());
    writer.at
}

struct Writer<'a> {
    to: &'a mut [u8; NAVDATA_BYTES],
    at: usize,
}

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) {
        let end = self.at + bytes.len();
        if let Some(to) = self.to.get_mut(self.at..end) {
            to.copy_from_slice(bytes);
        }
        self.at = end;
    }

    fn option(&mut self, number: u16, bytes: usize) {
        self.put(&number.to_le_bytes());
        self.put(&(bytes as u16).to_le_bytes());
    }

    fn float(&mut self, value: f64) {
        self.put(&(value as f32).to_le_bytes());
    }

    fn sum(&self) -> u32 {
        let written = self.to.iter().take(self.at);
        written.map(|byte| u32::from(*byte)).sum()
    }
}

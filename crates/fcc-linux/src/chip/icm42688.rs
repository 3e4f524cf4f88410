//! TDK ICM-42688-P, an accelerometer and gyroscope (DS-000347, rev 1.7, 2022).
//!
//! It measures 1,000 times a second into its FIFO, which is emptied each time it
//! is asked: no sample is lost between, and the bus carries one long read and no
//! thousand short ones.

use core::time::Duration;

use embedded_hal::delay::DelayNs;

use super::inertial::{Sum, radps, word};
use super::{Chip, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// Its address with the pin `AP_AD0` to ground, and to the supply.
pub const ADDRESSES: [u8; 2] = [0x68, 0x69];

// Registers of bank 0: section 14.
const BANK: u8 = 0x76;
const WHO_AM_I: u8 = 0x75;
const WHO_AM_I_VALUE: u8 = 0x47;
const DEVICE_CONFIG: u8 = 0x11;
const RESET: u8 = 0x01;
/// `DEVICE_CONFIG`: nothing is written for 1 ms after a reset.
const RESET_US: u32 = 2_000;
const FIFO_CONFIG: u8 = 0x16;
/// New packets overwrite old ones.
const FIFO_STREAM: u8 = 0x40;
/// The status of the interrupts, and the number of bytes in the FIFO after it.
const INT_STATUS: u8 = 0x2D;
const FIFO_FULL: u8 = 0x02;
const FIFO_DATA: u8 = 0x30;
const SIGNAL_PATH_RESET: u8 = 0x4B;
const FIFO_FLUSH: u8 = 0x02;
const POWER: u8 = 0x4E;
/// Both sensors in low-noise mode.
const LOW_NOISE: u8 = 0x0F;
/// `PWR_MGMT0`: the gyroscope stays on for 45 ms at least, while it starts.
const START_MS: u32 = 50;
const GYRO_CONFIG: u8 = 0x4F;
const ACCEL_CONFIG: u8 = 0x50;
/// ±2000 °/s or ±16 g, and 1 kHz.
const WIDEST_1_KHZ: u8 = 0x06;
const INTF_CONFIG1: u8 = 0x4D;
/// What it has after a reset (0x91), but never another noise mode: at that change, near
/// 100 °/s, it repeats its samples (`ArduPilot` #25025, bits 7 and 6).
const ONE_NOISE_MODE: u8 = 0x51;
const FIFO_CONFIG1: u8 = 0x5F;
/// Packets with acceleration, turn rates and temperature: structure 3.
const FIFO_ALL: u8 = 0x07;

/// The register by which it is recognized, and what that has.
pub const IDENTIFICATION: (u8, &[u8]) = (WHO_AM_I, &[WHO_AM_I_VALUE]);

const PERIOD: Duration = Duration::from_millis(1);
/// A count of the time stamps is 1 µs of a clock that runs at 30/32 of its rate, as
/// long as no clock is given from outside ("FIFO timestamp interval scaling").
const SECONDS_PER_COUNT: f64 = 32.0 / 30.0 * 1e-6;
/// How often it is asked, unless configured otherwise.
pub const RATE_HZ: f64 = 200.0;

// Section 3.1 and 3.2: LSB in a unit, at the widest ranges.
const LSB_PER_G: f64 = 2_048.0;
const LSB_PER_DEGPS: f64 = 16.4;

/// Bytes of a packet of structure 3 (section 6.1).
const PACKET: usize = 16;
/// 2,048 bytes (section 6).
const MOST_PACKETS: usize = 128;
// Header of a packet (section 6.2).
const EMPTY: u8 = 0x80;
const HAS_BOTH: u8 = 0x60;
/// The header's bits for what its time stamp is of, and those of a measurement's.
const STAMP: u8 = 0x0C;
const STAMP_OF_SAMPLE: u8 = 0x08;
/// The header's bit of packets with 20 bytes.
const HIGH_RESOLUTION: u8 = 0x10;

/// A packet of the FIFO is none that the chip is set up for.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("its FIFO is out of step")]
pub struct PacketError;

/// The mean of the packets read from the FIFO, none if there is no valid one.
///
/// ```
/// use fcc_linux::chip::icm42688::mean_of;
///
/// // 1 g downwards, as the sensor gives it at rest, and 10 °/s about x.
/// let packet = [0x68, 0, 0, 0, 0, 0x08, 0, 0, 164, 0, 0, 0, 0, 0, 0, 0];
/// let values = mean_of(&packet)?.unwrap();
/// assert_eq!(values.specific_force_mps2, Some([0.0, 0.0, 9.80665]));
/// let [p, ..] = values.rates_radps.unwrap();
/// assert!((p.to_degrees() - 10.0).abs() < 1e-9);
/// # Ok::<(), fcc_linux::chip::icm42688::PacketError>(())
/// ```
///
/// # Errors
/// When a packet has another structure.
pub fn mean_of(fifo: &[u8]) -> Result<Option<RawValues>, PacketError> {
    let mut sum = Sum::default();
    for packet in packets(fifo) {
        let packet = packet?;
        if packet.is_measured() {
            sum.add(packet.force, packet.rates);
        }
    }
    Ok(sum.mean(LSB_PER_G, radps(LSB_PER_DEGPS)))
}

/// One measurement.
struct Packet {
    force: [i16; 3],
    rates: [i16; 3],
    /// Of its own counter, if it is stamped.
    stamp: Option<u16>,
}

impl Packet {
    /// While a sensor starts its values are -32,768 (section 6.1).
    fn is_measured(&self) -> bool {
        !self
            .force
            .iter()
            .chain(&self.rates)
            .any(|value| *value == i16::MIN)
    }
}

/// The packets of the FIFO, up to its end.
fn packets(fifo: &[u8]) -> impl Iterator<Item = Result<Packet, PacketError>> {
    let (packets, _) = fifo.as_chunks::<PACKET>();
    let packets = packets.iter().take_while(|packet| packet[0] & EMPTY == 0);
    packets.map(|packet| {
        let [header, values @ .., _temperature, stamp1, stamp0] = packet;
        if header & (HAS_BOTH | HIGH_RESOLUTION) != HAS_BOTH {
            return Err(PacketError);
        }
        let [ax1, ax0, ay1, ay0, az1, az0, gx1, gx0, gy1, gy0, gz1, gz0] = *values;
        let is_stamped = header & STAMP == STAMP_OF_SAMPLE;
        Ok(Packet {
            force: [word(ax1, ax0), word(ay1, ay0), word(az1, az0)],
            rates: [word(gx1, gx0), word(gy1, gy0), word(gz1, gz0)],
            stamp: is_stamped.then(|| u16::from_be_bytes([*stamp1, *stamp0])),
        })
    })
}

/// The chip's counter of 16 bits, which overflows 15 times a second, continued.
#[derive(Debug, Default)]
struct Counter {
    latest: Option<u16>,
    counts: u64,
}

impl Counter {
    fn follow(&mut self, stamp: u16) -> u64 {
        let passed = stamp.wrapping_sub(self.latest.unwrap_or(stamp));
        self.latest = Some(stamp);
        self.counts += u64::from(passed);
        self.counts
    }

    /// The mean time of the packets that were measured; none if one of them has no
    /// stamp.
    fn mean(&mut self, fifo: &[u8]) -> Option<Duration> {
        let (mut sum, mut number) = (0, 0);
        for packet in packets(fifo) {
            let packet = packet.ok()?;
            let counts = self.follow(packet.stamp?);
            if packet.is_measured() {
                sum += counts;
                number += 1;
            }
        }
        let mean = sum as f64 / f64::from(number);
        Duration::try_from_secs_f64(mean * SECONDS_PER_COUNT).ok()
    }
}

/// An ICM-42688-P that is set up.
#[derive(Debug)]
pub struct Icm42688<R> {
    registers: R,
    fifo: Vec<u8>,
    counter: Counter,
}

impl<R: Registers> Icm42688<R> {
    /// Recognizes the chip, resets it, and starts it.
    ///
    /// # Errors
    /// When it does not answer, is another one, or does not keep its settings.
    pub fn new(mut registers: R, delay: &mut impl DelayNs) -> Result<Self, DeviceError> {
        registers.write(BANK, 0)?;
        registers.identify("ICM-42688-P", IDENTIFICATION)?;
        registers.write(DEVICE_CONFIG, RESET)?;
        delay.delay_us(RESET_US);
        registers.configure(&[
            (GYRO_CONFIG, WIDEST_1_KHZ),
            (ACCEL_CONFIG, WIDEST_1_KHZ),
            (INTF_CONFIG1, ONE_NOISE_MODE),
            (FIFO_CONFIG1, FIFO_ALL),
            (FIFO_CONFIG, FIFO_STREAM),
            (POWER, LOW_NOISE),
        ])?;
        delay.delay_ms(START_MS);
        registers.write(SIGNAL_PATH_RESET, FIFO_FLUSH)?;
        Ok(Self {
            registers,
            fifo: vec![0; MOST_PACKETS * PACKET],
            counter: Counter::default(),
        })
    }

    /// Empties the FIFO, and reports why.
    fn flushed(&mut self, what: &'static str) -> Result<Option<Measurement>, DeviceError> {
        self.registers.write(SIGNAL_PATH_RESET, FIFO_FLUSH)?;
        Err(self.registers.malformed(what))
    }
}

impl<R: Registers> Chip for Icm42688<R> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let mut read = [0; 3];
        self.registers.read(INT_STATUS, &mut read)?;
        let [status, high, low] = read;
        if status & FIFO_FULL != 0 {
            return self.flushed("its FIFO overflowed: it was asked too late");
        }
        let packets = usize::from(u16::from_be_bytes([high, low])) / PACKET;
        let bytes = packets.min(MOST_PACKETS) * PACKET;
        let fifo = self.fifo.get_mut(..bytes).unwrap_or_default();
        if fifo.is_empty() {
            return Ok(None);
        }
        self.registers.read(FIFO_DATA, fifo)?;
        let Ok(mean) = mean_of(fifo) else {
            return self.flushed("its FIFO is out of step");
        };
        let stamp = self.counter.mean(fifo);
        Ok(mean.map(|values| Measurement {
            stamp,
            // The newest is between nothing and a period old.
            age: PERIOD * values.samples / 2,
            values,
        }))
    }
}

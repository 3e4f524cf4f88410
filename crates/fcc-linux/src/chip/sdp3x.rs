//! Sensirion SDP31, SDP32 and SDP33, differential pressure sensors (SDP3x-Digital
//! data sheet, version 1, December 2017; SDP33, version 0.1, August 2017).
//!
//! They measure a small flow through the sensor. What they give is right at an
//! absolute pressure of 966 hPa, and is to be multiplied by 966 hPa over the
//! present pressure: set `scale` in the calibration.

use std::io;

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

use super::{BusError, Chip, I2cBus, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// By the resistor at ADDR (section 5).
pub const ADDRESSES: [u8; 3] = [0x21, 0x22, 0x23];

/// How often it is asked, unless configured otherwise.
pub const RATE_HZ: f64 = 100.0;

/// Stops measuring (section 5).
const STOP: [u8; 2] = [0x3F, 0xF9];
const STOP_US: u32 = 500;
/// Measures differential pressure again and again, and gives the mean since it
/// was read last (section 5).
const START: [u8; 2] = [0x36, 0x15];
/// Until the first value.
const FIRST_MS: u32 = 10;

/// The remainder of Sensirion's checksum: x⁸ + x⁵ + x⁴ + 1, from 0xFF on
/// (section 5; its example: 0xBEEF has 0x92).
///
/// ```
/// assert_eq!(fcc_linux::chip::sdp3x::crc(&[0xBE, 0xEF]), 0x92);
/// ```
pub fn crc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0xFF, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc: u8, _| {
            let shifted = crc << 1;
            if crc & 0x80 == 0 {
                shifted
            } else {
                shifted ^ 0x31
            }
        })
    })
}

/// The pressure in Pa of nine bytes: pressure, temperature and scale, each with
/// its checksum; `None` if one of them is wrong.
///
/// ```
/// // 25 Pa of an SDP31, which has 60 LSB in a pascal.
/// let mut read = [0x05, 0xDC, 0, 0x12, 0x34, 0, 0, 60, 0];
/// for word in read.as_chunks_mut::<3>().0 {
///     word[2] = fcc_linux::chip::sdp3x::crc(&word[..2]);
/// }
/// assert_eq!(fcc_linux::chip::sdp3x::pressure_pa(&read), Some(25.0));
/// ```
pub fn pressure_pa(read: &[u8; 9]) -> Option<f64> {
    let [p1, p0, p_crc, t1, t0, t_crc, s1, s0, s_crc] = *read;
    let words = [([p1, p0], p_crc), ([t1, t0], t_crc), ([s1, s0], s_crc)];
    let is_valid = words.iter().all(|(word, expected)| crc(word) == *expected);
    let scale = i16::from_be_bytes([s1, s0]);
    (is_valid && scale > 0).then(|| f64::from(i16::from_be_bytes([p1, p0])) / f64::from(scale))
}

/// Reads the product's number (section 5).
const READ_NUMBER: [[u8; 2]; 2] = [[0x36, 0x7C], [0xE1, 0x02]];
/// The family in it: 0x0301 of the whole family (section 5).
const FAMILY: [u8; 2] = [0x03, 0x01];

/// Whether one is at an address, and does not measure: that one is recognized by
/// the checksums of its values.
///
/// # Errors
/// When nothing answers there.
pub fn is_identified<B: I2c<Error: BusError>>(bus: &mut B, address: u8) -> io::Result<bool> {
    let [first, second] = READ_NUMBER;
    let mut number = [0; 18];
    bus.write(address, &first).map_err(BusError::into_io)?;
    bus.write(address, &second).map_err(BusError::into_io)?;
    bus.read(address, &mut number).map_err(BusError::into_io)?;
    let [high, low, checksum, ..] = number;
    Ok([high, low] == FAMILY && crc(&FAMILY) == checksum)
}

/// A sensor that measures.
#[derive(Debug)]
pub struct Sdp3x<B> {
    bus: I2cBus<B>,
}

impl<B: I2c<Error: BusError>> Sdp3x<B> {
    /// Starts the sensor, and checks that it answers as one of these.
    ///
    /// # Errors
    /// When it does not answer, or another chip does.
    pub fn new(mut bus: I2cBus<B>, delay: &mut impl DelayNs) -> Result<Self, DeviceError> {
        // It may still measure, and accepts no other command then; one that does
        // not may refuse this one.
        let _ = bus.send(&STOP);
        delay.delay_us(STOP_US);
        bus.send(&START)?;
        delay.delay_ms(FIRST_MS);
        let mut sensor = Self { bus };
        sensor.measure()?;
        Ok(sensor)
    }
}

impl<B: I2c<Error: BusError>> Chip for Sdp3x<B> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let mut read = [0; 9];
        self.bus.receive(&mut read)?;
        let Some(pressure_pa) = pressure_pa(&read) else {
            return Err(self.bus.malformed("a checksum is wrong"));
        };
        Ok(Some(Measurement::now(RawValues {
            differential_pressure_pa: Some(pressure_pa),
            ..RawValues::NONE
        })))
    }
}

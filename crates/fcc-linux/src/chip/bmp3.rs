//! Bosch BMP388 and BMP390, barometers (BST-BMP388-DS001-07, rev 1.7, 2020;
//! BST-BMP390-DS002-07, rev 1.7, 2021).

use core::time::Duration;

use embedded_hal::delay::DelayNs;

use super::{Chip, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// Its address with SDO to ground, and to the supply (section 5).
pub const ADDRESSES: [u8; 2] = [0x76, 0x77];
/// By SPI one meaningless byte comes first (section 5).
pub const SPI_DUMMY_BYTES: usize = 1;

// Registers: section 4.
const CHIP_ID: u8 = 0x00;
const BMP388: u8 = 0x50;
const BMP390: u8 = 0x60;
/// The status, and the three bytes of pressure and of temperature after it.
const STATUS: u8 = 0x03;
const PRESSURE_READY: u8 = 0x20;
const POWER: u8 = 0x1B;
/// Pressure and temperature, again and again.
const POWER_NORMAL: u8 = 0x33;
const OVERSAMPLING: u8 = 0x1C;
/// Of the pressure eight times, of the temperature once: as recommended for
/// drones (section 3), and the most that takes less than 20 ms.
const OVERSAMPLING_8: u8 = 0x03;
const RATE: u8 = 0x1D;
/// The next slower one after a [`MEASUREMENT`].
const RATE_50_HZ: u8 = 0x02;
const FILTER: u8 = 0x1F;
/// None: the mean of a tick's samples is one, without delay.
const FILTER_OFF: u8 = 0x00;
const CALIBRATION: u8 = 0x31;
const CALIBRATION_BYTES: usize = 21;
const COMMAND: u8 = 0x7E;
const SOFT_RESET: u8 = 0xB6;
/// Table 2: start-up time.
const RESET_US: u32 = 2_000;

/// 234 µs, and for the pressure 392 µs and eight times 2,020 µs, for the
/// temperature 163 µs and 2,020 µs (section 3.9.2).
const MEASUREMENT: Duration = Duration::from_micros(18_969);

/// The register by which it is recognized, and what that has.
pub const IDENTIFICATION: (u8, &[u8]) = (CHIP_ID, &[BMP388, BMP390]);

/// Measurements in a second.
pub const RATE_HZ: f64 = 50.0;

/// Section 1, and a margin for its error.
const RANGE_PA: core::ops::RangeInclusive<f64> = 29_000.0..=126_000.0;

/// The numbers of a chip's calibration, as floating-point numbers (BMP390, section 8.4).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bmp3Calibration {
    t: [f64; 3],
    p: [f64; 11],
}

impl Bmp3Calibration {
    /// From the chip's memory, 0x31 to 0x45 (section 3.11).
    pub fn of(bytes: &[u8; CALIBRATION_BYTES]) -> Self {
        let [
            t1_0,
            t1_1,
            t2_0,
            t2_1,
            t3,
            p1_0,
            p1_1,
            p2_0,
            p2_1,
            p3,
            p4,
            p5_0,
            p5_1,
            p6_0,
            p6_1,
            p7,
            p8,
            p9_0,
            p9_1,
            p10,
            p11,
        ] = *bytes;
        let u16 = |low, high| f64::from(u16::from_le_bytes([low, high]));
        let i16 = |low, high| f64::from(i16::from_le_bytes([low, high]));
        let i8 = |byte| f64::from(i8::from_le_bytes([byte]));
        let two_to = |exponent: i32| libm::ldexp(1.0, exponent);
        Self {
            t: [
                u16(t1_0, t1_1) * two_to(8),
                u16(t2_0, t2_1) * two_to(-30),
                i8(t3) * two_to(-48),
            ],
            p: [
                (i16(p1_0, p1_1) - two_to(14)) * two_to(-20),
                (i16(p2_0, p2_1) - two_to(14)) * two_to(-29),
                i8(p3) * two_to(-32),
                i8(p4) * two_to(-37),
                u16(p5_0, p5_1) * two_to(3),
                u16(p6_0, p6_1) * two_to(-6),
                i8(p7) * two_to(-8),
                i8(p8) * two_to(-15),
                i16(p9_0, p9_1) * two_to(-48),
                i8(p10) * two_to(-48),
                i8(p11) * two_to(-65),
            ],
        }
    }

    /// The chip's temperature in °C (BMP390, section 8.5).
    pub fn temperature_c(&self, raw: u32) -> f64 {
        let [t1, t2, t3] = self.t;
        let above = f64::from(raw) - t1;
        above * t2 + above * above * t3
    }

    /// The pressure in Pa at a temperature of the chip (BMP390, section 8.6).
    pub fn pressure_pa(&self, raw: u32, temperature_c: f64) -> f64 {
        let [p1, p2, p3, p4, p5, p6, p7, p8, p9, p10, p11] = self.p;
        let (raw, t) = (f64::from(raw), temperature_c);
        let offset = p5 + t * (p6 + t * (p7 + t * p8));
        let sensitivity = p1 + t * (p2 + t * (p3 + t * p4));
        offset + raw * (sensitivity + raw * ((p9 + p10 * t) + raw * p11))
    }
}

/// A BMP388 or BMP390 that is set up.
#[derive(Debug)]
pub struct Bmp3<R> {
    registers: R,
    calibration: Bmp3Calibration,
}

impl<R: Registers> Bmp3<R> {
    /// Recognizes the chip, resets it, reads its calibration, and lets it
    /// measure 50 times a second.
    ///
    /// # Errors
    /// When it does not answer, is another one, or does not keep its settings.
    pub fn new(mut registers: R, delay: &mut impl DelayNs) -> Result<Self, DeviceError> {
        registers.identify("BMP388 or BMP390", IDENTIFICATION)?;
        registers.write(COMMAND, SOFT_RESET)?;
        delay.delay_us(RESET_US);
        let mut bytes = [0; CALIBRATION_BYTES];
        registers.read(CALIBRATION, &mut bytes)?;
        registers.configure(&[
            (OVERSAMPLING, OVERSAMPLING_8),
            (RATE, RATE_50_HZ),
            (FILTER, FILTER_OFF),
            (POWER, POWER_NORMAL),
        ])?;
        Ok(Self {
            registers,
            calibration: Bmp3Calibration::of(&bytes),
        })
    }
}

impl<R: Registers> Chip for Bmp3<R> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let mut read = [0; 7];
        self.registers.read(STATUS, &mut read)?;
        let [status, p0, p1, p2, t0, t1, t2] = read;
        if status & PRESSURE_READY == 0 {
            return Ok(None);
        }
        let temperature_c = self
            .calibration
            .temperature_c(u32::from_le_bytes([t0, t1, t2, 0]));
        let raw = u32::from_le_bytes([p0, p1, p2, 0]);
        let pressure_pa = self.calibration.pressure_pa(raw, temperature_c);
        if !RANGE_PA.contains(&pressure_pa) {
            return Err(self.registers.malformed("its pressure is out of its range"));
        }
        Ok(Some(Measurement {
            stamp: None,
            values: RawValues {
                static_pressure_pa: Some(pressure_pa),
                ..RawValues::NONE
            },
            age: MEASUREMENT / 2,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A BMP388, its calibration and one reading of it, and what another program
    /// computes of them: `elixir-sensors/bmp3xx`, in its tests of calibration.
    #[test]
    fn a_real_chip_and_another_program() {
        let calibration = Bmp3Calibration::of(&[
            0x23, 0x6B, 0x58, 0x49, 0xF6, 0x5C, 0xFF, 0xCE, 0xF4, 0x23, 0x00, 0xEA, 0x63, 0x6E,
            0x79, 0xF3, 0xF6, 0xAA, 0x43, 0x12, 0xC4,
        ]);
        let temperature_c = calibration.temperature_c(0x85_D8_73);
        assert!((temperature_c - 30.499_314_453_874_284).abs() < 1e-9);
        let pressure_pa = calibration.pressure_pa(0x6D_9F_97, temperature_c);
        assert!(
            (pressure_pa - 100_876.006_346_921_99).abs() < 1e-6,
            "{pressure_pa}"
        );
    }
}

//! Bosch BMP180, a barometer (BST-BMP180-DS000-09, rev 2.5, 2013).

use core::time::Duration;

use embedded_hal::delay::DelayNs;

use super::{Chip, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// Its only address: 0xEE to write, with the bit of the direction.
pub const ADDRESS: u8 = 0x77;

// Registers: table 5 and section 4.
const ID: u8 = 0xD0;
const ID_VALUE: u8 = 0x55;
const CALIBRATION: u8 = 0xAA;
const CALIBRATION_BYTES: usize = 22;
const CONTROL: u8 = 0xF4;
const OUT: u8 = 0xF6;
/// Set while it converts (`Sco`).
const CONVERTING: u8 = 0x20;
const TEMPERATURE: u8 = 0x2E;
const PRESSURE: u8 = 0x34;

/// Samples in one conversion, as a power of two (table 3): eight, with 3 Pa of
/// noise in 25.5 ms.
const OVERSAMPLING: u8 = 3;
// Table 8, conversion times.
const TEMPERATURE_US: u32 = 4_500;
const PRESSURE_US: u32 = 25_500;
/// The temperature changes slowly: it is measured with every so many pressures.
const PRESSURES_PER_TEMPERATURE: u32 = 25;

/// Table 1, and a margin for its error.
const RANGE_PA: core::ops::RangeInclusive<i32> = 29_000..=111_000;

/// The register by which it is recognized, and what that has.
pub const IDENTIFICATION: (u8, &[u8]) = (ID, &[ID_VALUE]);

/// Measurements in a second: a conversion of each takes 30 ms.
pub const RATE_HZ: f64 = 30.0;

/// The eleven numbers of a chip's calibration (table 5).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(missing_docs, reason = "the data sheet gives them no other names")]
pub struct Bmp180Calibration {
    pub ac1: i16,
    pub ac2: i16,
    pub ac3: i16,
    pub ac4: u16,
    pub ac5: u16,
    pub ac6: u16,
    pub b1: i16,
    pub b2: i16,
    pub mb: i16,
    pub mc: i16,
    pub md: i16,
}

impl Bmp180Calibration {
    /// From the chip's memory; `None` if it was not read rightly: no word is 0
    /// or 0xFFFF (section 3.4).
    pub fn of(bytes: &[u8; CALIBRATION_BYTES]) -> Option<Self> {
        let (pairs, _) = bytes.as_chunks::<2>();
        let mut words = pairs.iter().map(|pair| u16::from_be_bytes(*pair));
        let mut next = || words.next().filter(|word| !matches!(word, 0 | 0xFFFF));
        Some(Self {
            ac1: next()? as i16,
            ac2: next()? as i16,
            ac3: next()? as i16,
            ac4: next()?,
            ac5: next()?,
            ac6: next()?,
            b1: next()? as i16,
            b2: next()? as i16,
            mb: next()? as i16,
            mc: next()? as i16,
            md: next()? as i16,
        })
    }

    /// Temperature in tenths of a degree Celsius and pressure in Pa, by the
    /// integer arithmetic of the data sheet (figure 4); `None` where that has no
    /// result.
    pub fn compensated(
        &self,
        raw_temperature: i32,
        raw_pressure: i32,
        oss: u8,
    ) -> Option<(i32, i32)> {
        let wide = |word: i16| i64::from(word);
        let x1 = ((i64::from(raw_temperature) - i64::from(self.ac6)) * i64::from(self.ac5)) >> 15;
        let x2 = (wide(self.mc) << 11).checked_div(x1 + wide(self.md))?;
        let b5 = x1 + x2;
        let temperature_dc = (b5 + 8) >> 4;

        let b6 = b5 - 4_000;
        let x1 = (wide(self.b2) * ((b6 * b6) >> 12)) >> 11;
        let x2 = (wide(self.ac2) * b6) >> 11;
        let b3 = (((wide(self.ac1) * 4 + x1 + x2) << oss) + 2) / 4;
        let x1 = (wide(self.ac3) * b6) >> 13;
        let x2 = (wide(self.b1) * ((b6 * b6) >> 12)) >> 16;
        let x3 = (x1 + x2 + 2) >> 2;
        let b4 = (i64::from(self.ac4) * (x3 + 32_768)) >> 15;
        let b7 = (i64::from(raw_pressure) - b3) * (50_000 >> oss);
        // No pressure is as high: of a calibration that is none.
        let p = (b7 * 2).checked_div(b4).filter(|p| p.abs() < 1 << 24)?;
        let x1 = (p >> 8) * (p >> 8);
        let x1 = (x1 * 3_038) >> 16;
        let x2 = (-7_357 * p) >> 16;
        let pressure_pa = p + ((x1 + x2 + 3_791) >> 4);
        Some((
            i32::try_from(temperature_dc).ok()?,
            i32::try_from(pressure_pa).ok()?,
        ))
    }
}

/// A BMP180 that is set up.
#[derive(Debug)]
pub struct Bmp180<R, D> {
    registers: R,
    delay: D,
    calibration: Bmp180Calibration,
    raw_temperature: i32,
    /// Pressures until the temperature is measured again.
    pressures_left: u32,
}

impl<R: Registers, D: DelayNs> Bmp180<R, D> {
    /// Recognizes the chip, and reads its calibration.
    ///
    /// # Errors
    /// When it does not answer, or is another one.
    pub fn new(mut registers: R, delay: D) -> Result<Self, DeviceError> {
        registers.identify("BMP180", IDENTIFICATION)?;
        let mut bytes = [0; CALIBRATION_BYTES];
        registers.read(CALIBRATION, &mut bytes)?;
        let calibration = Bmp180Calibration::of(&bytes);
        Ok(Self {
            calibration: calibration
                .ok_or_else(|| registers.malformed("its calibration cannot be read"))?,
            registers,
            delay,
            raw_temperature: 0,
            pressures_left: 0,
        })
    }

    /// Starts a conversion, and waits for its result.
    fn converted(&mut self, command: u8, wait_us: u32) -> Result<[u8; 3], DeviceError> {
        self.registers.write(CONTROL, command)?;
        self.delay.delay_us(wait_us);
        if self.registers.value(CONTROL)? & CONVERTING != 0 {
            return Err(self.registers.malformed("a conversion takes too long"));
        }
        let mut out = [0; 3];
        self.registers.read(OUT, &mut out)?;
        Ok(out)
    }
}

impl<R: Registers, D: DelayNs> Chip for Bmp180<R, D> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        if self.pressures_left == 0 {
            let [high, low, _] = self.converted(TEMPERATURE, TEMPERATURE_US)?;
            self.raw_temperature = i32::from(high) << 8 | i32::from(low);
            self.pressures_left = PRESSURES_PER_TEMPERATURE;
        }
        self.pressures_left -= 1;
        let [high, low, lowest] = self.converted(PRESSURE | OVERSAMPLING << 6, PRESSURE_US)?;
        let all = i32::from(high) << 16 | i32::from(low) << 8 | i32::from(lowest);
        let raw_pressure = all >> (8 - OVERSAMPLING);
        let compensated =
            self.calibration
                .compensated(self.raw_temperature, raw_pressure, OVERSAMPLING);
        let Some((_, pressure_pa)) = compensated.filter(|(_, pa)| RANGE_PA.contains(pa)) else {
            return Err(self.registers.malformed("its pressure is out of its range"));
        };
        Ok(Some(Measurement {
            stamp: None,
            values: RawValues {
                static_pressure_pa: Some(pressure_pa.into()),
                ..RawValues::NONE
            },
            // In the middle of the conversion.
            age: Duration::from_micros(PRESSURE_US.into()) / 2,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA_SHEET: Bmp180Calibration = Bmp180Calibration {
        ac1: 408,
        ac2: -72,
        ac3: -14_383,
        ac4: 32_741,
        ac5: 32_757,
        ac6: 23_153,
        b1: 6_190,
        b2: 4,
        mb: -32_768,
        mc: -8_711,
        md: 2_868,
    };

    /// Figure 4: 15.0 °C and 69,964 Pa.
    #[test]
    fn the_example_of_the_data_sheet() {
        assert_eq!(
            DATA_SHEET.compensated(27_898, 23_843, 0),
            Some((150, 69_964))
        );
    }

    #[test]
    fn the_calibration_is_read_word_by_word() {
        let words = [
            408, 0xFFB8, 0xC7D1, 32_741, 32_757, 23_153, 6_190, 4, 0x8000, 0xDDF9, 2_868_u16,
        ];
        let mut bytes = [0; CALIBRATION_BYTES];
        for (place, word) in bytes.chunks_exact_mut(2).zip(words) {
            place.copy_from_slice(&word.to_be_bytes());
        }
        assert_eq!(Bmp180Calibration::of(&bytes), Some(DATA_SHEET));
        assert_eq!(Bmp180Calibration::of(&[0; 22]), None);
        assert_eq!(Bmp180Calibration::of(&[0xFF; 22]), None);
    }
}

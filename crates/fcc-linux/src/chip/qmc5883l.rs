//! QST QMC5883L, a magnetometer, as in many GNSS modules (QMC5883L data sheet,
//! rev 1.0, 2016).

use embedded_hal::delay::DelayNs;

use super::{Chip, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// Its only address.
pub const ADDRESS: u8 = 0x0D;

/// How often it is asked, unless configured otherwise.
pub const RATE_HZ: f64 = 100.0;

// Registers: section 9.
const DATA: u8 = 0x00;
const STATUS: u8 = 0x06;
const DATA_READY: u8 = 0x01;
const OVERFLOW: u8 = 0x02;
const CONTROL_1: u8 = 0x09;
/// Continuous, 200 Hz, ±8 G, 512 samples in one.
const CONTINUOUS: u8 = 0x1D;
const CONTROL_2: u8 = 0x0A;
const SOFT_RESET: u8 = 0x80;
const RESET_US: u32 = 1_000;
/// Recommended value of the set and reset period (section 9.2).
const PERIOD: u8 = 0x0B;
const PERIOD_VALUE: u8 = 0x01;
const CHIP_ID: u8 = 0x0D;
const CHIP_ID_VALUE: u8 = 0xFF;

/// The register by which it is recognized, and what that has.
pub const IDENTIFICATION: (u8, &[u8]) = (CHIP_ID, &[CHIP_ID_VALUE]);

/// At ±8 G (section 2).
const LSB_PER_GAUSS: f64 = 3_000.0;
const UT_PER_GAUSS: f64 = 100.0;

/// A QMC5883L that is set up.
#[derive(Debug)]
pub struct Qmc5883l<R> {
    registers: R,
}

impl<R: Registers> Qmc5883l<R> {
    /// Recognizes the chip, resets it, and starts it.
    ///
    /// # Errors
    /// When it does not answer, is another one, or does not keep its settings.
    pub fn new(mut registers: R, delay: &mut impl DelayNs) -> Result<Self, DeviceError> {
        registers.identify("QMC5883L", IDENTIFICATION)?;
        registers.write(CONTROL_2, SOFT_RESET)?;
        delay.delay_us(RESET_US);
        registers.write(PERIOD, PERIOD_VALUE)?;
        registers.configure(&[(CONTROL_1, CONTINUOUS)])?;
        Ok(Self { registers })
    }
}

impl<R: Registers> Chip for Qmc5883l<R> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let status = self.registers.value(STATUS)?;
        if status & DATA_READY == 0 {
            return Ok(None);
        }
        let mut read = [0; 6];
        self.registers.read(DATA, &mut read)?;
        if status & OVERFLOW != 0 {
            return Err(self.registers.malformed("the field is beyond its range"));
        }
        let [x0, x1, y0, y1, z0, z1] = read;
        let ut =
            |low, high| f64::from(i16::from_le_bytes([low, high])) / LSB_PER_GAUSS * UT_PER_GAUSS;
        Ok(Some(Measurement::now(RawValues {
            field_ut: Some([ut(x0, x1), ut(y0, y1), ut(z0, z1)]),
            ..RawValues::NONE
        })))
    }
}

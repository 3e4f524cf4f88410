//! TE (Measurement Specialties) 4525DO, a differential pressure sensor with 14
//! bits, as of most hobby airspeed sensors (data sheet 4525DO, 2019, and
//! "Interfacing to MEAS Digital Pressure Modules", 2016).

use embedded_hal::i2c::I2c;
use serde::{Deserialize, Serialize};

use super::{BusError, Chip, I2cBus, Measurement, Registers};
use crate::{DeviceError, RawValues};

/// Of the interface types I, J, K, 0 and 1 (ordering information).
pub const ADDRESSES: [u8; 5] = [0x28, 0x36, 0x46, 0x48, 0x49];

/// How often it is asked, unless configured otherwise.
pub const RATE_HZ: f64 = 100.0;

/// Pa in a pound-force per square inch (NIST SP 811, appendix B.8).
const PA_PER_PSI: f64 = 6_894.757;

/// The greatest count of 14 bits.
const FULL_SCALE: f64 = 16_383.0;

/// Which part of the counts is used for the range (ordering information).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputType {
    /// From 10 to 90 %.
    #[default]
    A,
    /// From 5 to 95 %.
    B,
}

impl OutputType {
    /// Where it begins, and how much it is.
    const fn part(self) -> (f64, f64) {
        match self {
            Self::A => (0.1, 0.8),
            Self::B => (0.05, 0.9),
        }
    }

    /// Pa of a count, of a sensor from -`range_psi` to `range_psi`.
    ///
    /// ```
    /// use fcc_linux::chip::ms4525do::OutputType;
    ///
    /// // Half of all counts is no pressure.
    /// assert!(OutputType::A.pressure_pa(8_191.5, 1.0).abs() < 1e-9);
    /// ```
    pub fn pressure_pa(self, count: f64, range_psi: f64) -> f64 {
        let (begin, part) = self.part();
        let of_range = (count / FULL_SCALE - begin) / part;
        (2.0 * of_range - 1.0) * range_psi * PA_PER_PSI
    }
}

/// A 4525DO. It measures all the time, and has no settings.
#[derive(Debug)]
pub struct Ms4525do<B> {
    bus: I2cBus<B>,
    output: OutputType,
    range_psi: f64,
}

impl<B: I2c<Error: BusError>> Ms4525do<B> {
    /// A sensor from -`range_psi` to `range_psi`: 1 for a 4525DO-...001DP. It
    /// has no register by which it could be recognized: it is asked once.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn new(
        mut bus: I2cBus<B>,
        output: OutputType,
        range_psi: f64,
    ) -> Result<Self, DeviceError> {
        bus.receive(&mut [0; 4])?;
        Ok(Self {
            bus,
            output,
            range_psi,
        })
    }
}

impl<B: I2c<Error: BusError>> Chip for Ms4525do<B> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let mut read = [0; 4];
        self.bus.receive(&mut read)?;
        let [high, low, ..] = read;
        // The status (interface note, section 1.6.1).
        match high >> 6 {
            0b00 => {}
            // Read before.
            0b10 => return Ok(None),
            0b11 => return Err(self.bus.malformed("it reports a fault of its bridge")),
            _ => return Err(self.bus.malformed("its status is a reserved one")),
        }
        let count = f64::from(u16::from_be_bytes([high & 0x3F, low]));
        Ok(Some(Measurement::now(RawValues {
            differential_pressure_pa: Some(self.output.pressure_pa(count, self.range_psi)),
            ..RawValues::NONE
        })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Type A: 10 % of 16,383 is 1,638, and 90 % is 14,745, as the data sheet
    /// has them in hexadecimal, 0x0666 and 0x3999; ±1 psi is ±6,894.76 Pa.
    #[test]
    fn the_ends_of_the_range() {
        for (count, pa) in [(0x0666, -6_894.757), (0x3999, 6_894.757)] {
            let found = OutputType::A.pressure_pa(f64::from(count), 1.0);
            assert!((found - pa).abs() < 1.06, "{found}");
        }
        let found = OutputType::B.pressure_pa(0.05 * 16_383.0, 2.0);
        assert!((found + 2.0 * 6_894.757).abs() < 1e-6, "{found}");
    }
}

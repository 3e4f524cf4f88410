//! `InvenSense` MPU-6050, MPU-6500, MPU-9250 and MPU-9255, accelerometers and
//! gyroscopes (PS-MPU-6000A-00 rev 3.4 and RM-MPU-6000A-00 rev 4.2, 2013;
//! RM-MPU-6500A-00 rev 2.1, RM-MPU-9250A-00 rev 1.6).
//!
//! The magnetometer within an MPU-9250 is a chip of its own, and is not read.

use core::time::Duration;

use embedded_hal::delay::DelayNs;

use super::inertial::{Sum, radps, word};
use super::{Chip, Measurement, Registers};
use crate::DeviceError;

/// Its address with AD0 to ground, and to the supply.
pub const ADDRESSES: [u8; 2] = [0x68, 0x69];

// Registers: RM-MPU-6000A-00, section 3.
const WHO_AM_I: u8 = 0x75;
const MPU_6050: u8 = 0x68;
const MPU_6500: u8 = 0x70;
const MPU_9250: u8 = 0x71;
const MPU_9255: u8 = 0x73;
const POWER: u8 = 0x6B;
const RESET: u8 = 0x80;
/// Awake, with the clock of the gyroscope's x axis (section 4.28).
const AWAKE: u8 = 0x01;
const RESET_MS: u32 = 100;
const RATE_DIVIDER: u8 = 0x19;
const FILTER: u8 = 0x1A;
const ACCELEROMETER_FILTER: u8 = 0x1D;
/// 44 Hz and 42 Hz (section 4.3), of the later chips 41 Hz.
const FILTER_42_HZ: u8 = 0x03;
/// By which acceleration and turn rates are late then (section 4.3).
const FILTER_DELAY: Duration = Duration::from_micros(4_850);
const GYRO_CONFIG: u8 = 0x1B;
const ACCEL_CONFIG: u8 = 0x1C;
/// ±1000 °/s or ±8 g.
const WIDE: u8 = 0x10;
const INT_ENABLE: u8 = 0x38;
/// The status of the interrupts, and the values after it.
const INT_STATUS: u8 = 0x3A;
const DATA_READY: u8 = 0x01;

// Sections 4.4 and 4.5.
const LSB_PER_G: f64 = 4_096.0;
const LSB_PER_DEGPS: f64 = 32.8;
/// With the filter it measures 1,000 times a second, and gives every so many.
const INTERNAL_HZ: f64 = 1_000.0;

/// The register by which it is recognized, and what that has.
pub const IDENTIFICATION: (u8, &[u8]) = (WHO_AM_I, &[MPU_6050, MPU_6500, MPU_9250, MPU_9255]);

/// Samples in a second, unless configured otherwise.
pub const RATE_HZ: f64 = 200.0;

/// A chip of the family that is set up.
#[derive(Debug)]
pub struct Mpu6050<R> {
    registers: R,
    age: Duration,
}

impl<R: Registers> Mpu6050<R> {
    /// Recognizes the chip, resets it, and starts it, with the nearest rate of
    /// 1,000 Hz over a whole number, from 4 Hz on.
    ///
    /// # Errors
    /// When it does not answer, is another one, or does not keep its settings.
    pub fn new(
        mut registers: R,
        rate_hz: f64,
        delay: &mut impl DelayNs,
    ) -> Result<Self, DeviceError> {
        let found = registers.identify("MPU-6050, 6500, 9250 or 9255", IDENTIFICATION)?;
        registers.write(POWER, RESET)?;
        delay.delay_ms(RESET_MS);
        let divider = libm::round(INTERNAL_HZ / rate_hz).clamp(1.0, 256.0);
        registers.configure(&[
            (POWER, AWAKE),
            (RATE_DIVIDER, (divider - 1.0) as u8),
            (FILTER, FILTER_42_HZ),
            (GYRO_CONFIG, WIDE),
            (ACCEL_CONFIG, WIDE),
            (INT_ENABLE, DATA_READY),
        ])?;
        // Of the MPU-6050 one register is for both.
        if found != MPU_6050 {
            registers.configure(&[(ACCELEROMETER_FILTER, FILTER_42_HZ)])?;
        }
        let half_period = Duration::from_secs_f64(divider / INTERNAL_HZ / 2.0);
        Ok(Self {
            registers,
            age: FILTER_DELAY + half_period,
        })
    }
}

impl<R: Registers> Chip for Mpu6050<R> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        let mut read = [0; 15];
        self.registers.read(INT_STATUS, &mut read)?;
        let [
            status,
            ax1,
            ax0,
            ay1,
            ay0,
            az1,
            az0,
            _,
            _,
            gx1,
            gx0,
            gy1,
            gy0,
            gz1,
            gz0,
        ] = read;
        if status & DATA_READY == 0 {
            return Ok(None);
        }
        let mut one = Sum::default();
        one.add(
            [word(ax1, ax0), word(ay1, ay0), word(az1, az0)],
            [word(gx1, gx0), word(gy1, gy0), word(gz1, gz0)],
        );
        let values = one.mean(LSB_PER_G, radps(LSB_PER_DEGPS));
        Ok(values.map(|values| Measurement {
            stamp: None,
            values,
            age: self.age,
        }))
    }
}

//! Which chips there are, and opening one on a bus of the board.

use core::fmt;
use std::io;
use std::path::{Path, PathBuf};

use linux_embedded_hal::spidev::{SpiModeFlags, SpidevOptions};
use linux_embedded_hal::{Delay, I2cdev, SpidevDevice};
use serde::Serialize;

use super::bmp3::Bmp3;
use super::bmp180::Bmp180;
use super::icm42688::Icm42688;
use super::mpu6050::Mpu6050;
use super::ms4525do::{Ms4525do, OutputType};
use super::qmc5883l::Qmc5883l;
use super::sdp3x::Sdp3x;
use super::{
    BusError, Chip, ChipSource, I2cBus, Registers, SpiBus, bmp3, bmp180, icm42688, mpu6050,
    ms4525do, qmc5883l, sdp3x,
};
use crate::claim::claim;
use crate::{Clock, DeviceError};

/// The kinds of chips, as a configuration names them.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ChipKind {
    /// An accelerometer and gyroscope.
    Icm42688,
    /// An accelerometer and gyroscope: MPU-6050, 6500, 9250 or 9255.
    Mpu6050,
    /// A barometer: BMP388 or BMP390.
    Bmp388,
    /// A barometer.
    Bmp180,
    /// A pitot tube's sensor.
    Ms4525do,
    /// A pitot tube's sensor: SDP31, SDP32 or SDP33.
    Sdp3x,
    /// A magnetometer.
    Qmc5883l,
}

impl ChipKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Icm42688,
        Self::Mpu6050,
        Self::Bmp388,
        Self::Bmp180,
        Self::Ms4525do,
        Self::Sdp3x,
        Self::Qmc5883l,
    ];

    /// As a configuration has it.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Icm42688 => "icm42688",
            Self::Mpu6050 => "mpu6050",
            Self::Bmp388 => "bmp388",
            Self::Bmp180 => "bmp180",
            Self::Ms4525do => "ms4525do",
            Self::Sdp3x => "sdp3x",
            Self::Qmc5883l => "qmc5883l",
        }
    }

    /// As its maker writes it, for events and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Icm42688 => "ICM-42688-P",
            Self::Mpu6050 => "MPU-6050",
            Self::Bmp388 => "BMP388",
            Self::Bmp180 => "BMP180",
            Self::Ms4525do => "MS4525DO",
            Self::Sdp3x => "SDP3x",
            Self::Qmc5883l => "QMC5883L",
        }
    }

    /// What it measures, for people.
    pub const fn measures(self) -> &'static str {
        match self {
            Self::Icm42688 | Self::Mpu6050 => "acceleration, turn rates",
            Self::Bmp388 | Self::Bmp180 => "static pressure",
            Self::Ms4525do | Self::Sdp3x => "differential pressure",
            Self::Qmc5883l => "magnetic field",
        }
    }

    /// Whether it is an inertial unit: an accelerometer with gyroscopes.
    pub const fn is_inertial(self) -> bool {
        matches!(self, Self::Icm42688 | Self::Mpu6050)
    }

    /// Whether it is a pitot tube's.
    pub const fn measures_airspeed(self) -> bool {
        matches!(self, Self::Ms4525do | Self::Sdp3x)
    }

    /// The addresses that it may have, the usual one first.
    pub const fn addresses(self) -> &'static [u8] {
        match self {
            Self::Icm42688 => &icm42688::ADDRESSES,
            Self::Mpu6050 => &mpu6050::ADDRESSES,
            Self::Bmp388 => &bmp3::ADDRESSES,
            Self::Bmp180 => &[bmp180::ADDRESS],
            Self::Ms4525do => &ms4525do::ADDRESSES,
            Self::Sdp3x => &sdp3x::ADDRESSES,
            Self::Qmc5883l => &[qmc5883l::ADDRESS],
        }
    }

    /// The register by which it is recognized, and what that has; none if there
    /// is none.
    pub const fn identification(self) -> Option<(u8, &'static [u8])> {
        match self {
            Self::Icm42688 => Some(icm42688::IDENTIFICATION),
            Self::Mpu6050 => Some(mpu6050::IDENTIFICATION),
            Self::Bmp388 => Some(bmp3::IDENTIFICATION),
            Self::Bmp180 => Some(bmp180::IDENTIFICATION),
            Self::Qmc5883l => Some(qmc5883l::IDENTIFICATION),
            Self::Ms4525do | Self::Sdp3x => None,
        }
    }

    /// How often it is asked, unless configured otherwise.
    pub const fn rate_hz(self) -> f64 {
        match self {
            Self::Icm42688 => icm42688::RATE_HZ,
            Self::Mpu6050 => mpu6050::RATE_HZ,
            // As often as there is something new, and not long after it.
            Self::Bmp388 => 2.0 * bmp3::RATE_HZ,
            Self::Bmp180 => bmp180::RATE_HZ,
            Self::Ms4525do => ms4525do::RATE_HZ,
            Self::Sdp3x => sdp3x::RATE_HZ,
            Self::Qmc5883l => qmc5883l::RATE_HZ,
        }
    }

    /// The clock of its SPI in Hz; none without SPI.
    pub const fn spi_hz(self) -> Option<u32> {
        match self {
            // 24 MHz and 10 MHz at most, with short wires.
            Self::Icm42688 | Self::Bmp388 => Some(8_000_000),
            // 1 MHz at most for its settings.
            Self::Mpu6050 => Some(1_000_000),
            Self::Bmp180 | Self::Ms4525do | Self::Sdp3x | Self::Qmc5883l => None,
        }
    }
}

/// Where a chip is.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Wiring {
    /// On an I²C bus.
    I2c {
        /// Such as `/dev/i2c-1`.
        path: PathBuf,
        /// Of 7 bits.
        address: u8,
    },
    /// On an SPI bus, with its own chip select.
    Spi {
        /// Such as `/dev/spidev0.0`.
        path: PathBuf,
    },
}

impl fmt::Display for Wiring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::I2c { path, address } => write!(f, "{}, address {address:#04x}", path.display()),
            Self::Spi { path } => path.display().fmt(f),
        }
    }
}

/// A chip, and how it is read.
#[derive(Clone, Debug)]
pub struct ChipConfig {
    /// Which it is.
    pub kind: ChipKind,
    /// Where it is.
    pub wiring: Wiring,
    /// How often it is asked in a second.
    pub rate_hz: f64,
    /// Of an MS4525DO: it measures from minus this to this, psi.
    pub range_psi: f64,
    /// Of an MS4525DO: its output.
    pub output: OutputType,
    /// What its samples are stamped with.
    pub clock: Clock,
}

impl ChipConfig {
    /// A chip with the usual settings.
    pub fn new(kind: ChipKind, wiring: Wiring) -> Self {
        Self {
            kind,
            wiring,
            rate_hz: kind.rate_hz(),
            range_psi: 1.0,
            output: OutputType::default(),
            clock: Clock::default(),
        }
    }

    /// Opens its bus, and sets it up.
    ///
    /// # Errors
    /// When the bus cannot be opened, the chip does not answer, or is another.
    pub fn open(&self) -> Result<ChipSource<Box<dyn Chip>>, DeviceError> {
        let (chip, claim) = match &self.wiring {
            Wiring::I2c { path, address } => {
                let claim = claim(path, (*address).into())?;
                (self.on_i2c(path, *address)?, claim)
            }
            Wiring::Spi { path } => {
                let claim = claim(path, 0)?;
                (self.on_spi(path)?, claim)
            }
        };
        Ok(ChipSource::new(chip, self.rate_hz, self.clock.clone()).claimed(claim))
    }

    fn on_i2c(&self, path: &Path, address: u8) -> Result<Box<dyn Chip>, DeviceError> {
        let opened = I2cdev::new(path).map_err(|error| {
            let error = linux_embedded_hal::I2CError::from(error);
            cannot_open(path, error.into_io())
        })?;
        let bus = I2cBus::new(opened, &path.display().to_string(), address);
        Ok(match self.kind {
            ChipKind::Bmp180 => Box::new(Bmp180::new(bus, Delay)?),
            ChipKind::Ms4525do => Box::new(Ms4525do::new(bus, self.output, self.range_psi)?),
            ChipKind::Sdp3x => Box::new(Sdp3x::new(bus, &mut Delay)?),
            ChipKind::Qmc5883l => Box::new(Qmc5883l::new(bus, &mut Delay)?),
            ChipKind::Icm42688 | ChipKind::Mpu6050 | ChipKind::Bmp388 => self.on_either(bus)?,
        })
    }

    fn on_spi(&self, path: &Path) -> Result<Box<dyn Chip>, DeviceError> {
        let Some(hz) = self.kind.spi_hz() else {
            return Err(DeviceError::Refused {
                device: path.display().to_string(),
                what: format!("{} has no SPI: use I²C", self.kind.name()),
            });
        };
        let bus = SpiBus::new(open_spi(path, hz)?, &path.display().to_string());
        self.on_either(match self.kind {
            ChipKind::Bmp388 => bus.with_dummy_bytes(bmp3::SPI_DUMMY_BYTES),
            _ => bus,
        })
    }

    /// The chips that have both buses.
    fn on_either<R: Registers + 'static>(&self, bus: R) -> Result<Box<dyn Chip>, DeviceError> {
        Ok(match self.kind {
            ChipKind::Icm42688 => Box::new(Icm42688::new(bus, &mut Delay)?),
            ChipKind::Mpu6050 => Box::new(Mpu6050::new(bus, self.rate_hz, &mut Delay)?),
            _ => Box::new(Bmp3::new(bus, &mut Delay)?),
        })
    }
}

/// Opens an SPI device for the chips here, at so many bits in a second.
pub(crate) fn open_spi(path: &Path, hz: u32) -> Result<SpidevDevice, DeviceError> {
    let mut opened =
        SpidevDevice::open(path).map_err(|error| cannot_open(path, error.into_io()))?;
    let options = SpidevOptions::new()
        .bits_per_word(8)
        .max_speed_hz(hz)
        .mode(SpiModeFlags::SPI_MODE_0)
        .build();
    opened
        .configure(&options)
        .map_err(|source| cannot_open(path, source))?;
    Ok(opened)
}

fn cannot_open(path: &Path, source: io::Error) -> DeviceError {
    DeviceError::Open {
        device: path.display().to_string(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bus_that_is_not_there_is_explained() {
        for (wiring, path) in [
            (
                Wiring::I2c {
                    path: "/dev/i2c-none".into(),
                    address: 0x68,
                },
                "/dev/i2c-none",
            ),
            (
                Wiring::Spi {
                    path: "/dev/spidev-none".into(),
                },
                "/dev/spidev-none",
            ),
        ] {
            let Err(error) = ChipConfig::new(ChipKind::Icm42688, wiring).open() else {
                panic!("opened");
            };
            let message = error.to_string();
            assert!(
                message.starts_with(&format!("cannot open {path}: ")),
                "{message}"
            );
            assert!(
                message.ends_with("is switched on (docs/boards.md)"),
                "{message}"
            );
        }
    }
}

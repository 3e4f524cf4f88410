//! The kinds of `[[sensor]]` of a Linux board: chips on its buses, and what the
//! kernel has drivers for.

use std::path::PathBuf;
use std::time::Duration;

use fcc_core::framework::FALLBACK_AFTER;
use fcc_linux::Clock;
use fcc_linux::chip::ms4525do::OutputType;
use fcc_linux::chip::{ChipConfig, ChipKind, Wiring};
use fcc_linux::iio::{IioConfig, Roots};
use serde::{Deserialize, Serialize};

use super::{CalibrationSection, Config, PhoneSection, SensorEntry};

/// The bus of a Raspberry Pi's header, if none is given.
const USUAL_I2C: &str = "/dev/i2c-1";

/// A chip on a bus.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChipSection {
    /// The I²C bus that it is on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub i2c: Option<PathBuf>,
    /// Its address there; the usual one without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub address: Option<u8>,
    /// The SPI device that it is instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spi: Option<PathBuf>,
    /// How often it is asked; as the chip needs it without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Of an MS4525DO: the end of its range; 1 without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_psi: Option<f64>,
    /// Of an MS4525DO: its output; `a` without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputChoice>,
    /// It counts as silent after this long without a sample.
    pub silent_after_ms: u64,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

/// Which part of its counts an MS4525DO uses.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputChoice {
    /// 10 to 90 %.
    A,
    /// 5 to 95 %.
    B,
}

/// A device of the kernel's Industrial I/O.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct IioSection {
    /// Its name, its label, or `iio:device0`.
    pub device: String,
    /// How often it measures.
    pub rate_hz: f64,
    /// Whether its buffer is read, if it has one.
    pub buffered: bool,
    /// Whether its pressure is that of a pitot tube.
    pub differential: bool,
    /// The folder of all devices.
    pub sysfs: PathBuf,
    /// The folder of their buffers.
    pub dev: PathBuf,
    /// It counts as silent after this long without a sample.
    pub silent_after_ms: u64,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

const SILENT_AFTER_MS: u64 = 500;

impl Default for ChipSection {
    fn default() -> Self {
        Self {
            i2c: None,
            address: None,
            spi: None,
            rate_hz: None,
            range_psi: None,
            output: None,
            silent_after_ms: SILENT_AFTER_MS,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
            calibration: CalibrationSection::default(),
        }
    }
}

impl Default for IioSection {
    fn default() -> Self {
        let roots = Roots::default();
        Self {
            device: String::new(),
            rate_hz: 100.0,
            buffered: true,
            differential: false,
            sysfs: roots.sysfs,
            dev: roots.dev,
            silent_after_ms: SILENT_AFTER_MS,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
            calibration: CalibrationSection::default(),
        }
    }
}

impl ChipSection {
    /// What opens such a chip.
    pub fn to_linux(&self, kind: ChipKind) -> ChipConfig {
        let wiring = match &self.spi {
            Some(path) => Wiring::Spi { path: path.clone() },
            None => Wiring::I2c {
                path: self.i2c.clone().unwrap_or_else(|| USUAL_I2C.into()),
                address: self
                    .address
                    .or(kind.addresses().first().copied())
                    .unwrap_or(0),
            },
        };
        let usual = ChipConfig::new(kind, wiring);
        ChipConfig {
            rate_hz: self.rate_hz.unwrap_or(usual.rate_hz),
            range_psi: self.range_psi.unwrap_or(usual.range_psi),
            output: match self.output {
                Some(OutputChoice::B) => OutputType::B,
                Some(OutputChoice::A) | None => OutputType::A,
            },
            ..usual
        }
    }

    /// The keys that do not fit, each with what to do.
    fn check(&self, kind: ChipKind) -> Vec<(&'static str, String)> {
        let name = kind.name();
        let mut wrong = Vec::new();
        if self.spi.is_some() {
            if kind.spi_hz().is_none() {
                wrong.push(("spi", format!("is given, and {name} has no SPI: give i2c")));
            }
            for (key, is_given) in [
                ("i2c", self.i2c.is_some()),
                ("address", self.address.is_some()),
            ] {
                if is_given {
                    wrong.push((key, "is given together with spi: keep one bus".to_owned()));
                }
            }
        }
        if let Some(address) = self.address
            && !kind.addresses().contains(&address)
        {
            let all: Vec<_> = kind
                .addresses()
                .iter()
                .map(|one| format!("{one:#04x}"))
                .collect();
            let message = format!("is {address:#04x}: {name} has {}", all.join(" or "));
            wrong.push(("address", message));
        }
        if kind != ChipKind::Ms4525do {
            for (key, is_given) in [
                ("range_psi", self.range_psi.is_some()),
                ("output", self.output.is_some()),
            ] {
                if is_given {
                    wrong.push((key, "is a key of \"ms4525do\" alone: remove it".to_owned()));
                }
            }
        }
        wrong
    }
}

impl IioSection {
    /// What opens such a device.
    pub fn to_linux(&self) -> IioConfig {
        IioConfig {
            roots: Roots {
                sysfs: self.sysfs.clone(),
                dev: self.dev.clone(),
            },
            device: self.device.clone(),
            rate_hz: self.rate_hz,
            buffered: self.buffered,
            is_differential: self.differential,
            clock: Clock::default(),
        }
    }
}

/// A sensor of a board: how it is opened.
#[derive(Clone, Copy, Debug)]
pub enum BoardSensor<'a> {
    /// A chip on a bus.
    Chip(ChipKind, &'a ChipSection),
    /// A driver of the kernel.
    Iio(&'a IioSection),
    /// The phone that the program runs on.
    Phone(&'a PhoneSection),
}

impl<'a> BoardSensor<'a> {
    /// Its kind, for events and reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Chip(kind, _) => kind.name(),
            Self::Iio(_) => "IIO",
            Self::Phone(_) => "phone",
        }
    }

    /// Which device it is: another one at its place has another calibration.
    pub fn describe(&self) -> String {
        match self {
            Self::Chip(kind, section) => match section.to_linux(*kind).wiring {
                Wiring::Spi { path } => format!("{} at {}", kind.name(), path.display()),
                Wiring::I2c { path, address } => {
                    format!("{} at {} {address:#04x}", kind.name(), path.display())
                }
            },
            Self::Iio(section) => format!("{} {}", self.name(), section.device),
            Self::Phone(_) => self.name().to_owned(),
        }
    }

    /// Its calibration.
    pub const fn calibration(&self) -> &'a CalibrationSection {
        match self {
            Self::Chip(_, section) => &section.calibration,
            Self::Iio(section) => &section.calibration,
            Self::Phone(section) => &section.calibration,
        }
    }

    /// After how long without a sample it is silent, and without a reading the
    /// next sensor is used.
    pub fn patience(&self) -> (Duration, Duration) {
        let (silent_ms, fallback_ms) = match self {
            Self::Chip(_, section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Iio(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Phone(section) => return section.patience(),
        };
        (
            Duration::from_millis(silent_ms),
            Duration::from_millis(fallback_ms),
        )
    }
}

/// Reports what does not fit in the sensors of a board.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    for (at, entry) in config.sensor.iter().enumerate() {
        match entry.board() {
            Some(BoardSensor::Chip(kind, section)) => {
                for (key, message) in section.check(kind) {
                    report(&[&format!("sensor[{at}].{key}")], message);
                }
            }
            Some(BoardSensor::Iio(section)) if section.device.is_empty() => {
                let message = "is missing: give the name of the device, `fccd probe` lists them";
                report(&[&format!("sensor[{at}].device")], message.to_owned());
            }
            Some(BoardSensor::Iio(_) | BoardSensor::Phone(_)) | None => {}
        }
    }
}

impl Config {
    /// Whether it has a sensor that gives raw readings of a board.
    pub(super) fn has_board(&self) -> bool {
        self.sensor.iter().any(|entry| entry.board().is_some())
    }
}

/// Key, smallest and largest value, as in the table of all keys.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("iio.rate_hz", 1.0, 2_000.0),
    ("iio.silent_after_ms", 50.0, 60_000.0),
    ("iio.fallback_after_ms", 10.0, 60_000.0),
    ("icm42688.rate_hz", 20.0, 1_000.0),
    ("mpu6050.rate_hz", 4.0, 1_000.0),
    ("bmp388.rate_hz", 1.0, 200.0),
    ("bmp180.rate_hz", 1.0, 30.0),
    ("ms4525do.rate_hz", 1.0, 500.0),
    ("ms4525do.range_psi", 0.1, 150.0),
    ("sdp3x.rate_hz", 1.0, 500.0),
    ("qmc5883l.rate_hz", 1.0, 200.0),
    ("chip.silent_after_ms", 50.0, 60_000.0),
    ("chip.fallback_after_ms", 10.0, 60_000.0),
];

/// Whether a range is one of a kind of sensor: `chip` is any chip, and the
/// calibration is that of the built-in aircraft.
pub(super) fn is_of_kind(range_of: &str, key: &str, kind: &str) -> bool {
    let is_chip = ChipKind::ALL.iter().any(|chip| chip.key() == kind);
    match range_of {
        "chip" => is_chip,
        "built-in" => {
            (is_chip || matches!(kind, "iio" | "phone" | "gnss-serial" | "gpsd"))
                && key.starts_with("calibration.")
        }
        of_one => of_one == kind,
    }
}

impl SensorEntry {
    /// The calibration of the sensor of a board, if it is one.
    pub(super) fn calibration_mut(&mut self) -> Option<&mut CalibrationSection> {
        match self {
            Self::Simulator(_)
            | Self::XPlane(_)
            | Self::ServoBoard(_)
            | Self::GnssSerial(_)
            | Self::Gpsd(_)
            | Self::RcReceiver(_)
            | Self::GpioSwitch(_) => None,
            Self::Iio(section) => Some(&mut section.calibration),
            Self::Phone(section) => Some(&mut section.calibration),
            Self::Icm42688(section)
            | Self::Mpu6050(section)
            | Self::Bmp388(section)
            | Self::Bmp180(section)
            | Self::Ms4525do(section)
            | Self::Sdp3x(section)
            | Self::Qmc5883l(section) => Some(&mut section.calibration),
        }
    }

    /// The sensor of a board, if it is one.
    pub fn board(&self) -> Option<BoardSensor<'_>> {
        let (kind, section) = match self {
            Self::Simulator(_)
            | Self::XPlane(_)
            | Self::ServoBoard(_)
            | Self::GnssSerial(_)
            | Self::Gpsd(_)
            | Self::RcReceiver(_)
            | Self::GpioSwitch(_) => return None,
            Self::Iio(section) => return Some(BoardSensor::Iio(section)),
            Self::Phone(section) => return Some(BoardSensor::Phone(section)),
            Self::Icm42688(section) => (ChipKind::Icm42688, section),
            Self::Mpu6050(section) => (ChipKind::Mpu6050, section),
            Self::Bmp388(section) => (ChipKind::Bmp388, section),
            Self::Bmp180(section) => (ChipKind::Bmp180, section),
            Self::Ms4525do(section) => (ChipKind::Ms4525do, section),
            Self::Sdp3x(section) => (ChipKind::Sdp3x, section),
            Self::Qmc5883l(section) => (ChipKind::Qmc5883l, section),
        };
        Some(BoardSensor::Chip(kind, section))
    }

    /// The entry of a kind of chip.
    pub(super) fn of_chip(kind: ChipKind, section: Box<ChipSection>) -> Self {
        match kind {
            ChipKind::Icm42688 => Self::Icm42688(section),
            ChipKind::Mpu6050 => Self::Mpu6050(section),
            ChipKind::Bmp388 => Self::Bmp388(section),
            ChipKind::Bmp180 => Self::Bmp180(section),
            ChipKind::Ms4525do => Self::Ms4525do(section),
            ChipKind::Sdp3x => Self::Sdp3x(section),
            ChipKind::Qmc5883l => Self::Qmc5883l(section),
        }
    }
}

#[cfg(test)]
mod tests;

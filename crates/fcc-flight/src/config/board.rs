//! The kinds of `[[sensor]]` of a Linux board: chips on its buses, and what the
//! kernel has drivers for.

use std::path::PathBuf;

use fcc_core::framework::FALLBACK_AFTER;
use fcc_linux::Clock;
use fcc_linux::chip::ms4525do::OutputType;
use fcc_linux::chip::{ChipConfig, ChipKind, Wiring};
use fcc_linux::iio::{IioConfig, Roots};
use serde::{Deserialize, Serialize};

use super::CalibrationSection;

/// The bus of a Raspberry Pi's header, if none is given.
const USUAL_I2C: &str = "/dev/i2c-1";

/// A chip on a bus.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChipSection {
    /// Which chip it is: the kind of its entry.
    #[serde(skip_deserializing)]
    pub kind: ChipKind,
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
    pub output: Option<OutputType>,
    /// It counts as silent after this long without a sample.
    pub silent_after_ms: u64,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
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
            // That of the entry takes its place.
            kind: ChipKind::Icm42688,
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
    pub fn to_linux(&self) -> ChipConfig {
        let kind = self.kind;
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
            output: self.output.unwrap_or_default(),
            ..usual
        }
    }

    /// The keys that do not fit, each with what to do.
    pub(super) fn problems(&self) -> Vec<(&'static str, String)> {
        let kind = self.kind;
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

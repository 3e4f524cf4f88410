//! The kinds of `[[sensor]]` that are devices of their own, each read by a thread.

use std::path::Path;
use std::time::Duration;

use fcc_linux::chip::{ChipKind, Wiring};
use serde::Serialize;

use super::{
    CalibrationSection, ChipSection, Config, GnssSerialSection, GpioSwitchSection, GpsdSection,
    IioSection, PhoneSection, RcReceiverSection, SensorEntry,
};

/// A sensor on a bus or a line of this machine, or the phone that it is.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum DeviceEntry {
    /// A driver of the kernel.
    Iio(IioSection),
    /// The phone that the program runs on.
    Phone(PhoneSection),
    /// A satellite receiver on a serial line.
    GnssSerial(GnssSerialSection),
    /// A satellite receiver that gpsd reads.
    Gpsd(GpsdSection),
    /// An RC receiver on a serial line.
    RcReceiver(RcReceiverSection),
    /// The engage switch on a line of GPIO.
    GpioSwitch(GpioSwitchSection),
    /// A chip on a bus, with its own kind.
    #[serde(untagged)]
    Chip(ChipSection),
}

impl DeviceEntry {
    /// Its kind, for events and reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Chip(section) => section.kind.name(),
            Self::Iio(_) => "IIO",
            Self::Phone(_) => "phone",
            Self::GnssSerial(_) => "GNSS receiver",
            Self::Gpsd(_) => "gpsd",
            Self::RcReceiver(_) => "RC receiver",
            Self::GpioSwitch(_) => "engage switch",
        }
    }

    /// Which device it is: another one at its place has another calibration.
    pub fn describe(&self) -> String {
        let place = match self {
            Self::Iio(section) => return format!("{} {}", self.name(), section.device),
            Self::Phone(_) => return self.name().to_owned(),
            Self::Chip(section) => match section.to_linux().wiring {
                Wiring::Spi { path } => path.display().to_string(),
                Wiring::I2c { path, address } => format!("{} {address:#04x}", path.display()),
            },
            Self::GnssSerial(section) => section.path.display().to_string(),
            Self::Gpsd(section) => match &section.device {
                Some(device) => format!("{} {device}", section.address),
                None => section.address.clone(),
            },
            Self::RcReceiver(section) => section.path.display().to_string(),
            Self::GpioSwitch(section) => {
                let pin = section.pin();
                format!("{} line {}", pin.chip.display(), pin.line)
            }
        };
        format!("{} at {place}", self.name())
    }

    /// Whether it is a sensor of a board: it gives raw readings.
    pub const fn is_board(&self) -> bool {
        matches!(self, Self::Chip(_) | Self::Iio(_) | Self::Phone(_))
    }

    /// Whether it is a satellite receiver.
    pub(super) const fn is_receiver(&self) -> bool {
        matches!(self, Self::GnssSerial(_) | Self::Gpsd(_))
    }

    /// The calibration of its readings, if it can have one.
    pub const fn calibration(&self) -> Option<&CalibrationSection> {
        Some(match self {
            Self::Chip(section) => &section.calibration,
            Self::Iio(section) => &section.calibration,
            Self::Phone(section) => &section.calibration,
            Self::GnssSerial(section) => &section.calibration,
            Self::Gpsd(section) => &section.calibration,
            Self::RcReceiver(_) | Self::GpioSwitch(_) => return None,
        })
    }

    /// That of the sensor of a board.
    pub(super) const fn board_calibration_mut(&mut self) -> Option<&mut CalibrationSection> {
        match self {
            Self::Chip(section) => Some(&mut section.calibration),
            Self::Iio(section) => Some(&mut section.calibration),
            Self::Phone(section) => Some(&mut section.calibration),
            _ => None,
        }
    }

    /// After how long without a sample it is silent, and without a reading the
    /// next sensor is used.
    pub const fn patience(&self) -> (Duration, Duration) {
        let (silent_ms, fallback_ms) = match self {
            Self::Chip(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Iio(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Phone(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::GnssSerial(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Gpsd(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::RcReceiver(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::GpioSwitch(section) => (section.silent_after_ms, section.fallback_after_ms),
        };
        (
            Duration::from_millis(silent_ms),
            Duration::from_millis(fallback_ms),
        )
    }

    /// The keys that do not fit, each with what to do.
    fn problems(&self) -> Vec<(&'static str, String)> {
        let serial_line = |path: &Path| {
            let message = "is missing: give the serial line, such as \"/dev/ttyAMA0\"";
            let is_missing = path.as_os_str().is_empty();
            is_missing.then(|| ("path", message.to_owned()))
        };
        let mut wrong = Vec::new();
        match self {
            Self::Chip(section) => return section.problems(),
            Self::Iio(section) if section.device.is_empty() => {
                let message = "is missing: give the name of the device, `fccd probe` lists them";
                wrong.push(("device", message.to_owned()));
            }
            Self::GnssSerial(section) => wrong.extend(serial_line(&section.path)),
            Self::Gpsd(section) => {
                let message = section.wrong_address();
                wrong.extend(message.map(|message| ("address", message.to_owned())));
                if section.device.as_ref().is_some_and(String::is_empty) {
                    let message = "is empty: leave it out to use all receivers of gpsd";
                    wrong.push(("device", message.to_owned()));
                }
            }
            Self::RcReceiver(section) => {
                if section.switch_channel == 0 {
                    let message = "is 0: choose 1 to 16, or -1 to -16";
                    wrong.push(("switch_channel", message.to_owned()));
                }
                wrong.extend(serial_line(&section.path));
            }
            Self::GpioSwitch(section) if section.line.is_none() => {
                let message = "is missing: give the line's number, `gpioinfo` lists them";
                wrong.push(("line", message.to_owned()));
            }
            Self::Iio(_) | Self::Phone(_) | Self::GpioSwitch(_) => {}
        }
        wrong
    }
}

/// Reports what does not fit in devices.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let mut has_phone = false;
    for (at, device) in config.devices() {
        for (key, message) in device.problems() {
            report(&[&format!("sensor[{at}].{key}")], message);
        }
        if matches!(device, DeviceEntry::Phone(_)) && std::mem::replace(&mut has_phone, true) {
            let message = "is the phone a second time: keep one".to_owned();
            report(&[&format!("sensor[{at}].kind")], message);
        }
    }
}

impl Config {
    /// The devices of `[[sensor]]`, each with its place there.
    pub(super) fn devices(&self) -> impl Iterator<Item = (usize, &DeviceEntry)> {
        let listed = self.sensor.iter().enumerate();
        listed.filter_map(|(at, entry)| Some((at, entry.device()?)))
    }

    /// Whether it has a sensor that gives raw readings of a board.
    pub(super) fn has_board(&self) -> bool {
        self.devices().any(|(_, device)| device.is_board())
    }

    /// The satellite receivers, each with its key.
    pub(crate) fn receivers(&self) -> impl Iterator<Item = (String, &DeviceEntry)> {
        let receivers = self.devices().filter(|(_, device)| device.is_receiver());
        receivers.map(|(at, device)| (format!("sensor[{at}]"), device))
    }
}

impl SensorEntry {
    /// The device, if it is one.
    pub const fn device(&self) -> Option<&DeviceEntry> {
        match self {
            Self::Device(device) => Some(device),
            Self::Simulator(_) | Self::XPlane(_) | Self::ServoBoard(_) => None,
        }
    }
}

/// Key, smallest and largest value, as in the table of all keys: `device` is any.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("device.silent_after_ms", 50.0, 60_000.0),
    ("device.fallback_after_ms", 10.0, 60_000.0),
    ("iio.rate_hz", 1.0, 2_000.0),
    ("icm42688.rate_hz", 20.0, 1_000.0),
    ("mpu6050.rate_hz", 4.0, 1_000.0),
    ("bmp388.rate_hz", 1.0, 200.0),
    ("bmp180.rate_hz", 1.0, 30.0),
    ("ms4525do.rate_hz", 1.0, 500.0),
    ("ms4525do.range_psi", 0.1, 150.0),
    ("sdp3x.rate_hz", 1.0, 500.0),
    ("qmc5883l.rate_hz", 1.0, 200.0),
    // More wants a permission of Android, `HIGH_SAMPLING_RATE_SENSORS`.
    ("phone.rate_hz", 50.0, 200.0),
    ("gnss-serial.baud", 1_200.0, 4_000_000.0),
    ("rc-receiver.switch_channel", -16.0, 16.0),
    ("rc-receiver.switch_on_above_us", 1_000.0, 2_000.0),
    ("rc-receiver.pitch_channel", -16.0, 16.0),
    ("rc-receiver.roll_channel", -16.0, 16.0),
    ("rc-receiver.yaw_channel", -16.0, 16.0),
    ("gpio-switch.line", 0.0, super::gpio::HIGHEST_LINE),
    ("gpio-switch.debounce_ms", 0.0, 200.0),
];

/// Whether a range is one of a kind of sensor: the calibration is that of the built-in
/// aircraft.
pub(super) fn is_of_kind(range_of: &str, key: &str, kind: &str) -> bool {
    let is_chip = ChipKind::ALL.iter().any(|chip| chip.key() == kind);
    let is_calibrated = is_chip || matches!(kind, "iio" | "phone" | "gnss-serial" | "gpsd");
    match range_of {
        "device" => is_calibrated || matches!(kind, "rc-receiver" | "gpio-switch"),
        "built-in" => is_calibrated && key.starts_with("calibration."),
        of_one => of_one == kind,
    }
}

#[cfg(test)]
mod tests;

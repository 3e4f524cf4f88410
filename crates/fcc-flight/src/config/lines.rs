//! The kinds of `[[sensor]]` that are receivers, of satellites and of a transmitter, or a switch.

use std::path::PathBuf;
use std::time::Duration;

use fcc_core::framework::FALLBACK_AFTER;
use fcc_linux::serial::{GnssSettings, LineSettings, RcChannel, RcChannels, RcProtocol};
use serde::{Deserialize, Serialize};

use super::{CalibrationSection, Config, GpioSwitchSection, GpsdSection, SensorEntry};

/// A satellite receiver.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct GnssSerialSection {
    /// Its line.
    pub path: PathBuf,
    /// Bits in a second.
    pub baud: u32,
    /// Whether it is configured as a receiver of u-blox, from generation 9 on.
    pub configure: bool,
    /// It counts as silent after this long without a fix.
    pub silent_after_ms: u64,
    /// After this long without a fix, that of the next sensor is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings: its delay.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

/// An RC receiver: engage switch and the pilot's sticks.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RcReceiverSection {
    /// Its line.
    pub path: PathBuf,
    /// What it speaks.
    pub protocol: ProtocolChoice,
    /// The channel of the engage switch, from 1; negative if it is reversed, as
    /// for all channels.
    pub switch_channel: i8,
    /// The pulse above which the switch is on.
    pub switch_on_above_us: f64,
    /// The channels of the sticks; 0 if they are not used.
    pub pitch_channel: i8,
    /// That of roll.
    pub roll_channel: i8,
    /// That of yaw.
    pub yaw_channel: i8,
    /// It counts as silent after this long without a frame.
    pub silent_after_ms: u64,
    /// After this long without one, the next sensor's sticks are used.
    pub fallback_after_ms: u64,
}

/// What an RC receiver speaks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProtocolChoice {
    /// Futaba's.
    Sbus,
    /// Crossfire and `ExpressLRS`.
    Crsf,
}

impl Default for GnssSerialSection {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            baud: 38_400,
            configure: true,
            silent_after_ms: 2_000,
            fallback_after_ms: 1_000,
            calibration: CalibrationSection::default(),
        }
    }
}

impl Default for RcReceiverSection {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            protocol: ProtocolChoice::Sbus,
            switch_channel: 5,
            switch_on_above_us: 1_700.0,
            pitch_channel: 2,
            roll_channel: 1,
            yaw_channel: 4,
            silent_after_ms: 500,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
        }
    }
}

impl GnssSerialSection {
    /// What opens it.
    pub fn to_linux(&self) -> GnssSettings {
        GnssSettings {
            line: LineSettings {
                path: self.path.clone(),
                baud: self.baud,
                has_even_parity: false,
            },
            configures: self.configure,
        }
    }
}

impl RcReceiverSection {
    /// What it speaks.
    pub fn protocol(&self) -> RcProtocol {
        match self.protocol {
            ProtocolChoice::Sbus => RcProtocol::Sbus,
            ProtocolChoice::Crsf => RcProtocol::Crsf,
        }
    }

    /// What its channels are.
    pub fn channels(&self) -> RcChannels {
        let channel = |number: i8| RcChannel {
            number: number.unsigned_abs(),
            is_reversed: number < 0,
        };
        let sticks = [self.pitch_channel, self.roll_channel, self.yaw_channel];
        RcChannels {
            switch: channel(self.switch_channel),
            on_above_us: self.switch_on_above_us,
            controls: (!sticks.contains(&0)).then(|| sticks.map(channel)),
        }
    }
}

/// A receiver or a switch: how it is opened.
#[derive(Clone, Copy, Debug)]
pub enum LineSensor<'a> {
    /// A satellite receiver.
    Gnss(&'a GnssSerialSection),
    /// A satellite receiver that gpsd reads.
    Gpsd(&'a GpsdSection),
    /// An RC receiver.
    Rc(&'a RcReceiverSection),
    /// A switch on a line of GPIO.
    Switch(&'a GpioSwitchSection),
}

impl LineSensor<'_> {
    /// Its kind, for events and reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Gnss(_) => "GNSS receiver",
            Self::Gpsd(_) => "gpsd",
            Self::Rc(_) => "RC receiver",
            Self::Switch(_) => "engage switch",
        }
    }

    /// Which one it is.
    pub fn describe(&self) -> String {
        let place = match self {
            Self::Gnss(section) => section.path.display().to_string(),
            Self::Gpsd(section) => match &section.device {
                Some(device) => format!("{} {device}", section.address),
                None => section.address.clone(),
            },
            Self::Rc(section) => section.path.display().to_string(),
            Self::Switch(section) => {
                let pin = section.pin();
                format!("{} line {}", pin.chip.display(), pin.line)
            }
        };
        format!("{} at {place}", self.name())
    }

    /// After how long without a sample it is silent, and without a reading the
    /// next sensor is used.
    pub fn patience(&self) -> (Duration, Duration) {
        let (silent_ms, fallback_ms) = match self {
            Self::Gnss(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Gpsd(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Rc(section) => (section.silent_after_ms, section.fallback_after_ms),
            Self::Switch(section) => (section.silent_after_ms, section.fallback_after_ms),
        };
        (
            Duration::from_millis(silent_ms),
            Duration::from_millis(fallback_ms),
        )
    }
}

impl Config {
    /// The satellite receivers, each with its key.
    pub(crate) fn receivers(&self) -> impl Iterator<Item = (String, LineSensor<'_>)> {
        let listed = self.sensor.iter().enumerate();
        listed.filter_map(|(at, entry)| match entry.line()? {
            line @ (LineSensor::Gnss(_) | LineSensor::Gpsd(_)) => {
                Some((format!("sensor[{at}]"), line))
            }
            LineSensor::Rc(_) | LineSensor::Switch(_) => None,
        })
    }
}

impl SensorEntry {
    /// The receiver or switch, if it is one.
    pub fn line(&self) -> Option<LineSensor<'_>> {
        match self {
            Self::GnssSerial(section) => Some(LineSensor::Gnss(section)),
            Self::Gpsd(section) => Some(LineSensor::Gpsd(section)),
            Self::RcReceiver(section) => Some(LineSensor::Rc(section)),
            Self::GpioSwitch(section) => Some(LineSensor::Switch(section)),
            _ => None,
        }
    }
}

/// Reports what does not fit in receivers and switches.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    for (at, entry) in config.sensor.iter().enumerate() {
        let mut wrong = |key: &str, message: &str| {
            report(&[&format!("sensor[{at}].{key}")], message.to_owned());
        };
        let path = match entry.line() {
            Some(LineSensor::Gnss(section)) => &section.path,
            Some(LineSensor::Rc(section)) => {
                if section.switch_channel == 0 {
                    wrong("switch_channel", "is 0: choose 1 to 16, or -1 to -16");
                }
                &section.path
            }
            Some(LineSensor::Gpsd(section)) => {
                if let Some(message) = section.wrong_address() {
                    wrong("address", message);
                }
                if section.device.as_ref().is_some_and(String::is_empty) {
                    wrong(
                        "device",
                        "is empty: leave it out to use all receivers of gpsd",
                    );
                }
                continue;
            }
            Some(LineSensor::Switch(section)) => {
                if section.line.is_none() {
                    wrong(
                        "line",
                        "is missing: give the line's number, `gpioinfo` lists them",
                    );
                }
                continue;
            }
            None => continue,
        };
        if path.as_os_str().is_empty() {
            wrong(
                "path",
                "is missing: give the serial line, such as \"/dev/ttyAMA0\"",
            );
        }
    }
}

/// Key, smallest and largest value, as in the table of all keys.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("gnss-serial.baud", 1_200.0, 4_000_000.0),
    ("gnss-serial.silent_after_ms", 50.0, 60_000.0),
    ("gnss-serial.fallback_after_ms", 10.0, 60_000.0),
    ("rc-receiver.switch_channel", -16.0, 16.0),
    ("rc-receiver.switch_on_above_us", 1_000.0, 2_000.0),
    ("rc-receiver.pitch_channel", -16.0, 16.0),
    ("rc-receiver.roll_channel", -16.0, 16.0),
    ("rc-receiver.yaw_channel", -16.0, 16.0),
    ("rc-receiver.silent_after_ms", 50.0, 60_000.0),
    ("rc-receiver.fallback_after_ms", 10.0, 60_000.0),
];

//! `[[actuator]]` of the kind `servos`.

use std::path::PathBuf;
use std::time::Duration;

use fcc_linux::servo::{Drives, PwmOutput, Released, ServoChannel, ServoError, ServoSettings};
use fcc_telemetry::units::number;
use serde::{Deserialize, Serialize};

use super::gpio::HIGHEST_LINE;
use super::{ActuatorEntry, Config, HeartbeatSection};

/// Servos, and where their pulses are written.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ServosSection {
    /// The chip of PWM of the operating system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pwm: Option<PathBuf>,
    /// The I²C bus of a PCA9685 instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pca9685: Option<PathBuf>,
    /// The address of a PCA9685.
    pub address: u8,
    /// The oscillator of a PCA9685, as measured.
    pub oscillator_mhz: f64,
    /// Pulses in a second.
    pub rate_hz: f64,
    /// What they do while nobody has control.
    pub released: Released,
    /// They go to failsafe after this long without outputs.
    pub silent_after_ms: u64,
    /// The line that changes while the loop has control.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heartbeat: Option<HeartbeatSection>,
    /// Each servo.
    #[serde(rename = "channel")]
    pub channels: Vec<ServoSection>,
}

/// A servo.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ServoSection {
    /// What it follows.
    pub drives: Drives,
    /// Its output there.
    pub output: u32,
    /// Another chip than that of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pwm: Option<PathBuf>,
    /// The pulse at -1, of what is 0 to 1 at 0.
    #[serde(default = "min_us")]
    pub min_us: f64,
    /// The pulse at 0.
    #[serde(default = "centre_us")]
    pub centre_us: f64,
    /// The pulse at 1.
    #[serde(default = "max_us")]
    pub max_us: f64,
    /// Whether a positive deflection is a shorter pulse.
    #[serde(default)]
    pub reversed: bool,
    /// What is added to a deflection.
    #[serde(default)]
    pub trim: f64,
    /// The fastest change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slew_per_s: Option<f64>,
    /// Where it goes without the loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failsafe: Option<f64>,
}

const USUAL: ServoChannel = ServoChannel::new(Drives::Elevator);

const fn min_us() -> f64 {
    USUAL.min_us
}

const fn centre_us() -> f64 {
    USUAL.centre_us
}

const fn max_us() -> f64 {
    USUAL.max_us
}

impl Default for ServosSection {
    fn default() -> Self {
        let usual = ServoSettings::new(Vec::new());
        Self {
            pwm: None,
            pca9685: None,
            address: 0x40,
            oscillator_mhz: 25.0,
            rate_hz: 50.0,
            released: Released::Failsafe,
            silent_after_ms: usual.silent_after.as_millis() as u64,
            heartbeat: None,
            channels: Vec::new(),
        }
    }
}

impl ServoSection {
    fn to_linux(&self) -> ServoChannel {
        ServoChannel {
            drives: self.drives,
            min_us: self.min_us,
            centre_us: self.centre_us,
            max_us: self.max_us,
            is_reversed: self.reversed,
            trim: self.trim,
            slew_per_s: self.slew_per_s,
            failsafe: self.failsafe.unwrap_or(self.drives.usual_failsafe()),
        }
    }

    /// Its numbers with their ranges.
    fn numbers(&self) -> [(&'static str, f64, f64, f64); 5] {
        [
            ("min_us", self.min_us, 500.0, 2_500.0),
            ("centre_us", self.centre_us, 500.0, 2_500.0),
            ("max_us", self.max_us, 500.0, 2_500.0),
            ("trim", self.trim, -0.5, 0.5),
            ("slew_per_s", self.slew_per_s.unwrap_or(1.0), 0.05, 1_000.0),
        ]
    }
}

impl ServosSection {
    /// What the servos are.
    pub fn to_linux(&self) -> ServoSettings {
        let channels = self.channels.iter().map(ServoSection::to_linux).collect();
        ServoSettings {
            released: self.released,
            silent_after: Duration::from_millis(self.silent_after_ms),
            ..ServoSettings::new(channels)
        }
    }

    /// Where they are, for people: the bus, or the chip of the first.
    pub fn place(&self) -> PathBuf {
        let first = self.channels.first().and_then(|first| first.pwm.clone());
        let chip = self.pca9685.clone().or(self.pwm.clone()).or(first);
        chip.unwrap_or_default()
    }

    /// The outputs of PWM, in the order of the channels.
    pub fn pwm_outputs(&self) -> Vec<PwmOutput> {
        let output = |channel: &ServoSection| PwmOutput {
            chip: channel.pwm.clone().or(self.pwm.clone()).unwrap_or_default(),
            number: channel.output,
        };
        self.channels.iter().map(output).collect()
    }

    fn check(&self, report: &mut impl FnMut(String, String)) {
        let in_range = |value: f64, least: f64, most: f64| {
            (!(least..=most).contains(&value)).then(|| {
                let [value, least, most] = [value, least, most].map(number);
                format!("is {value}: choose {least} to {most}")
            })
        };
        let line = self
            .heartbeat
            .as_ref()
            .map_or(0, |heartbeat| heartbeat.line);
        for (key, value, least, most) in [
            ("heartbeat.line", f64::from(line), 0.0, HIGHEST_LINE),
            ("address", f64::from(self.address), 64.0, 127.0),
            ("oscillator_mhz", self.oscillator_mhz, 20.0, 30.0),
            ("rate_hz", self.rate_hz, 40.0, 333.0),
            (
                "silent_after_ms",
                self.silent_after_ms as f64,
                50.0,
                5_000.0,
            ),
        ] {
            if let Some(message) = in_range(value, least, most) {
                report(key.to_owned(), message);
            }
        }
        if self.channels.is_empty() {
            let message =
                "is missing: give each servo as [[actuator.channel]], with drives and output";
            report("channel".to_owned(), message.to_owned());
        }
        match (&self.pca9685, &self.pwm) {
            (Some(_), Some(_)) => report(
                "pwm".to_owned(),
                "is given together with pca9685: keep one".to_owned(),
            ),
            (None, None) if self.channels.iter().any(|channel| channel.pwm.is_none()) => report(
                "pwm".to_owned(),
                "is missing: give the chip, such as \"/sys/class/pwm/pwmchip0\", or pca9685, the \
                 bus of a PCA9685"
                    .to_owned(),
            ),
            _ => {}
        }
        for (at, channel) in self.channels.iter().enumerate() {
            let mut wrong =
                |key: &str, message: String| report(format!("channel[{at}].{key}"), message);
            let mut is_out = false;
            for (key, value, least, most) in channel.numbers() {
                if let Some(message) = in_range(value, least, most) {
                    is_out = true;
                    wrong(key, message);
                }
            }
            if self.pca9685.is_some() && channel.output > 15 {
                wrong(
                    "output",
                    format!("is {}: a PCA9685 has 0 to 15", channel.output),
                );
            }
            if !is_out && let Err(error) = channel.to_linux().validate() {
                let key = match error {
                    ServoError::Failsafe { .. } => "failsafe",
                    ServoError::Trim => "trim",
                    _ => "min_us",
                };
                wrong(key, error.to_string());
            }
            let chip =
                |other: &ServoSection| (other.pwm.clone().or(self.pwm.clone()), other.output);
            let earlier = self.channels.iter().take(at);
            if earlier.map(chip).any(|other| other == chip(channel)) {
                let message = format!(
                    "is {}, as that of another channel: give each its own",
                    channel.output
                );
                wrong("output", message);
            }
        }
    }
}

/// Reports what does not fit in servos.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    for (at, entry) in config.actuators().iter().enumerate() {
        if let ActuatorEntry::Servos(section) = entry {
            section.check(&mut |key, message| report(&[&format!("actuator[{at}].{key}")], message));
        }
    }
    undriven(config, report);
}

/// What control takes pitch and bank by: without one of them nothing can be flown.
const NEEDED: [(Drives, &str); 2] = [(Drives::Elevator, "elevator"), (Drives::Aileron, "aileron")];

/// Reports surfaces without which there is no control, if servos alone drive them.
fn undriven(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let entries = config.actuators().iter();
    let sections = entries.map(|entry| match entry {
        ActuatorEntry::Servos(section) => Some(section.as_ref()),
        ActuatorEntry::Simulator(_) | ActuatorEntry::ServoBoard(_) => None,
    });
    // Others drive all surfaces.
    let Some(sections) = sections.collect::<Option<Vec<&ServosSection>>>() else {
        return;
    };
    let Some(last) = sections.len().checked_sub(1) else {
        return;
    };
    // That is said of its own.
    if sections.iter().any(|section| section.channels.is_empty()) {
        return;
    }
    for (surface, name) in NEEDED {
        let mut channels = sections.iter().flat_map(|section| &section.channels);
        if !channels.any(|channel| channel.drives == surface) {
            let message = format!(
                "has no servo that drives the {name}, without which nothing can be flown: add \
                 [[actuator.channel]] with drives = \"{name}\" and its output"
            );
            report(&[&format!("actuator[{last}].channel")], message);
        }
    }
}

#[cfg(test)]
mod tests;

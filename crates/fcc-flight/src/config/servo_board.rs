//! `[servo-board]`: a board that gives airspeed and the engage switch, and takes
//! the surfaces.

use std::path::PathBuf;
use std::time::Duration;

use fcc_servo_link::{Baud, Link, ServoBoardConfig};
use fcc_xplane::Simulator;
use serde::{Deserialize, Serialize};

use super::calibration::PressureSection;
use super::{ActuatorEntry, CalibrationSection, Config, SensorEntry};

/// `[servo-board]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ServoBoardSection {
    /// The serial line that it is at; or `address`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<PathBuf>,
    /// The speed of the serial line, bits a second.
    pub baud: u32,
    /// Its address and UDP port, if that is not 49000; or `serial`.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "as_text",
        deserialize_with = "from_text"
    )]
    pub address: Option<Simulator>,
    /// What the board calls its engage switch.
    pub engage_switch: String,
    /// The board counts as silent after this long without a message.
    pub silent_after_ms: u64,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
    /// The calibration of the sensor of its pitot tube.
    pub differential_pressure: PressureSection,
}

#[expect(clippy::ref_option, reason = "serde requires it")]
fn as_text<S: serde::Serializer>(address: &Option<Simulator>, out: S) -> Result<S::Ok, S::Error> {
    match address {
        Some(address) => super::as_text::serialize(address, out),
        None => out.serialize_none(),
    }
}

fn from_text<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<Simulator>, D::Error> {
    super::as_text::deserialize(from).map(Some)
}

impl Default for ServoBoardSection {
    fn default() -> Self {
        let link = ServoBoardConfig::default();
        Self {
            serial: None,
            baud: Baud::B115200.bits_per_s(),
            address: None,
            engage_switch: link.engage_switch,
            silent_after_ms: link.silent_after.as_millis() as u64,
            fallback_after_ms: link.fallback_after.as_millis() as u64,
            differential_pressure: PressureSection::default(),
        }
    }
}

impl ServoBoardSection {
    /// How it is reached; none if that is not given, or twice.
    fn link(&self) -> Option<Link> {
        match (&self.serial, &self.address) {
            (Some(path), None) => Some(Link::Serial {
                path: path.clone(),
                baud: Baud::try_from(self.baud).ok()?,
            }),
            (None, Some(address)) => Some(Link::Udp(address.clone())),
            _ => None,
        }
    }

    /// The link's configuration, for a loop of this priority; 0 for none.
    pub(crate) fn to_link(&self, loop_priority: u8) -> ServoBoardConfig {
        let default = ServoBoardConfig::default();
        ServoBoardConfig {
            // One without a link is refused before.
            link: self.link().unwrap_or(default.link),
            engage_switch: self.engage_switch.clone(),
            silent_after: Duration::from_millis(self.silent_after_ms),
            fallback_after: Duration::from_millis(self.fallback_after_ms),
            priority: loop_priority
                .checked_sub(1)
                .filter(|priority| *priority > 0),
        }
    }

    /// The calibration of what it measures.
    pub(crate) fn calibration(&self) -> CalibrationSection {
        CalibrationSection {
            differential_pressure: self.differential_pressure,
            ..CalibrationSection::default()
        }
    }
}

/// Key, smallest and largest value, as in the table of all keys.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("servo-board.baud", 57_600.0, 1e6),
    ("servo-board.silent_after_ms", 50.0, 60_000.0),
    ("servo-board.fallback_after_ms", 10.0, 60_000.0),
];

/// The longest path of the engage switch: its request is a message of at most
/// 240 bytes on a serial line.
const MOST_SWITCH_BYTES: usize = 200;

/// What surfaces take on a serial line, bits a tick: two rows in a frame of 85
/// bytes, each with a start and a stop bit; and the share that is left for
/// requests and for what is repeated.
const BITS_PER_TICK: f64 = 850.0;
const MOST_LOAD: f64 = 0.8;

/// Reports what is wrong about the board and the entries that use it.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let sensors: Vec<_> = positions(&config.sensor, |entry| {
        matches!(entry, SensorEntry::ServoBoard(_))
    });
    let actuators: Vec<_> = positions(config.actuators(), |entry| {
        matches!(entry, ActuatorEntry::ServoBoard(_))
    });
    for (list, entries) in [("sensor", &sensors), ("actuator", &actuators)] {
        for (number, at) in entries.iter().enumerate() {
            let key = format!("{list}[{at}].kind");
            if config.servo_board.is_none() {
                let message = "is \"servo-board\": add a section [servo-board] that says where it \
                               is, with serial = \"/dev/ttyUSB0\" or address = \"192.168.4.1\"";
                report(&[&key], message.to_owned());
            } else if number > 0 {
                report(
                    &[&key],
                    "is the servo board a second time: keep one".to_owned(),
                );
            } else if sensors.is_empty() {
                let message = "is \"servo-board\", and no sensor is: add [[sensor]] with kind = \
                               \"servo-board\", by which it is seen that the servos follow";
                report(&[&key], message.to_owned());
            }
        }
    }
    let Some(section) = &config.servo_board else {
        return;
    };
    if sensors.is_empty() && actuators.is_empty() {
        let message = "is not used: add [[sensor]] with kind = \"servo-board\", and [[actuator]] \
                       with the same kind if it is to move the surfaces";
        report(&["servo-board"], message.to_owned());
    }
    match (&section.serial, &section.address) {
        (Some(_), Some(_)) => report(
            &["servo-board.address"],
            "is given together with serial: keep the one by which the board is connected"
                .to_owned(),
        ),
        (None, None) => report(
            &["servo-board"],
            "has neither serial nor address: add serial = \"/dev/ttyUSB0\" for a serial line, or \
             address = \"192.168.4.1\" for UDP"
                .to_owned(),
        ),
        (Some(_), None) => baud(section, config.tick.rate_hz, report),
        (None, Some(_)) => {}
    }
    let switch = section.engage_switch.as_str();
    let is_path = !switch.is_empty() && switch.bytes().all(|byte| byte.is_ascii_graphic());
    if !is_path || switch.len() > MOST_SWITCH_BYTES {
        let message = format!(
            "is no path of a dataref: choose 1 to {MOST_SWITCH_BYTES} letters, digits, / _ [ ]"
        );
        report(&["servo-board.engage_switch"], message);
    }
}

fn baud(section: &ServoBoardSection, rate_hz: f64, report: &mut impl FnMut(&[&str], String)) {
    let bits_per_s = section.baud;
    if let Err(permitted) = Baud::try_from(bits_per_s) {
        report(
            &["servo-board.baud"],
            format!("is {bits_per_s}: {permitted}"),
        );
        return;
    }
    let needed = BITS_PER_TICK * rate_hz / MOST_LOAD;
    if f64::from(bits_per_s) < needed {
        report(
            &["servo-board.baud", "loop.rate_hz"],
            format!(
                "is {bits_per_s}: choose at least {needed:.0}, which the surfaces take at \
                 loop.rate_hz = {rate_hz}, or a lower rate"
            ),
        );
    }
}

fn positions<T>(list: &[T], is_one: impl Fn(&T) -> bool) -> Vec<usize> {
    let each = list.iter().enumerate();
    each.filter(|(_, entry)| is_one(entry))
        .map(|(at, _)| at)
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    const BOARD: &str = "[servo-board]\nserial = \"/dev/ttyS0\"\n";
    const BOTH: &str = "[[sensor]]\nkind = \"servo-board\"\n[[actuator]]\nkind = \"servo-board\"\n";

    fn message(text: &str) -> String {
        Config::parse(text, "test").unwrap_err().to_string()
    }

    #[test]
    fn a_board_is_sensor_and_actuator_with_or_without_a_simulator() {
        let alone = Config::parse(&format!("{BOARD}{BOTH}"), "test").unwrap();
        assert!(alone.aircraft().is_none());
        assert_eq!((alone.sensors().count(), alone.actuators().len()), (1, 1));
        let beside = Config::parse(&format!("[built-in]\n{BOARD}{BOTH}"), "test").unwrap();
        assert_eq!((beside.sensors().count(), beside.actuators().len()), (2, 1));
        let written = beside.to_toml().unwrap();
        let again = Config::parse(&written, "again").unwrap();
        assert_eq!(again.to_toml().unwrap(), written);
        let udp = "[servo-board]\naddress = \"192.168.4.1\"\n";
        Config::parse(&format!("{udp}{BOTH}"), "test").unwrap();
    }

    #[test]
    fn what_is_wrong_is_said_with_line_and_key() {
        let missing = message(&format!("[built-in]\n{BOTH}"));
        let lines: Vec<_> = missing.lines().collect();
        assert!(lines[0].starts_with("test:3: sensor[0].kind: is \"servo-board\": add a section"));
        assert!(lines[1].starts_with("test:5: actuator[0].kind: "));
        let nowhere = message(&format!("[servo-board]\n{BOTH}"));
        assert!(
            nowhere.starts_with("test:1: servo-board: has neither serial nor address: add"),
            "{nowhere}"
        );
        let twice = message(&format!("{BOARD}address = \"10.0.0.2\"\n{BOTH}"));
        assert!(
            twice.starts_with("test:3: servo-board.address: is given together with serial"),
            "{twice}"
        );
        let unused = message(&format!("[built-in]\n{BOARD}"));
        assert!(
            unused.starts_with("test:2: servo-board: is not used: add [[sensor]]"),
            "{unused}"
        );
        let unread = message(&format!(
            "[built-in]\n{BOARD}[[actuator]]\nkind = \"servo-board\"\n"
        ));
        assert!(
            unread.contains("test:5: actuator[0].kind: is \"servo-board\", and no sensor is"),
            "{unread}"
        );
        let two = message(&format!("{BOARD}{BOTH}{BOTH}"));
        assert!(
            two.contains("sensor[1].kind: is the servo board a second time"),
            "{two}"
        );
        let switch = message(&format!("{BOARD}engage_switch = \"\"\n{BOTH}"));
        assert!(
            switch.starts_with("test:3: servo-board.engage_switch: is no path"),
            "{switch}"
        );
    }

    /// A frame of 85 bytes is 850 bits on the line: 100 a second are 85,000 bits a
    /// second, and four fifths of 115,200 are 92,160.
    #[test]
    fn a_line_that_is_too_slow_is_refused() {
        let board = |baud: u32, rate_hz: u32| {
            format!("{BOARD}baud = {baud}\n{BOTH}[loop]\nrate_hz = {rate_hz}\n")
        };
        Config::parse(&board(115_200, 100), "test").unwrap();
        let slow = message(&board(57_600, 100));
        assert!(
            slow.starts_with("test:3: servo-board.baud: is 57600: choose at least 106250"),
            "{slow}"
        );
        let odd = message(&board(100_000, 40));
        assert!(
            odd.starts_with("test:3: servo-board.baud: is 100000: choose 57600, 115200, "),
            "{odd}"
        );
        let low = message(&board(9_600, 40));
        assert!(low.starts_with("test:3: servo-board.baud: is 9600: choose"));
    }
}

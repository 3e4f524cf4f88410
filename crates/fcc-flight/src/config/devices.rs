//! `[[sensor]]` and `[[actuator]]`: sensors and actuators in addition to a
//! simulator's, or instead of them.

use fcc_linux::chip::ChipKind;
use fcc_xplane::Simulator;
use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::DeTable;

use super::entry::{Entry, Keys};
use super::{ChipSection, Config, DeviceEntry, ServosSection, XPlaneSection};

/// One entry of `[[sensor]]`: a kind, and that kind's keys.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SensorEntry {
    /// The simulator's, if it is not to be the last in the order.
    Simulator(NoKeys),
    /// An X-Plane that is only read, never written to.
    XPlane(Box<XPlaneSection>),
    /// The servo board's, of `[servo-board]`.
    ServoBoard(NoKeys),
    /// A device of its own.
    #[serde(untagged)]
    Device(Box<DeviceEntry>),
}

/// One entry of `[[actuator]]`: a kind, and that kind's keys.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ActuatorEntry {
    /// The simulator's.
    Simulator(NoKeys),
    /// The servo board's, of `[servo-board]`.
    ServoBoard(NoKeys),
    /// Servos of a board.
    Servos(Box<ServosSection>),
}

/// The keys of a kind without keys.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoKeys {}

static SENSOR: SensorEntry = SensorEntry::Simulator(NoKeys {});
static ACTUATOR: ActuatorEntry = ActuatorEntry::Simulator(NoKeys {});

impl Config {
    /// The sensors in their order of preference: those of `[[sensor]]`, and the
    /// simulator's last if it is not among them.
    pub fn sensors(&self) -> impl Iterator<Item = &SensorEntry> {
        let listed = self.sensor.iter();
        let is_complete =
            self.is_without_simulator() || listed.clone().any(SensorEntry::is_simulator);
        listed.chain((!is_complete).then_some(&SENSOR))
    }

    /// The names of hosts that are looked up when a flight is assembled, with the ports.
    pub fn host_names(&self) -> Vec<String> {
        let simulators = self.x_planes().map(|(_, section)| &section.simulator);
        let board = self.servo_board.iter().flat_map(|board| &board.address);
        let named = simulators
            .chain(board)
            .filter(|at| matches!(at, Simulator::Named(_)));
        named.map(ToString::to_string).collect()
    }

    /// The connections to an X-Plane, each with its key.
    pub(super) fn x_planes(&self) -> impl Iterator<Item = (String, &XPlaneSection)> {
        let own = self.x_plane.iter().map(|own| ("x-plane".to_owned(), own));
        let listed = self.sensor.iter().enumerate();
        own.chain(listed.filter_map(|(at, entry)| match entry {
            SensorEntry::XPlane(section) => Some((format!("sensor[{at}]"), section.as_ref())),
            _ => None,
        }))
    }

    /// The actuators: those of `[[actuator]]`, or the simulator's without such a
    /// list.
    pub fn actuators(&self) -> &[ActuatorEntry] {
        let simulator = std::slice::from_ref(&ACTUATOR);
        self.actuator.as_deref().unwrap_or(simulator)
    }

    /// Whether there is no simulator: its section is missing, and the lists give
    /// sensors and, even if there are none, actuators without it.
    pub fn is_without_simulator(&self) -> bool {
        let is_given = self.x_plane.is_some() || self.built_in.is_some();
        let moves_it = |entry: &ActuatorEntry| matches!(entry, ActuatorEntry::Simulator(_));
        !is_given
            && !self.sensor.is_empty()
            && !self.sensor.iter().any(SensorEntry::is_simulator)
            && !self.actuators().iter().any(moves_it)
    }
}

impl SensorEntry {
    /// Whether it is the simulator's.
    pub fn is_simulator(&self) -> bool {
        matches!(self, Self::Simulator(_))
    }
}

impl Entry for SensorEntry {
    const KINDS: &'static [&'static str] = &[
        "simulator",
        "x-plane",
        "iio",
        "phone",
        "icm42688",
        "mpu6050",
        "bmp388",
        "bmp180",
        "ms4525do",
        "sdp3x",
        "qmc5883l",
        "servo-board",
        "gnss-serial",
        "gpsd",
        "rc-receiver",
        "gpio-switch",
    ];

    fn read<'t>(kind: &str, keys: Spanned<DeTable<'t>>, from: &mut impl Keys<'t>) -> Option<Self> {
        let device = match kind {
            "simulator" => return from.table(keys, 1).map(Self::Simulator),
            "x-plane" => return from.table(keys, 1).map(Self::XPlane),
            "servo-board" => return from.table(keys, 1).map(Self::ServoBoard),
            "iio" => DeviceEntry::Iio(from.table(keys, 1)?),
            "phone" => DeviceEntry::Phone(from.table(keys, 1)?),
            "gnss-serial" => DeviceEntry::GnssSerial(from.table(keys, 1)?),
            "gpsd" => DeviceEntry::Gpsd(from.table(keys, 1)?),
            "rc-receiver" => DeviceEntry::RcReceiver(from.table(keys, 1)?),
            "gpio-switch" => DeviceEntry::GpioSwitch(from.table(keys, 1)?),
            chip => DeviceEntry::Chip(ChipSection {
                kind: ChipKind::ALL.into_iter().find(|kind| kind.key() == chip)?,
                ..from.table(keys, 1)?
            }),
        };
        Some(Self::Device(Box::new(device)))
    }

    fn unread() -> Option<Self> {
        Some(Self::XPlane(Box::default()))
    }
}

impl Entry for ActuatorEntry {
    const KINDS: &'static [&'static str] = &["simulator", "servo-board", "servos"];

    fn read<'t>(kind: &str, keys: Spanned<DeTable<'t>>, from: &mut impl Keys<'t>) -> Option<Self> {
        match kind {
            "servo-board" => from.table(keys, 1).map(Self::ServoBoard),
            "servos" => from.table(keys, 1).map(Self::Servos),
            _ => from.table(keys, 1).map(Self::Simulator),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::config::{Config, SensorEntry};

    fn kinds(text: &str) -> (Vec<&'static str>, usize) {
        let config = Config::parse(text, "test").unwrap();
        let kinds = config.sensors().map(|entry| match entry {
            SensorEntry::Simulator(_) => "simulator",
            SensorEntry::XPlane(_) => "x-plane",
            SensorEntry::ServoBoard(_) => "servo-board",
            SensorEntry::Device(other) => panic!("{other:?}"),
        });
        (kinds.collect(), config.actuators().len())
    }

    #[test]
    fn names_of_hosts_are_told_from_addresses() {
        let names = |text: &str| Config::parse(text, "test").unwrap().host_names();
        assert!(names("[built-in]\n").is_empty());
        assert!(names("[x-plane]\nsimulator = \"192.168.1.20\"\n").is_empty());
        assert_eq!(
            names(
                "[x-plane]\nsimulator = \"sim.lan\"\n[servo-board]\naddress = \"board.lan:5000\"\n\
                 [[sensor]]\nkind = \"servo-board\"\n"
            ),
            ["sim.lan:49000", "board.lan:5000"]
        );
    }

    #[test]
    fn a_simulator_provides_both_and_is_last_unless_it_is_listed() {
        assert_eq!(kinds("[built-in]\n"), (vec!["simulator"], 1));
        assert_eq!(
            kinds("[built-in]\n[[sensor]]\nkind = \"x-plane\"\n"),
            (vec!["x-plane", "simulator"], 1)
        );
        assert_eq!(
            kinds(
                "[x-plane]\n[[sensor]]\nkind = \"simulator\"\n\
                 [[sensor]]\nkind = \"x-plane\"\ninput = \"data\"\nlocal_port = 49005\n"
            ),
            (vec!["simulator", "x-plane"], 1)
        );
        assert_eq!(kinds("actuator = []\n[built-in]\n"), (vec!["simulator"], 0));
        assert_eq!(
            kinds("[built-in]\n[[actuator]]\nkind = \"simulator\"\n"),
            (vec!["simulator"], 1)
        );
    }

    fn message(text: &str) -> String {
        Config::parse(text, "test").unwrap_err().to_string()
    }

    #[test]
    fn an_error_in_an_entry_is_reported_with_its_line() {
        let two = "[built-in]\n[[sensor]]\nkind = \"x-plane\"\n[[sensor]]\n";
        assert_eq!(
            message(&format!("{two}kind = \"x-plane\"\nrate_hz = 0\n")),
            "test:6: sensor[1].rate_hz: is 0: choose 1 to 1000"
        );
        let unknown = message(&format!("{two}kind = \"x-plane\"\nrate = 10\n"));
        assert!(
            unknown.starts_with("test:6: sensor[1].rate: there is no such key"),
            "{unknown}"
        );
        let kind = message(&format!("{two}kind = \"gyroscope\"\n"));
        assert_eq!(
            kind,
            "test:5: sensor[1].kind: is \"gyroscope\": choose one of \"simulator\", \"x-plane\", \"iio\", \
             \"phone\", \"icm42688\", \"mpu6050\", \"bmp388\", \"bmp180\", \"ms4525do\", \"sdp3x\", \
             \"qmc5883l\", \"servo-board\", \"gnss-serial\", \"gpsd\", \"rc-receiver\", \
             \"gpio-switch\""
        );
        let missing = message(two);
        assert!(missing.contains("`kind` is missing"), "{missing}");
        let rows = message(&format!("{two}kind = \"x-plane\"\ninput = \"data\"\n"));
        assert!(rows.starts_with("test:4: sensor[1].local_port: "), "{rows}");
        let single = message("[built-in]\n[sensor]\nkind = \"x-plane\"\n");
        assert!(single.contains("[[sensor]]"), "{single}");
        let twice = message(
            "[built-in]\n[[sensor]]\nkind = \"simulator\"\n[[sensor]]\nkind = \"simulator\"\n",
        );
        assert_eq!(
            twice,
            "test:5: sensor[1].kind: is the simulator a second time: keep one"
        );
    }

    #[test]
    fn two_connections_have_two_ports() {
        let text = "[x-plane]\nlocal_port = 49005\n[[sensor]]\nkind = \"x-plane\"\n\
                    simulator = \"10.0.0.2\"\nlocal_port = 49005\n";
        assert_eq!(
            message(text),
            "test:6: sensor[0].local_port: is 49005, as x-plane.local_port: give each connection \
             its own port"
        );
        let own = message("[x-plane]\nsimulator = \"127.0.0.1:49557\"\nlocal_port = 49557\n");
        assert!(own.starts_with("test:3: x-plane.local_port: simulator 127.0.0.1:49557 is the"));
    }

    #[test]
    fn a_contradiction_of_two_keys_is_at_the_one_that_is_written() {
        let never = "[built-in]\n[autopilot.envelope]\nnever_exceed_airspeed_kt = 100\n";
        let words = "test:3: autopilot.envelope.never_exceed_airspeed_kt: contradicts \
                     autopilot.envelope.max_airspeed_kt, which is 135 by default, not in the file: \
                     choose at most";
        assert!(message(never).contains(words), "{}", message(never));
    }

    /// 1,000 frames a second in 20 ticks a second, and 250 in 40.
    #[test]
    fn a_tick_reads_all_datagrams_that_arrive_in_a_period() {
        let few = message("[x-plane]\nrate_hz = 1000\n[loop]\nrate_hz = 20\n");
        assert!(
            few.starts_with(
                "test:1: x-plane.datagrams_per_tick: is 128 by default, not in \
                 the file: choose at least 200 ="
            ),
            "{few}"
        );
        let one = "[built-in]\n[[sensor]]\nkind = \"x-plane\"\ndatagrams_per_tick = ";
        let few = message(&format!("{one}24\n"));
        assert!(few.contains("test:4: sensor[0].datagrams_per_tick: is 24: choose at least 25 ="));
        kinds(&format!("{one}25\n"));
    }

    #[test]
    fn all_errors_of_all_entries_are_reported() {
        let text = "[built-in]\n[[sensor]]\nkind = \"x-plane\"\nengines = true\nrate = 10\n\
                    silent_after_ms = 1\n[[sensor]]\nkind = \"x-plan\"\n[[actuator]]\nkind = 5\n";
        let all = message(text);
        let lines: Vec<&str> = all.lines().collect();
        let expected = [
            "test:4: sensor[0].engines: is true: choose a whole number",
            "test:5: sensor[0].rate: there is no such key, did you mean `rate_hz`?",
            "test:6: sensor[0].silent_after_ms: is 1: choose 50 to 60000",
            "test:8: sensor[1].kind: is \"x-plan\", did you mean \"x-plane\": choose",
            "test:10: actuator[0].kind: is a number: choose a text in quotes",
        ];
        assert_eq!(lines.len(), expected.len(), "{all}");
        for (line, begins) in lines.iter().zip(expected) {
            assert!(line.starts_with(begins), "{line}");
        }
    }

    #[test]
    fn an_entry_that_cannot_be_read_hides_no_other() {
        let text = "[[sensor]]\nkind = \"x-plan\"\nrate_hz = 0\n[[sensor]]\nkind = \"x-plane\"\n\
                    rate_hz = 0\nrat = 1\n[guidance]\nmode = \"loop\"\nhold_s = -1\nleg = 5\n";
        let all = message(text);
        let lines: Vec<Vec<&str>> = all
            .lines()
            .map(|line| line.split(": ").take(2).collect())
            .collect();
        let expected = [
            ["test:2", "sensor[0].kind"],
            ["test:6", "sensor[1].rate_hz"],
            ["test:7", "sensor[1].rat"],
            ["test:9", "guidance.mode"],
            ["test:10", "guidance.hold_s"],
            ["test:11", "guidance.leg"],
        ];
        assert_eq!(lines, expected.map(Vec::from), "{all}");
        let section = message("[built-in]\n[zzzzzz]\n");
        assert!(section.contains("`sensor`, `actuator`"), "{section}");
        let list = message("sensor = 5\n[built-in]\n");
        assert!(
            list.contains("sensor: is a number: choose a list"),
            "{list}"
        );
    }

    /// 250 ms by default.
    #[test]
    fn a_fallback_that_comes_too_late_is_reported() {
        let two = "[x-plane]\nengage_switch = \"sim/mine\"\n[[sensor]]\nkind = \"x-plane\"\n\
                   fallback_after_ms = ";
        let remarks = |text: &str| Config::parse(text, "test").unwrap().remarks(text);
        assert_eq!(remarks(&format!("{two}200\n")), [""; 0]);
        let [late] = &remarks(&format!("{two}250\n"))[..] else {
            panic!("one remark");
        };
        assert!(
            late.starts_with("sensor[0].fallback_after_ms is 250"),
            "{late}"
        );
        let alone = "[x-plane]\nengage_switch = \"sim/mine\"\nfallback_after_ms = 300\n";
        assert_eq!(remarks(alone), [""; 0]);
    }

    #[test]
    fn lists_alone_are_enough_without_a_simulator() {
        let own = "actuator = []\n[[sensor]]\nkind = \"x-plane\"\n";
        assert_eq!(kinds(own), (vec!["x-plane"], 0));
        let config = Config::parse(own, "test").unwrap();
        assert!(config.aircraft().is_none());
        let assembly = crate::flight::assemble(&config).unwrap();
        let parts = (assembly.sensors.len(), assembly.actuators.len());
        assert_eq!(parts, (1, 0));
        let unmoved = message("[[sensor]]\nkind = \"x-plane\"\n");
        assert!(unmoved.contains("add actuator = []"), "{unmoved}");
        for lacking in [
            "actuator = []\n",
            "actuator = []\n[[sensor]]\nkind = \"simulator\"\n",
        ] {
            let refused = message(lacking);
            assert!(
                refused.contains("neither [x-plane] nor [built-in]"),
                "{refused}"
            );
        }
    }

    #[test]
    fn lists_are_restored_unchanged() {
        let text = "actuator = []\n[built-in]\n[[sensor]]\nkind = \"x-plane\"\nrate_hz = 50\n\
                    [[sensor]]\nkind = \"simulator\"\n";
        let written = Config::parse(text, "test").unwrap().to_toml().unwrap();
        let again = Config::parse(&written, "again").unwrap();
        assert_eq!(again.to_toml().unwrap(), written);
        assert_eq!(again.sensors().count(), 2);
        assert!(again.actuators().is_empty());
    }
}

//! `[[sensor]]` and `[[actuator]]`: what measures and what is moved, beside a
//! simulator or in place of its parts.

use serde::{Deserialize, Serialize};

use super::{Config, XPlaneSection};

/// The most entries of a list. A reading has room for the number of its sensor
/// only, and each costs time in every tick.
pub(super) const MOST_ENTRIES: usize = 16;

/// One entry of `[[sensor]]`: a kind, and that kind's keys.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SensorEntry {
    /// The simulator's own, where it is not to be the last in the order.
    Simulator(NoKeys),
    /// An X-Plane that is read and never written to.
    XPlane(Box<XPlaneSection>),
}

/// One entry of `[[actuator]]`: a kind, and that kind's keys.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ActuatorEntry {
    /// The simulator's own.
    Simulator(NoKeys),
}

/// The keys of a kind that has none.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoKeys {}

static SIMULATOR: SensorEntry = SensorEntry::Simulator(NoKeys {});

impl Config {
    /// The sensors in their order of preference: those of `[[sensor]]`, and the
    /// simulator's last if it is not among them.
    pub fn sensors(&self) -> impl Iterator<Item = &SensorEntry> {
        let listed = self.sensor.iter();
        let is_listed = listed.clone().any(SensorEntry::is_simulator);
        listed.chain((!is_listed).then_some(&SIMULATOR))
    }

    /// Whether the simulator is moved: it is, unless there is a list of
    /// actuators and it is not among them.
    pub fn moves_simulator(&self) -> bool {
        self.actuator.as_ref().is_none_or(|list| !list.is_empty())
    }
}

impl SensorEntry {
    /// Whether it is the simulator's.
    pub fn is_simulator(&self) -> bool {
        matches!(self, Self::Simulator(_))
    }
}

/// The key of what is wrong in an entry of a list, as far as it can be told: the
/// reader of TOML says where the list begins and not which entry it complains of.
/// None where `key` is in no entry.
pub(super) fn in_entry(text: &str, key: &str, complaint: &str) -> Option<String> {
    let (list, _) = key.split_once('[')?;
    let table: toml::Table = toml::from_str(text).ok()?;
    let entries = table.get(list)?.as_array()?.iter().cloned();
    let is_wrong = |entry: toml::Value| match list {
        "sensor" => SensorEntry::deserialize(entry).is_err(),
        _ => ActuatorEntry::deserialize(entry).is_err(),
    };
    let at = entries.map(is_wrong).position(|is_wrong| is_wrong)?;
    let unknown = complaint.strip_prefix("unknown field `");
    let name = match unknown.and_then(|rest| rest.split('`').next()) {
        Some(name) => format!(".{name}"),
        None if complaint.starts_with("unknown variant") => ".kind".to_owned(),
        None => String::new(),
    };
    Some(format!("{list}[{at}]{name}"))
}

#[cfg(test)]
mod tests {
    use crate::config::{Config, SensorEntry};

    fn kinds(text: &str) -> (Vec<&'static str>, bool) {
        let config = Config::parse(text, "test").unwrap();
        let kinds = config.sensors().map(|entry| match entry {
            SensorEntry::Simulator(_) => "simulator",
            SensorEntry::XPlane(_) => "x-plane",
        });
        (kinds.collect(), config.moves_simulator())
    }

    #[test]
    fn a_simulator_gives_both_and_comes_last_unless_it_is_listed() {
        assert_eq!(kinds("[built-in]\n"), (vec!["simulator"], true));
        assert_eq!(
            kinds("[built-in]\n[[sensor]]\nkind = \"x-plane\"\n"),
            (vec!["x-plane", "simulator"], true)
        );
        assert_eq!(
            kinds(
                "[x-plane]\n[[sensor]]\nkind = \"simulator\"\n\
                 [[sensor]]\nkind = \"x-plane\"\ninput = \"data\"\nlocal_port = 49005\n"
            ),
            (vec!["simulator", "x-plane"], true)
        );
        assert_eq!(
            kinds("actuator = []\n[built-in]\n"),
            (vec!["simulator"], false)
        );
        assert_eq!(
            kinds("[built-in]\n[[actuator]]\nkind = \"simulator\"\n"),
            (vec!["simulator"], true)
        );
    }

    fn complaint(text: &str) -> String {
        Config::parse(text, "test").unwrap_err().to_string()
    }

    #[test]
    fn what_is_wrong_in_an_entry_is_said_with_its_line() {
        let two = "[built-in]\n[[sensor]]\nkind = \"x-plane\"\n[[sensor]]\n";
        assert_eq!(
            complaint(&format!("{two}kind = \"x-plane\"\nrate_hz = 0\n")),
            "test:6: sensor[1].rate_hz: is 0: choose 1 to 1000"
        );
        let unknown = complaint(&format!("{two}kind = \"x-plane\"\nrate = 10\n"));
        assert!(
            unknown.starts_with("test:6: sensor[1].rate: there is no such key"),
            "{unknown}"
        );
        let kind = complaint(&format!("{two}kind = \"gyroscope\"\n"));
        assert_eq!(
            kind,
            "test:5: sensor[1].kind: is \"gyroscope\": choose \"simulator\" or \"x-plane\""
        );
        let value = complaint(&format!("{two}kind = \"x-plane\"\nengines = true\n"));
        assert!(value.starts_with("test:4: sensor[1]: is true"), "{value}");
        let missing = complaint(two);
        assert!(missing.contains("`kind` is missing"), "{missing}");
        let rows = complaint(&format!("{two}kind = \"x-plane\"\ninput = \"data\"\n"));
        assert!(rows.starts_with("test:4: sensor[1].local_port: "), "{rows}");
        let single = complaint("[built-in]\n[sensor]\nkind = \"x-plane\"\n");
        assert!(single.contains("[[sensor]]"), "{single}");
        let twice = complaint(
            "[built-in]\n[[sensor]]\nkind = \"simulator\"\n[[sensor]]\nkind = \"simulator\"\n",
        );
        assert_eq!(
            twice,
            "test:5: sensor[1].kind: is the simulator a second time: keep one"
        );
    }

    #[test]
    fn lists_read_back_as_they_were() {
        let text = "actuator = []\n[built-in]\n[[sensor]]\nkind = \"x-plane\"\nrate_hz = 50\n\
                    [[sensor]]\nkind = \"simulator\"\n";
        let written = Config::parse(text, "test").unwrap().to_toml().unwrap();
        let again = Config::parse(&written, "again").unwrap();
        assert_eq!(again.to_toml().unwrap(), written);
        assert_eq!(again.sensors().count(), 2);
        assert!(!again.moves_simulator());
    }
}

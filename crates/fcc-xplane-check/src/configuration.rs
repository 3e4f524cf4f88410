//! The daemon's configuration during the check: the user's, but for what it
//! flies, and where it writes.

use std::path::Path;

use toml::{Table, Value};

use crate::waits::Waits;

/// What the daemon flies after it engages.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Guidance {
    Hold,
    Pattern,
}

/// The configuration cannot be used.
#[derive(thiserror::Error, Debug)]
pub enum ConfigurationError {
    /// It is not TOML.
    #[error("the configuration is not TOML: {0}")]
    NotToml(#[from] toml::de::Error),
    /// The changed one cannot be written.
    #[error("the configuration for the check cannot be written: {0}")]
    NotWritten(#[from] toml::ser::Error),
}

/// The text of the configuration with which the daemon is started.
pub(crate) fn text(
    given: &str,
    guidance: Guidance,
    waits: &Waits,
    folder: &Path,
) -> Result<String, ConfigurationError> {
    let mut table: Table = given.parse()?;
    let mut pattern = Table::new();
    match guidance {
        Guidance::Hold => {
            pattern.insert("mode".to_owned(), "hold".into());
        }
        Guidance::Pattern => {
            pattern.insert("mode".to_owned(), "timed-pattern".into());
            for (key, value) in [
                ("hold_s", waits.hold_s),
                ("leg_s", waits.leg_s),
                ("turn_deg", waits.turn_deg),
                ("climb_ft", waits.climb_ft),
            ] {
                pattern.insert(key.to_owned(), value.into());
            }
        }
    }
    table.insert("guidance".to_owned(), Value::Table(pattern));
    // Its recordings stay with the report, and no earlier flight is continued.
    let folder = folder.join("recordings").display().to_string();
    set(&mut table, "recording", "folder", folder.into());
    set(&mut table, "restart", "mode", "cold".into());
    set(&mut table, "engage", "switch_off", "standby".into());
    // Where no write can move the switch, a command engages.
    set(&mut table, "engage", "command_needs_switch", false.into());
    set(&mut table, "telemetry", "enabled", true.into());
    set(&mut table, "telemetry", "commands", true.into());
    Ok(toml::to_string(&table)?)
}

fn set(table: &mut Table, section: &str, key: &str, value: Value) {
    let section = table
        .entry(section)
        .or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(section) = section {
        section.insert(key.to_owned(), value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::waits::FULL;

    #[test]
    fn the_users_gains_and_address_are_kept() {
        let given = "[x-plane]\nsimulator = \"10.0.0.5:49000\"\n[autopilot.scale]\nroll = 1.5\n\
                     [guidance]\nmode = \"timed-pattern\"\nleg_s = 60.0\n";
        let text = text(given, Guidance::Pattern, &FULL, Path::new("/tmp/x")).unwrap();
        let table: Table = text.parse().unwrap();
        assert_eq!(
            table["x-plane"]["simulator"].as_str(),
            Some("10.0.0.5:49000")
        );
        assert_eq!(table["autopilot"]["scale"]["roll"].as_float(), Some(1.5));
        assert_eq!(table["guidance"]["leg_s"].as_float(), Some(20.0));
        assert_eq!(table["restart"]["mode"].as_str(), Some("cold"));
    }
}

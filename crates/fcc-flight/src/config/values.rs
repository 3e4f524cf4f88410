//! Access to a configuration by its keys, for programs that read or change
//! single values.

use toml::Value;
use toml::map::Entry;

use super::places::indexed;
use super::wording::renamed;
use super::{Config, ConfigError, Problem};

/// The configuration's name in messages without a file.
const NO_FILE: &str = "config";
/// The key that says which others its section has.
const MODE: &str = "guidance.mode";

impl Config {
    /// The whole configuration, defaults included, as TOML.
    ///
    /// # Errors
    /// When a number is too large for TOML, which has no integers above
    /// [`i64::MAX`].
    pub fn to_toml(&self) -> Result<String, ConfigError> {
        toml::to_string(self).map_err(|error| invalid(None, error.to_string()))
    }

    /// All values, section by section.
    ///
    /// # Errors
    /// As [`to_toml`](Self::to_toml).
    pub fn values(&self) -> Result<Value, ConfigError> {
        Value::try_from(self).map_err(|error| invalid(None, error.to_string()))
    }

    /// The value of a key with its sections, such as
    /// `autopilot.envelope.max_bank_deg`, or a whole section.
    ///
    /// # Errors
    /// When there is no such key.
    pub fn value(&self, key: &str) -> Result<Value, ConfigError> {
        let values = self.values()?;
        let found = key
            .split('.')
            .try_fold(&values, |section, part| match indexed(part) {
                (name, Some(index)) => section.get(name)?.get(index),
                (name, None) => section.get(name),
            });
        found.cloned().ok_or_else(|| unknown(key))
    }

    /// The configuration with other values for some keys; a key with a table
    /// changes the whole section, another `guidance.mode` drops the keys of the one before, and
    /// another `plan.file` the plan that was recorded. Everything is checked like a file.
    ///
    /// # Errors
    /// When there is no such key, or a value is out of its range: the messages
    /// of [`Config::parse`], without lines, as there is no file.
    pub fn with_values<'k>(
        &self,
        changes: impl IntoIterator<Item = (&'k str, Value)>,
    ) -> Result<Self, ConfigError> {
        let mut values = self.values()?;
        let changes: Vec<_> = changes.into_iter().collect();
        let is_other = |(key, mode): &(&str, Value)| {
            *key == MODE && self.value(MODE).is_ok_and(|before| before != *mode)
        };
        if changes.iter().any(is_other) {
            // The other keys of the section are of the mode before.
            put(&mut values, "guidance", Value::Table(toml::Table::new()));
        }
        if changes.iter().any(|(key, _)| *key == "plan.file")
            && let Some(plan) = values.get_mut("plan").and_then(Value::as_table_mut)
        {
            plan.retain(|key, _| key != "content" && key != "uploaded_unix_s");
        }
        for (key, value) in &changes {
            put(&mut values, key, value.clone()).ok_or_else(|| unknown(key))?;
        }
        // Messages name a default as such, as they do of a text.
        let defaults = Self::parse_without_aircraft("", NO_FILE)?.values()?;
        without_defaults(&mut values, &defaults);
        for (key, value) in changes {
            put(&mut values, key, value);
        }
        let text = toml::to_string(&values).map_err(|error| invalid(None, error.to_string()))?;
        Self::parse_without_aircraft(&text, NO_FILE).map_err(without_lines)
    }
}

/// Removes each value that is the default of its key, but not of a section whose defaults
/// are those of its mode.
fn without_defaults(values: &mut Value, defaults: &Value) {
    let Some(values) = values.as_table_mut() else {
        return;
    };
    values.retain(|key, value| {
        let default = defaults.get(key).filter(|_| key != "guidance");
        if let Some(default) = default.filter(|_| value.is_table()) {
            without_defaults(value, default);
            return true;
        }
        default.is_none_or(|default| default != value)
    });
}

/// All sections and values below one, each with its key, in the order of a file.
pub fn keyed(value: &Value) -> Vec<(String, &Value)> {
    let mut found = Vec::new();
    for (name, inner) in value.as_table().into_iter().flatten() {
        found.push((name.clone(), inner));
        let below = keyed(inner).into_iter();
        found.extend(below.map(|(key, value)| (format!("{name}.{key}"), value)));
    }
    found
}

/// Sets a value at its key; none if a section on the path is a value.
fn put(values: &mut Value, key: &str, value: Value) -> Option<()> {
    let (sections, name) = match key.rsplit_once('.') {
        Some((sections, name)) => (Some(sections), name),
        None => (None, key),
    };
    let mut section = values.as_table_mut()?;
    for part in sections.iter().flat_map(|sections| sections.split('.')) {
        let inner = match section.entry(part) {
            Entry::Occupied(there) => there.into_mut(),
            Entry::Vacant(free) => free.insert(Value::Table(toml::Table::new())),
        };
        section = inner.as_table_mut()?;
    }
    section.insert(name.to_owned(), value);
    Some(())
}

fn unknown(key: &str) -> ConfigError {
    let message = renamed(key).unwrap_or_else(|| "there is no such key".to_owned());
    invalid(Some(key), message)
}

fn invalid(key: Option<&str>, message: String) -> ConfigError {
    ConfigError::Invalid {
        file: NO_FILE.to_owned(),
        problems: vec![Problem {
            line: None,
            key: key.map(str::to_owned),
            message,
        }],
    }
}

/// Lines of a generated text are meaningless to users.
fn without_lines(error: ConfigError) -> ConfigError {
    match error {
        ConfigError::Invalid { file, mut problems } => {
            for problem in &mut problems {
                problem.line = None;
            }
            ConfigError::Invalid { file, problems }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain() -> Config {
        Config::parse_without_aircraft("", "test").unwrap()
    }

    #[test]
    fn a_value_is_found_and_changed_by_its_key() {
        const KEY: &str = "autopilot.envelope.max_bank_deg";
        let changed = plain().with_values([(KEY, Value::Integer(20))]).unwrap();
        assert_eq!(changed.value(KEY).unwrap().as_float(), Some(20.0));
        assert_eq!(
            plain().value("loop.rate_hz").unwrap().as_float(),
            Some(40.0)
        );
    }

    #[test]
    fn another_mode_has_not_the_keys_of_the_one_before() {
        let text = |text: &str| Value::String(text.to_owned());
        let pattern = plain();
        let hold = pattern.with_values([(MODE, text("hold"))]).unwrap();
        assert_eq!(hold.value("guidance").unwrap().as_table().unwrap().len(), 1);
        let short = ("guidance.leg_s", Value::Float(30.0));
        let back = [short.clone(), (MODE, text("timed-pattern"))];
        let back = hold.with_values(back).unwrap();
        assert_eq!(back.value("guidance.leg_s").unwrap().as_float(), Some(30.0));
        let same = back.with_values([(MODE, text("timed-pattern"))]).unwrap();
        assert_eq!(same.value("guidance.leg_s").unwrap().as_float(), Some(30.0));
        let both = pattern.with_values([(MODE, text("hold")), short]);
        let said = both.unwrap_err().to_string();
        assert!(
            said.contains("a hold and a plan have no hold_s, leg_s"),
            "{said}"
        );
    }

    #[test]
    fn a_section_is_changed_as_a_whole() {
        let hold = toml::from_str("mode = \"hold\"").unwrap();
        let changed = plain()
            .with_values([("guidance", Value::Table(hold))])
            .unwrap();
        assert_eq!(
            changed.value("guidance.mode").unwrap().as_str(),
            Some("hold")
        );
    }

    #[test]
    fn errors_have_the_messages_of_a_file() {
        let words =
            |key: &str, value: Value| plain().with_values([(key, value)]).unwrap_err().to_string();
        assert_eq!(
            words("autopilot.envelope.max_bank_deg", Value::Float(95.0)),
            "config: autopilot.envelope.max_bank_deg: is 95: choose 5 to 60"
        );
        let unknown = words("autopilot.bank", Value::Float(1.0));
        assert!(unknown.contains("there is no such key"), "{unknown}");
        let former = words("course.kind", Value::String("hold".to_owned()));
        assert!(former.contains("[guidance], its kind mode"), "{former}");
        let stage = words("budget.guidance_us", Value::Integer(1_000));
        assert!(stage.contains("is called guide_us"), "{stage}");
        let through = words("loop.rate_hz.x", Value::Float(1.0));
        assert_eq!(through, "config: loop.rate_hz.x: there is no such key");
        let nan = words("loop.rate_hz", Value::Float(f64::NAN));
        assert!(
            nan.contains("loop.rate_hz: is NaN: choose 20 to 2000"),
            "{nan}"
        );
        let missing = plain().value("loop.hz").unwrap_err().to_string();
        assert_eq!(missing, "config: loop.hz: there is no such key");
    }

    #[test]
    fn the_whole_configuration_is_restored_unchanged() {
        let text = plain().to_toml().unwrap();
        let again = Config::parse(&text, "again").unwrap().to_toml().unwrap();
        assert_eq!(text, again);
    }
}

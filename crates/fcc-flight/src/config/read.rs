//! Reads a text into a configuration, and collects all errors.
//!
//! The reader of values stops at the first error. So the key of each error is
//! removed from the table, and reading is repeated: the rest is read as if that
//! key were not given. This file is independent of the sections.

use serde::de::{DeserializeOwned, Error as _};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

use super::entry::{Entry, Keys};
use super::places::{Places, line_of};
use super::wording::reword;
use super::{Config, Problem};

/// No more problems are looked for: each costs a reading of the rest.
pub(super) const MOST_PROBLEMS: usize = 100;

/// The maximum number of entries of a list. A reading stores its sensor's
/// number in a byte, and each entry costs time in every tick.
const MOST_ENTRIES: usize = 16;

/// A configuration as far as it could be read, and the errors in the rest.
pub(super) struct Read<'t> {
    pub(super) config: Config,
    pub(super) problems: Vec<Problem>,
    pub(super) places: Places<'t>,
}

/// Reads a text.
pub(super) fn read(text: &str) -> Read<'_> {
    let (mut table, broken) = DeTable::parse_recoverable(text);
    let places = Places::new(text, table.clone());
    let mut problems: Vec<Problem> = Vec::new();
    for error in &broken {
        let found = syntax(text, error);
        // An error in a line is often found twice.
        if problems.last().is_none_or(|last| last.line != found.line) {
            problems.push(found);
        }
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
    }
    let mut reader = Reader {
        text,
        places,
        broken: problems.len(),
        problems,
    };
    let header = broken_header(text, &reader.problems);
    let sensor = reader.list(&mut table, "sensor");
    let actuator = reader.list(&mut table, "actuator");
    let read = reader.table(table, 0).unwrap_or_default();
    if let Some(header) = header {
        // The keys below it are read as if they stood in no section.
        reader.problems.retain(|problem| {
            let in_section = problem.key.as_ref().is_none_or(|key| key.contains('.'));
            in_section || problem.line <= Some(header)
        });
    }
    Read {
        config: Config {
            sensor: sensor.unwrap_or_default(),
            actuator,
            ..read
        },
        problems: reader.problems,
        places: reader.places,
    }
}

/// The line of the first section's header with an error in it.
fn broken_header(text: &str, broken: &[Problem]) -> Option<usize> {
    let lines: Vec<&str> = text.lines().collect();
    let mut at = broken.iter().filter_map(|problem| problem.line);
    at.find(|line| {
        let text = line.checked_sub(1).and_then(|index| lines.get(index));
        text.is_some_and(|text| text.trim_start().starts_with('['))
    })
}

/// An error of TOML's syntax. The table recovered from such a text is not
/// reliable for keys.
fn syntax(text: &str, error: &Error) -> Problem {
    let span = error.span();
    let line = span.as_ref().map(|span| line_of(text, span));
    let key = span.and_then(|span| Places::key_by_lines(text, span.start));
    Problem {
        line,
        message: reword(error.message(), key.as_deref()),
        key,
    }
}

/// Reads nothing: the list was taken out of the table before, and read apart.
#[expect(clippy::unnecessary_wraps, reason = "serde requires it")]
pub(super) fn apart<'de, T: Default, D: serde::Deserializer<'de>>(_: D) -> Result<T, D::Error> {
    Ok(T::default())
}

/// A value's type, as the reader's own errors name it.
fn found(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "sequence",
        DeValue::Table(_) => "map",
    }
}

/// A table of a configuration, which one type is read from.
pub(super) struct Reader<'t> {
    text: &'t str,
    places: Places<'t>,
    problems: Vec<Problem>,
    /// The number of those of syntax, which come first.
    broken: usize,
}

impl<'t> Keys<'t> for Reader<'t> {
    fn table<T: DeserializeOwned>(
        &mut self,
        mut table: Spanned<DeTable<'t>>,
        depth: usize,
    ) -> Option<T> {
        while self.problems.len() < MOST_PROBLEMS {
            let error = match T::deserialize(Deserializer::from(table.clone())) {
                Ok(read) => return Some(read),
                Err(error) => error,
            };
            let path = error.span().map(|span| self.places.path_at(span.start));
            let path = path.unwrap_or_default();
            // A missing field may have been removed before.
            let section = path.join(".") + ".";
            let in_section = |problem: &Problem| {
                let key = problem.key.as_deref().unwrap_or_default();
                key.starts_with(&section)
            };
            if !(error.message().starts_with("missing field")
                && self.problems.iter().any(in_section))
            {
                let line = error.span().map(|span| line_of(self.text, &span));
                self.report(line, path.join("."), &error);
            }
            if !remove(&mut table, path.get(depth..).unwrap_or_default()) {
                return None;
            }
        }
        None
    }
}

impl<'t> Reader<'t> {
    /// Takes a list out of a table and reads its entries; none if it is not
    /// given.
    fn list<T: Entry>(&mut self, table: &mut Spanned<DeTable<'t>>, name: &str) -> Option<Vec<T>> {
        let list = table.get_mut().remove(name)?;
        let line = Some(line_of(self.text, &list.span()));
        let entries = match list.into_inner() {
            DeValue::Array(entries) => entries,
            other => {
                self.wrong_type(line, name, &other, "a sequence");
                return None;
            }
        };
        if entries.len() > MOST_ENTRIES {
            let message =
                format_args!("has {} entries: keep at most {MOST_ENTRIES}", entries.len());
            self.report(line, name.to_owned(), &Error::custom(message));
            return None;
        }
        let entries = entries.into_iter().enumerate();
        let read: Vec<Option<T>> = entries
            .map(|(at, entry)| self.entry(entry, &format!("{name}[{at}]")))
            .collect();
        let read = read.into_iter();
        Some(read.filter_map(|entry| entry.or_else(T::unread)).collect())
    }

    /// Reads an entry of a list: its kind, and the other keys as that kind's.
    fn entry<T: Entry>(&mut self, entry: Spanned<DeValue<'t>>, key: &str) -> Option<T> {
        let span = entry.span();
        let line = Some(line_of(self.text, &span));
        let mut keys = match entry.into_inner() {
            DeValue::Table(keys) => keys,
            other => {
                self.wrong_type(line, key, &other, "struct entry");
                return None;
            }
        };
        let Some(kind) = keys.remove("kind") else {
            self.report(line, key.to_owned(), &Error::missing_field("kind"));
            return None;
        };
        let line = Some(line_of(self.text, &kind.span()));
        let kind_key = format!("{key}.kind");
        let Some(kind) = kind.get_ref().as_str() else {
            self.wrong_type(line, &kind_key, kind.get_ref(), "a string");
            return None;
        };
        if !T::KINDS.contains(&kind) {
            self.report(line, kind_key, &Error::unknown_variant(kind, T::KINDS));
            return None;
        }
        T::read(kind, Spanned::new(span, keys), self)
    }

    fn wrong_type(&mut self, line: Option<usize>, key: &str, value: &DeValue<'_>, wanted: &str) {
        let found = found(value);
        let message = format_args!("invalid type: {found}, expected {wanted}");
        self.report(line, key.to_owned(), &Error::custom(message));
    }

    fn report(&mut self, line: Option<usize>, key: String, error: &Error) {
        // The value of a line with an error of syntax is not what was written.
        if line.is_some()
            && self
                .problems
                .iter()
                .take(self.broken)
                .any(|p| p.line == line)
        {
            return;
        }
        let key = (!key.is_empty()).then_some(key);
        self.problems.push(Problem {
            line,
            message: reword(error.message(), key.as_deref()),
            key,
        });
    }
}

/// Removes the value at a path from a table; returns whether there was one.
fn remove(table: &mut Spanned<DeTable<'_>>, path: &[String]) -> bool {
    let Some((last, sections)) = path.split_last() else {
        return false;
    };
    let inner = sections.iter().try_fold(table.get_mut(), |inner, section| {
        match inner.get_mut(section.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(next)) => Some(next),
            _ => None,
        }
    });
    // Of a list's entry, the whole list.
    let list = last.split_once('[').map_or("", |(list, _)| list);
    inner.is_some_and(|inner| {
        inner
            .remove(last.as_str())
            .or_else(|| inner.remove(list))
            .is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::MOST_PROBLEMS;
    use crate::config::{Config, Problem};

    fn problems(text: &str) -> Vec<Problem> {
        Config::parse(text, "f").unwrap_err().problems()
    }

    /// All of them took from 4 s to minutes: each is looked for in the whole text.
    #[test]
    fn a_text_of_nothing_but_problems_is_refused_after_the_first_hundred() {
        let keys = (0..10_000).fold("[built-in]\n".to_owned(), |text, n| {
            text + &format!("k{n} = 1\n")
        });
        for text in [keys, "=\n".repeat(100_000)] {
            let found = problems(&text);
            let (last, first) = found.split_last().unwrap();
            assert!(first.len() <= MOST_PROBLEMS, "{}", first.len());
            assert_eq!(last.message, "has more problems: correct these first");
        }
    }

    #[test]
    fn keys_below_a_broken_header_are_no_second_problem() {
        let found = problems("[built-in]\nairspeed = 90.0\n[loop\nrate_hz = 40\n");
        let lines: Vec<_> = found.iter().map(|problem| problem.line).collect();
        assert_eq!(lines, [Some(2), Some(3)]);
    }

    /// The adapter's own checks follow those of the ranges.
    #[test]
    fn a_number_that_is_no_duration_is_a_problem() {
        for value in ["-1", "nan", "1e300"] {
            let found = problems(&format!("[x-plane]\nresubscribe_s = {value}\n"));
            let keys: Vec<_> = found.iter().map(|problem| problem.key.as_deref()).collect();
            assert_eq!(keys, [Some("x-plane.resubscribe_s")], "{value}");
        }
    }

    #[test]
    fn a_long_list_is_refused_as_a_whole() {
        for entry in [
            "[[sensor]]\nkind = \"no\"\n",
            "[[actuator]]\nkind = \"simulator\"\n",
        ] {
            let found = problems(&format!("[x-plane]\n{}", entry.repeat(17)));
            let messages: Vec<_> = found.iter().map(|problem| &*problem.message).collect();
            assert_eq!(messages, ["has 17 entries: keep at most 16"]);
        }
    }

    #[test]
    fn only_the_beginning_of_a_long_key_and_value_is_quoted() {
        let long = "k".repeat(900_000);
        let found = problems(&format!("[built-in]\n{long} = 1\ngusts = \"{long}\"\n"));
        assert_eq!(found.len(), 2);
        for problem in found {
            let key = problem.key.unwrap();
            assert!(key.chars().count() <= 201, "{}", key.len());
            assert!(problem.message.chars().count() <= 1_001);
        }
    }
}

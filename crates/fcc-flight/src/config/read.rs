//! Reads a text into a configuration, and collects all errors.
//!
//! The reader of values stops at the first error. So the key of each error is
//! removed from the table, and reading is repeated: the rest is read as if that
//! key were not given. This file is independent of the sections.

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

use super::devices::in_entry;
use super::places::{Places, line_of};
use super::wording::reword;
use super::{Config, Problem};

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
    let mut problems: Vec<Problem> = broken.iter().map(|error| syntax(text, error)).collect();
    // An error in a line is often found twice.
    problems.dedup_by_key(|problem| problem.line);
    let config = loop {
        let error = match Config::deserialize(Deserializer::from(table.clone())) {
            Ok(config) => break config,
            Err(error) => error,
        };
        let path = error.span().map(|span| places.path_at(span.start));
        let path = path.unwrap_or_default();
        // A missing field may have been removed before.
        let section = path.join(".") + ".";
        let in_section = |problem: &Problem| {
            let key = problem.key.as_deref().unwrap_or_default();
            key.starts_with(&section)
        };
        if !(error.message().starts_with("missing field") && problems.iter().any(in_section)) {
            problems.push(value(text, &places, &path, &error));
        }
        if !remove(&mut table, &path) {
            break Config::default();
        }
    };
    Read {
        config,
        problems,
        places,
    }
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

fn value(text: &str, places: &Places<'_>, path: &[String], error: &Error) -> Problem {
    let key = (!path.is_empty()).then(|| path.join("."));
    // The entry of a list is read as a whole, so its keys have no positions.
    let inside = key
        .as_deref()
        .and_then(|key| in_entry(text, key, error.message()));
    let line = match &inside {
        Some(key) => places.nearest_line(key),
        None => error.span().map(|span| line_of(text, &span)),
    };
    let key = inside.or(key);
    Problem {
        line,
        message: reword(error.message(), key.as_deref()),
        key,
    }
}

/// Removes the value at a path from a table, a list as a whole; returns whether
/// there was one.
fn remove(table: &mut Spanned<DeTable<'_>>, path: &[String]) -> bool {
    let mut inner = table.get_mut();
    for (depth, part) in path.iter().enumerate() {
        let (name, is_list) = match part.split_once('[') {
            Some((name, _)) => (name, true),
            None => (part.as_str(), false),
        };
        if is_list || depth + 1 == path.len() {
            return inner.remove(name).is_some();
        }
        match inner.get_mut(name).map(Spanned::get_mut) {
            Some(DeValue::Table(next)) => inner = next,
            _ => return false,
        }
    }
    false
}

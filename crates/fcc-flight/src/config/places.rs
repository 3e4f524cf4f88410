//! The positions of the keys in a configuration text.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The positions of the keys in a text.
pub(super) struct Places<'a> {
    text: &'a str,
    table: Spanned<DeTable<'a>>,
}

impl<'a> Places<'a> {
    /// For a text and the table that was read from it.
    pub(super) const fn new(text: &'a str, table: Spanned<DeTable<'a>>) -> Self {
        Self { text, table }
    }

    /// Whether the text contains a key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// The value of a key as it is given, valid or not.
    pub(super) fn value(&self, key: &str) -> Option<&DeValue<'a>> {
        let mut table = Some(self.table.get_ref());
        let mut found = None;
        for part in key.split('.') {
            let (name, index) = indexed(part);
            let value = table?.get(name)?.get_ref();
            let value = match index {
                Some(index) => value.as_array()?.get(index)?.get_ref(),
                None => value,
            };
            table = value.as_table();
            found = Some(value);
        }
        found
    }

    /// The number of a key; none if it is not given, or no number.
    pub(super) fn number(&self, key: &str) -> Option<f64> {
        match self.value(key)? {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Integer(integer) => {
                let integer = i128::from_str_radix(integer.as_str(), integer.radix());
                integer.ok().map(|integer| integer as f64)
            }
            _ => None,
        }
    }

    /// The line of a key or, if it is not in the text, of its section.
    pub(super) fn nearest_line(&self, key: &str) -> Option<usize> {
        let mut table = self.table.get_ref();
        let mut found = None;
        for part in key.split('.') {
            let (part, index) = indexed(part);
            let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref() == part) else {
                break;
            };
            found = Some(line_of(self.text, &name.span()));
            let entry = index.and_then(|index| value.get_ref().as_array()?.get(index));
            if let Some(entry) = entry {
                found = Some(line_of(self.text, &entry.span()));
            }
            match entry.unwrap_or(value).get_ref().as_table() {
                Some(inner) => table = inner,
                None => break,
            }
        }
        found
    }

    /// The sections and the key at a position in the text; empty if there is no
    /// key.
    pub(super) fn path_at(&self, offset: usize) -> Vec<String> {
        path_to(self.table.get_ref(), offset).unwrap_or_default()
    }

    /// The key at a position in a text that is not valid TOML: the nearest
    /// section above, and the text before the equals sign.
    pub(super) fn key_by_lines(text: &str, offset: usize) -> Option<String> {
        let line = line_of(text, &(offset..offset));
        let found = text.lines().nth(line - 1)?.trim();
        if let Some(section) = found.strip_prefix('[') {
            return section_of(section);
        }
        let (key, _) = found.split_once('=')?;
        let key = key.trim();
        let section = text
            .lines()
            .take(line - 1)
            .filter_map(|line| section_of(line.trim().strip_prefix('[')?))
            .last();
        Some(match section {
            Some(section) => format!("{section}.{key}"),
            None => key.to_owned(),
        })
    }
}

/// The name in a header behind its first bracket.
fn section_of(header: &str) -> Option<String> {
    let (section, _) = header.trim_start_matches('[').split_once(']')?;
    Some(section.trim().to_owned())
}

/// The parts of `sensor[1]`; no index for a plain name.
pub(super) fn indexed(part: &str) -> (&str, Option<usize>) {
    let parts = part
        .strip_suffix(']')
        .and_then(|part| part.split_once('['))
        .and_then(|(name, index)| Some((name, index.parse().ok()?)));
    parts.map_or((part, None), |(name, index)| (name, Some(index)))
}

/// The path to the innermost key or value around a position.
fn path_to(table: &DeTable<'_>, offset: usize) -> Option<Vec<String>> {
    table.iter().find_map(|(name, value)| {
        let is_in = |span: Range<usize>| span.contains(&offset);
        let (index, inside) = match value.get_ref() {
            DeValue::Table(inner) => (None, path_to(inner, offset)),
            DeValue::Array(entries) => entries
                .iter()
                .enumerate()
                .find_map(|(index, entry)| {
                    let inside = entry.get_ref().as_table();
                    let inside = inside.and_then(|inside| path_to(inside, offset));
                    let here = || is_in(entry.span()).then(Vec::new);
                    Some((Some(index), Some(inside.or_else(here)?)))
                })
                .unwrap_or_default(),
            _ => (None, None),
        };
        let here = || (is_in(name.span()) || is_in(value.span())).then(Vec::new);
        let mut path = inside.or_else(here)?;
        let name = name.get_ref();
        path.insert(
            0,
            index.map_or_else(|| name.to_string(), |index| format!("{name}[{index}]")),
        );
        Some(path)
    })
}

/// The line that a span of the text begins in, from 1.
pub(super) fn line_of(text: &str, span: &Range<usize>) -> usize {
    text.bytes()
        .take(span.start)
        .filter(|byte| *byte == b'\n')
        .count()
        + 1
}

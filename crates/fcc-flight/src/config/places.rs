//! Where the keys of a configuration text are.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where the keys of a text are.
pub(super) struct Places<'a> {
    text: &'a str,
    table: Spanned<DeTable<'a>>,
}

impl<'a> Places<'a> {
    /// Of a text, and of what could be made of it.
    pub(super) const fn new(text: &'a str, table: Spanned<DeTable<'a>>) -> Self {
        Self { text, table }
    }

    /// Whether the text gives a key.
    pub(super) fn has(&self, key: &str) -> bool {
        let (sections, name) = key.rsplit_once('.').unwrap_or(("", key));
        let sections = sections.split('.').filter(|section| !section.is_empty());
        let mut table = self.table.get_ref();
        for section in sections {
            match table.get(section).map(|value| value.get_ref().as_table()) {
                Some(Some(inner)) => table = inner,
                _ => return false,
            }
        }
        table.contains_key(name)
    }

    /// The line of a key or, if the text leaves it out, of its section.
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

    /// The sections and the key that a place in the text belongs to; none of
    /// them where it belongs to no key.
    pub(super) fn path_at(&self, offset: usize) -> Vec<String> {
        path_to(self.table.get_ref(), offset).unwrap_or_default()
    }

    /// The key at a place in a text that is no TOML: the nearest section above, and what
    /// stands before the equals sign.
    pub(super) fn key_by_lines(text: &str, offset: usize) -> Option<String> {
        let line = line_of(text, &(offset..offset));
        let (key, _) = text.lines().nth(line - 1)?.split_once('=')?;
        let key = key.trim();
        let section = text
            .lines()
            .take(line - 1)
            .filter_map(|line| line.trim().strip_prefix('[')?.split_once(']'))
            .last();
        Some(match section {
            Some((section, _)) => format!("{}.{key}", section.trim()),
            None => key.to_owned(),
        })
    }
}

/// The parts of `sensor[1]`; no index for a plain name.
fn indexed(part: &str) -> (&str, Option<usize>) {
    let parts = part
        .strip_suffix(']')
        .and_then(|part| part.split_once('['))
        .and_then(|(name, index)| Some((name, index.parse().ok()?)));
    parts.map_or((part, None), |(name, index)| (name, Some(index)))
}

/// The names that lead to the innermost key or value around a place.
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

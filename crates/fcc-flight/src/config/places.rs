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
            let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref() == part) else {
                break;
            };
            found = Some(line_of(self.text, &name.span()));
            match value.get_ref().as_table() {
                Some(inner) => table = inner,
                None => break,
            }
        }
        found
    }

    /// The sections and the key that a place in the text belongs to; none of
    /// them where it belongs to no key.
    pub(super) fn path_at(&self, offset: usize) -> Vec<String> {
        path_to(self.table.get_ref(), offset)
            .unwrap_or_default()
            .into_iter()
            .map(str::to_owned)
            .collect()
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

/// The names that lead to the innermost key or value around a place.
fn path_to<'t>(table: &'t DeTable<'_>, offset: usize) -> Option<Vec<&'t str>> {
    table.iter().find_map(|(name, value)| {
        let inside = match value.get_ref() {
            DeValue::Table(inner) => path_to(inner, offset),
            _ => None,
        };
        let here =
            || (name.span().contains(&offset) || value.span().contains(&offset)).then(Vec::new);
        let mut path = inside.or_else(here)?;
        path.insert(0, name.get_ref());
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

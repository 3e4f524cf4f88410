//! Entries of a list, and how their keys are read.

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::DeTable;

/// Reads the keys of a table as a type's.
pub(super) trait Keys<'t> {
    /// Reads a table that is `depth` sections below the text's own; none if
    /// that is impossible without the keys that are wrong.
    fn table<T: DeserializeOwned>(&mut self, keys: Spanned<DeTable<'t>>, depth: usize)
    -> Option<T>;
}

/// An entry of a list: a kind, and that kind's keys.
pub(super) trait Entry: Sized {
    /// The kinds as a configuration names them.
    const KINDS: &'static [&'static str];

    /// Reads the keys of one of the kinds; none if that is impossible.
    fn read<'t>(kind: &str, keys: Spanned<DeTable<'t>>, reader: &mut impl Keys<'t>)
    -> Option<Self>;

    /// What stands for an entry that could not be read, so that the following
    /// ones keep their numbers; none if it is left out.
    fn unread() -> Option<Self> {
        None
    }
}

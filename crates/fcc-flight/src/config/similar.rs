//! Suggestions for mistyped names.

use std::sync::LazyLock;

use super::schema;

/// The minimum similarity of a suggestion: 1 means equal (Winkler, 1990).
const ALIKE: f64 = 0.8;

/// The name most similar to the given one, if one is similar enough.
pub(super) fn most_alike<'k>(
    given: &str,
    known: impl IntoIterator<Item = &'k str>,
) -> Option<&'k str> {
    let given = given.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&given, &name.to_lowercase()), name))
        .filter(|(alike, _)| *alike > ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, name)| name)
}

/// All keys, with their sections.
static KEYS: LazyLock<Vec<String>> = LazyLock::new(schema::keys);

/// The keys of this name in other sections, with their sections.
pub(super) fn elsewhere(name: &str) -> Option<String> {
    let is_it = |key: &&String| key.rsplit('.').next() == Some(name);
    let keys: Vec<_> = KEYS.iter().filter(is_it).map(String::as_str).collect();
    (!keys.is_empty()).then(|| keys.join("` or `"))
}

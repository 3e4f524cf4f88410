//! Names that are meant where others were given.

use super::Config;

/// Less alike than this, two names have nothing to do with each other: 1 is the
/// same (Winkler, 1990).
const ALIKE: f64 = 0.8;

/// The name that is most like the one given, if one is like it.
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

/// The key, with its sections, that is called so in another section.
pub(super) fn elsewhere(name: &str) -> Option<String> {
    let config = Config {
        x_plane: Some(super::XPlaneSection::default()),
        built_in: Some(super::BuiltInSection::default()),
        ..Config::default()
    };
    let mut keys = Vec::new();
    gather("", &config.values().ok()?, &mut keys);
    keys.into_iter()
        .find(|key| key.rsplit('.').next() == Some(name))
}

fn gather(prefix: &str, value: &toml::Value, keys: &mut Vec<String>) {
    if !prefix.is_empty() {
        keys.push(prefix.to_owned());
    }
    for (name, value) in value.as_table().into_iter().flatten() {
        let separator = if prefix.is_empty() { "" } else { "." };
        gather(&format!("{prefix}{separator}{name}"), value, keys);
    }
}

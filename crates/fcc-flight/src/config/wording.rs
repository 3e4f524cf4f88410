//! What the TOML reader complains of, in words that say what would be right.
//!
//! It speaks of fields, variants and `f64`; who writes a configuration file
//! knows keys, values and numbers.

use super::ranges::range_of;
use super::similar::{elsewhere, most_alike};

/// A complaint of the reader about `key`, in plainer words.
pub(super) fn plainly(complaint: &str, key: Option<&str>) -> String {
    let range = key.and_then(range_of);
    let range = range.map(|(least, most)| format!("{least} to {most}"));
    let plain = key
        .and_then(renamed)
        .or_else(|| unknown_key(complaint))
        .or_else(|| unknown_value(complaint))
        .or_else(|| wrong_type(complaint, range.as_deref()))
        .or_else(|| missing_key(complaint));
    plain.unwrap_or_else(|| match complaint {
        "duplicate key" => "stands here a second time: keep one".to_owned(),
        "wanted string or table" => "choose a text in quotes".to_owned(),
        other => other.replace('\n', " "),
    })
}

/// Keys by their former names, and what they are called now.
const RENAMED: &[(&str, &str)] = &[
    ("budget.guidance_us", "the key is called guide_us"),
    ("budget.navigation_us", "the key is called estimate_us"),
    (
        "course",
        "a course is a ground track: the section is called [guidance], its kind mode",
    ),
];

/// What a key of a former version is called now.
pub(super) fn renamed(key: &str) -> Option<String> {
    let (_, now) = RENAMED.iter().find(|(former, _)| {
        key.strip_prefix(former)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })?;
    Some(format!("is a former name: {now}"))
}

fn unknown_key(complaint: &str) -> Option<String> {
    let (name, expected) = complaint
        .strip_prefix("unknown field `")?
        .split_once("`, ")?;
    let known = expected.strip_prefix("expected ");
    let meant = most_alike(name, known.map(names).into_iter().flatten())
        .map(str::to_owned)
        .or_else(|| elsewhere(name));
    let meant = meant.map_or_else(String::new, |name| format!(", did you mean `{name}`"));
    Some(match known {
        Some(known) => format!("there is no such key{meant}: choose {known}"),
        None => format!("there is no such key{meant}: take it out"),
    })
}

fn unknown_value(complaint: &str) -> Option<String> {
    let rest = complaint.strip_prefix("unknown variant `")?;
    let (value, expected) = rest.split_once("`, expected ")?;
    let meant = most_alike(value, names(expected))
        .map_or_else(String::new, |name| format!(", did you mean \"{name}\""));
    Some(format!(
        "is \"{value}\"{meant}: choose {}",
        expected.replace('`', "\"")
    ))
}

/// The names that stand in backticks.
fn names(expected: &str) -> impl Iterator<Item = &str> {
    expected.split('`').skip(1).step_by(2)
}

fn wrong_type(complaint: &str, range: Option<&str>) -> Option<String> {
    let rest = complaint
        .strip_prefix("invalid type: ")
        .or_else(|| complaint.strip_prefix("invalid value: "))?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let found = ["string ", "integer ", "floating point ", "boolean "]
        .into_iter()
        .find_map(|kind| found.strip_prefix(kind))
        .unwrap_or(found)
        .replace('`', "");
    let wanted = match expected {
        "f32" | "f64" => "a number",
        "i8" | "i16" | "i32" | "i64" | "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "a sequence" => "a list, each entry below double square brackets such as [[sensor]]",
        section if section.starts_with("struct ") => "a section in square brackets",
        other => other,
    };
    Some(match range {
        Some(range) => format!("is {found}: choose {wanted}, {range}"),
        None => format!("is {found}: choose {wanted}"),
    })
}

fn missing_key(complaint: &str) -> Option<String> {
    let name = complaint
        .strip_prefix("missing field `")?
        .strip_suffix('`')?;
    Some(format!(
        "the key `{name}` is missing: add it as in the examples in the folder config/"
    ))
}

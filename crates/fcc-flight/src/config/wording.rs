//! Rewords the TOML reader's errors to say what is permitted.
//!
//! The reader's messages are about fields, variants and `f64`; users of a
//! configuration file know keys, values and numbers.

use fcc_telemetry::units::number;

use super::ranges::{in_words, range_of};
use super::similar::{elsewhere, most_alike};

/// Rewords the reader's error about `key`.
pub(super) fn reword(message: &str, key: Option<&str>) -> String {
    let range = key.and_then(range_of);
    let range = range.map(in_words);
    let plain = key
        .and_then(renamed)
        .or_else(|| unknown_key(message))
        .or_else(|| unknown_value(message))
        .or_else(|| wrong_type(message, range.as_deref()))
        .or_else(|| missing_key(message, key));
    let of_list = key.filter(|key| key.ends_with(']') && message.starts_with("invalid type: map"));
    let plain = of_list
        .and_then(|key| key.rsplit_once('['))
        .map_or(plain, |(section, _)| {
            Some(format!(
                "is in double square brackets: write [{section}], there is one of it"
            ))
        });
    plain.unwrap_or_else(|| match message {
        "duplicate key" => "is given a second time: keep one".to_owned(),
        "wanted string or table" => "choose a text in quotes".to_owned(),
        other => other.replace('\n', " "),
    })
}

/// Former names of keys, and their present names.
const RENAMED: &[(&str, &str)] = &[
    ("budget.guidance_us", "the key is called guide_us"),
    ("budget.navigation_us", "the key is called estimate_us"),
    (
        "course",
        "a course is a ground track: the section is called [guidance], its kind mode",
    ),
];

/// The present name of a key of a former version.
pub(super) fn renamed(key: &str) -> Option<String> {
    let (_, now) = RENAMED.iter().find(|(former, _)| {
        key.strip_prefix(former)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })?;
    Some(format!("is a former name: {now}"))
}

fn unknown_key(message: &str) -> Option<String> {
    let (name, expected) = message.strip_prefix("unknown field `")?.split_once("`, ")?;
    let known = expected.strip_prefix("expected ");
    let meant = most_alike(name, known.map(names).into_iter().flatten())
        .map(str::to_owned)
        .or_else(|| elsewhere(name));
    if let Some(name) = meant {
        return Some(format!("there is no such key, did you mean `{name}`?"));
    }
    Some(match known {
        Some(known) => format!("there is no such key: choose {known}"),
        None => "there is no such key: remove it".to_owned(),
    })
}

fn unknown_value(message: &str) -> Option<String> {
    let rest = message.strip_prefix("unknown variant `")?;
    let (value, expected) = rest.split_once("`, expected ")?;
    let meant = most_alike(value, names(expected))
        .map_or_else(String::new, |name| format!(", did you mean \"{name}\""));
    Some(format!(
        "is \"{value}\"{meant}: choose {}",
        expected.replace('`', "\"")
    ))
}

/// The names in backticks.
fn names(expected: &str) -> impl Iterator<Item = &str> {
    expected.split('`').skip(1).step_by(2)
}

fn wrong_type(message: &str, range: Option<&str>) -> Option<String> {
    let rest = message
        .strip_prefix("invalid type: ")
        .or_else(|| message.strip_prefix("invalid value: "))?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let is_fraction = found.starts_with("floating point ");
    let found = ["string ", "integer ", "floating point ", "boolean "]
        .into_iter()
        .find_map(|kind| found.strip_prefix(kind))
        .unwrap_or(found)
        .replace('`', "");
    let found = match found
        .trim_end_matches(" as i128")
        .trim_end_matches(" as u128")
    {
        "map" => "a section".to_owned(),
        "sequence" => "a list".to_owned(),
        other => other.parse().map_or_else(|_| other.to_owned(), number),
    };
    // Of 80.0 the point is what is wrong.
    let found = if is_fraction && found.bytes().all(|byte| byte.is_ascii_digit()) {
        format!("{found}.0")
    } else {
        found
    };
    let wanted = match expected {
        "f32" | "f64" => "a number",
        "i8" | "i16" | "i32" | "i64" | "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number",
        "a boolean" => "true or false",
        "a string" | "path string" | "variant identifier" => "a text in quotes",
        "a sequence" => {
            "a list such as [1.0, 2.0]; of sections: each below double square brackets such as \
             [[sensor]]"
        }
        section if section.starts_with("struct ") => "a section in square brackets",
        other => other,
    };
    Some(match range {
        Some(range) if !wanted.contains(range) => {
            format!("is {found}: choose {wanted}, {range}")
        }
        _ => format!("is {found}: choose {wanted}"),
    })
}

fn missing_key(message: &str, section: Option<&str>) -> Option<String> {
    let name = message.strip_prefix("missing field `")?.strip_suffix('`')?;
    if (section, name) == (Some("guidance"), "mode") {
        let what = "says nothing without the key `mode`: add mode = \"timed-pattern\", \"hold\" or \
                    \"plan\", or remove the section";
        return Some(what.to_owned());
    }
    Some(format!(
        "the key `{name}` is missing: add it as in the examples in the folder config/"
    ))
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    fn messages(text: &str) -> Vec<String> {
        let text = format!("[built-in]\n{text}");
        let error = Config::parse(&text, "f").unwrap_err().to_string();
        error.lines().map(str::to_owned).collect()
    }

    #[test]
    fn no_words_of_the_reader_and_no_hundreds_of_zeros() {
        for (text, expected) in [
            (
                "[loop]\nrate_hz = 1e308\n",
                "f:3: loop.rate_hz: is 1e308: choose 20 to 2000",
            ),
            (
                "[loop]\nrate_hz = {}\n",
                "f:3: loop.rate_hz: is a section: choose a number, 20 to 2000",
            ),
            (
                "[realtime]\npriority = 1e300\n",
                "f:3: realtime.priority: is 1e300: choose a whole number, 0 to 99",
            ),
            (
                "[realtime]\ncpu = []\n",
                "f:3: realtime.cpu: is []: choose \"auto\" or the number of a CPU, 0 to 1023",
            ),
            (
                "[budget]\ntick_us = []\n",
                "f:3: budget.tick_us: is a list: choose a whole number, 1 to 1000000",
            ),
            (
                "[realtime]\npriority = 80.0\n",
                "f:3: realtime.priority: is 80.0: choose a whole number, 0 to 99",
            ),
            (
                "[[loop]]\nrate_hz = 40\n",
                "f:2: loop[0]: is in double square brackets: write [loop], there is one of it",
            ),
            (
                "[recording]\nfolder = 5\n",
                "f:3: recording.folder: is 5: choose a text in quotes",
            ),
            (
                "[recording]\nfolder = \"re\\u0000cordings\"\n",
                "f:3: recording.folder: has a NUL character: choose a path without",
            ),
            (
                "seed = 9300000000000000000\n",
                "f:2: built-in.seed: is 9.3e18: choose 0 to 9e18",
            ),
            (
                "seed = 99999999999999999999\n",
                "f:2: built-in.seed: is 1e20: choose a whole number, 0 to 9e18",
            ),
            (
                "seed = 9200000000000000000\n",
                "f:2: built-in.seed: is 9.2e18: choose 0 to 9e18",
            ),
        ] {
            assert_eq!(messages(text), [expected]);
        }
        let guidance = messages("[guidance]\nhold_s = 5\n");
        let words =
            "f:2: guidance: says nothing without the key `mode`: add mode = \"timed-pattern\"";
        assert!(guidance[0].starts_with(words), "{guidance:?}");
        let silent = messages("[failsafe]\nall_silent_s = 0.1\n");
        let words = "f:3: failsafe.all_silent_s: is 0.1: choose at least 0.25, which is \
                     failsafe.sensor_max_age_ms in s; failsafe.sensor_max_age_ms = 250 by default, \
                     not in the file";
        assert_eq!(silent, [words]);
        let timer = messages("[loop]\ntimer = 5\n");
        assert!(
            timer[0].starts_with("f:3: loop.timer: is 5: choose"),
            "{timer:?}"
        );
        assert!(!timer[0].contains("identifier"), "{timer:?}");
    }

    /// The number itself is refused, and no other one because of it.
    #[test]
    fn a_number_out_of_its_range_is_one_problem() {
        for (text, expected) in [
            (
                "altitude_ft = -1e308\n",
                "f:2: built-in.altitude_ft: is -1e308: choose 500 to 20000",
            ),
            (
                "[loop]\nrate_hz = -1e308\n",
                "f:3: loop.rate_hz: is -1e308: choose 20 to 2000",
            ),
            (
                "[loop.early_wake]\nmax_us = -1e308\n",
                "f:3: loop.early_wake.max_us: is -1e308: choose 1 to 10000",
            ),
            (
                "[autopilot.envelope]\nmax_airspeed_kt = -1e308\n",
                "f:3: autopilot.envelope.max_airspeed_kt: is -1e308: choose 10 to 600",
            ),
            (
                "[autopilot.envelope]\nstall_airspeed_kt = 1e308\n",
                "f:3: autopilot.envelope.stall_airspeed_kt: is 1e308: choose 5 to 300",
            ),
        ] {
            assert_eq!(messages(text), [expected]);
        }
        let both = messages("altitude_ft = 500.0\nground_ft = 600.0\n");
        let words = "f:3: built-in.ground_ft: is 600: choose less than altitude_ft, 500: ";
        assert!(both[0].starts_with(words), "{both:?}");
    }

    #[test]
    fn what_is_given_twice_is_named() {
        for (text, expected) in [
            ("seed = 1\nseed = 2\n", "f:3: built-in.seed: is given"),
            ("[loop]\n[built-in]\n", "f:3: built-in: is given"),
            (
                "[loop.early_wake]\n [ loop.early_wake ]\n",
                "f:3: loop.early_wake: is given",
            ),
        ] {
            let found = messages(text);
            assert!(found[0].starts_with(expected), "{found:?}");
        }
    }

    #[test]
    fn no_key_hides_a_later_error() {
        for key in [
            "\"a[0\" = 1",
            "\"a[0]\" = 1",
            "\"a.b\" = 1",
            "a = [{ b = 1 }]",
            "rate_hz = [{ b = 1 }]",
            "[[x]]\na = 1",
        ] {
            let text = format!("[loop]\n{key}\n[failsafe]\nhold_s = -1\n");
            let all = messages(&text);
            assert_eq!(all.len(), 2, "{all:?}");
            assert!(
                all[1].ends_with("failsafe.hold_s: is -1: choose 0 to 600"),
                "{all:?}"
            );
        }
    }
}

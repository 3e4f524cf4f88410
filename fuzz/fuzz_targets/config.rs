//! Configurations: any text is read or refused, with each problem and its line;
//! one that was read is written so that it is read again.
//!
//! Most inputs are changed by lines, keys and values rather than by bytes: few
//! changes of bytes leave a text that is TOML, and fewer one with known keys.
#![no_main]

use std::sync::LazyLock;

use fcc_flight::config::{BuiltInSection, Config, ConfigError, XPlaneSection, keyed};

libfuzzer_sys::fuzz_target!(|text: &str| {
    match Config::parse(text, "fuzz") {
        Ok(config) => {
            let _ = config.remarks(text);
            let _ = config.loop_config();
            let _ = config.autopilot_config();
            // The whole configuration, with some 150 keys: it takes as long as a hundred others.
            if checksum(text) % 32 == 0 {
                let again = toml::to_string(&config).expect("what was read can be written");
                let read = Config::parse(&again, "fuzz").expect("what was written can be read");
                assert_eq!(toml::to_string(&read).expect("as before"), again);
            }
        }
        Err(ConfigError::Invalid { problems, .. }) => {
            assert!(!problems.is_empty());
            let lines = text.lines().count().max(1) + 1;
            assert!(problems.iter().all(|problem| problem.line.is_none_or(|line| line <= lines)));
        }
        Err(_) => {}
    }
});

/// FNV-1a (Fowler, Noll, Vo).
fn checksum(text: &str) -> u32 {
    let start = 0x811C_9DC5;
    text.bytes().fold(start, |sum, byte| (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    let mut random = Random(u64::from(seed));
    let text = str::from_utf8(data.get(..size).unwrap_or_default()).ok();
    let Some(text) = text.filter(|_| random.below(4) > 0) else {
        return libfuzzer_sys::fuzzer_mutate(data, size, most);
    };
    let changed = changed(text, &mut random);
    let end = changed.floor_char_boundary(most);
    data[..end].copy_from_slice(&changed.as_bytes()[..end]);
    end
});

/// Every key with its value, below its section.
static KEYS: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let config = Config {
        x_plane: Some(XPlaneSection::default()),
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    let values = config.values().expect("the defaults can be written");
    let keys = keyed(&values).into_iter();
    keys.map(|(key, value)| (key, value.to_string())).collect()
});

const VALUES: &[&str] = &[
    "0", "-0.0", "1", "-1", "0.5", "7", "1e3", "1e308", "-1e308", "nan", "inf", "-inf", "255", "256",
    "65535", "65536", "4294967296", "9223372036854775807", "0x10", "0b1", "1979-05-27", "true",
    "false", "\"\"", "\"auto\"", "\"hold\"", "\"beacon\"", "\"127.0.0.1:49000\"", "\"a\\u0000\"",
    "[]", "[1, 2]", "[\"a\"]", "{}", "{ kind = \"simulator\" }", "'''", "\"",
];
const LINES: &[&str] = &[
    "[[sensor]]", "[[actuator]]", "kind = \"simulator\"", "kind = \"x-plane\"", "[[x-plane]]", "[",
    "a.b.c = 1", "\"\" = 1", "# \u{202e}", "\r",
];

/// A text in which one to four lines are others.
fn changed(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..=random.below(4) {
        let at = random.below(lines.len() + 1);
        let (key, value) = random.of(&KEYS);
        match random.below(8) {
            0 => lines.insert(at, random.of(LINES).to_string()),
            1 => {
                if let Some(section) = key.rsplit_once('.').map(|(section, _)| section) {
                    lines.insert(at, format!("[{section}]"));
                }
            }
            2 if at < lines.len() => drop(lines.remove(at)),
            3 if at < lines.len() => {
                let to = random.below(lines.len());
                lines.swap(at, to);
            }
            // With its section, or in whichever one it is put.
            4 => lines.insert(0, format!("{key} = {value}")),
            5 => {
                let name = key.rsplit('.').next().unwrap_or_default();
                lines.insert(at, format!("{name} = {}", random.of(VALUES)));
            }
            _ => {
                if let Some((before, _)) = lines.get(at).and_then(|line| line.split_once('=')) {
                    lines[at] = format!("{before}= {}", random.value(value));
                }
            }
        }
    }
    lines.join("\n") + "\n"
}

/// `SplitMix64` (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }

    /// A value of the list, another key's, or a number near a limit.
    fn value(&mut self, other: &str) -> String {
        match self.below(4) {
            0 => other.to_owned(),
            1 => format!("{:e}", f64::from_bits(self.next())),
            2 => (self.next() as i16 / 64).to_string(),
            _ => self.of(VALUES).to_string(),
        }
    }
}

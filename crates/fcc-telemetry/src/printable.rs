//! Texts from outside, such as names of files, keys of a configuration and texts
//! in a recording, as a terminal may show them.
//!
//! A terminal obeys control characters: an escape sequence can change its title,
//! its colours and what it shows, and on some make it type. Characters that
//! change the direction of writing show a text in another order than it has
//! (Boucher and Anderson, "Trojan Source", 2021). Both are written as escapes.

use std::fmt::Write as _;

/// Whether a terminal obeys the character, or it changes the order of others;
/// the end of a line and a tabulator are none of them.
fn is_obeyed(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        // Unicode's Bidi_Control characters, and its ends of line and paragraph.
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            true
        }
        // C0, DEL and C1 (ISO 6429).
        _ => c.is_control(),
    }
}

/// The text with such characters as `\u{1b}`.
///
/// ```
/// use fcc_telemetry::printable;
///
/// assert_eq!(printable("a\x1b[31m\nb"), "a\\u{1b}[31m\nb");
/// ```
pub fn printable(text: &str) -> String {
    escaped(text, |to, c| to.extend(c.escape_unicode()))
}

/// JSON with such characters as `\u001b`: in valid JSON they are in strings only.
///
/// ```
/// use fcc_telemetry::printable_json;
///
/// assert_eq!(printable_json("[\"\u{9b}31m\"]"), "[\"\\u009b31m\"]");
/// ```
pub fn printable_json(json: &str) -> String {
    escaped(json, |to, c| {
        // All of them have at most 16 bits. Writing to a string cannot fail.
        let _ = write!(to, "\\u{:04x}", u32::from(c));
    })
}

fn escaped(text: &str, escape: impl Fn(&mut String, char)) -> String {
    let mut to = String::with_capacity(text.len());
    for c in text.chars() {
        if is_obeyed(c) {
            escape(&mut to, c);
        } else {
            to.push(c);
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ranges of ISO 6429 and of Unicode's property `Bidi_Control`.
    #[test]
    fn only_ends_of_line_and_tabulators_are_left_of_what_a_terminal_obeys() {
        let c0 = (0..0x20).filter(|c| ![0x09, 0x0a].contains(c));
        let bidi = [0x61c, 0x200e, 0x200f];
        let obeyed = c0
            .chain(0x7f..0xa0)
            .chain(bidi)
            .chain(0x202a..=0x202e)
            .chain(0x2066..=0x2069);
        for c in obeyed.filter_map(char::from_u32) {
            let text = format!("a{c}b");
            let number = u32::from(c);
            assert_eq!(printable(&text), format!("a\\u{{{number:x}}}b"));
            assert_eq!(printable_json(&text), format!("a\\u{number:04x}b"));
        }
        for plain in ["°C → ½ m/s²\n\tΔ 漢字 🛩", ""] {
            assert_eq!(printable(plain), plain);
            assert_eq!(printable_json(plain), plain);
        }
    }
}

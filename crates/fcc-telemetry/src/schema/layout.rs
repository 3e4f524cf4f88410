//! The memory layout of a struct as a table, for programs in other languages.

use std::fmt::Write as _;

use fcc_core::framework::schema::{Enumeration, Kind, Schema};

use super::{Column, columns};

/// The layout of a struct as a Markdown table.
pub fn layout_table<T: Schema>() -> String {
    let mut text =
        String::from("| offset | field | type | unit | what |\n|---:|---|---|---|---|\n");
    for column in columns::<T>() {
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} |",
            column.offset,
            column.path,
            type_of(column.kind),
            column.unit,
            what(&column)
        );
    }
    let _ = writeln!(text, "| {} | | | | end |", size_of::<T>());
    text
}

fn what(column: &Column) -> String {
    let mut text = column.meaning.trim_end_matches('.').to_owned();
    if let Some((low, high)) = column.range {
        let _ = write!(text, "; {} to {}", end_of(low), end_of(high));
    }
    if let Kind::Code(of) = column.kind {
        let _ = write!(text, ": {}", codes(of));
    }
    text
}

/// The codes of an enum and their names.
pub(crate) fn codes(of: &Enumeration) -> String {
    let known: Vec<_> = of
        .variants
        .iter()
        .map(|variant| format!("{} {}", variant.number, spaced(variant.name)))
        .collect();
    known.join(", ")
}

/// The name of a type or variant in lower case with spaces: `InvalidOutput`
/// gives `invalid output`.
pub fn spaced(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push(' ');
        }
        text.extend(letter.to_lowercase());
    }
    text
}

/// A limit of a range, as a multiple of π where it is one.
pub(crate) fn end_of(value: f64) -> String {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    let known = [(TAU, "2π"), (PI, "π"), (FRAC_PI_2, "π/2")];
    let sign = if value < 0.0 { "-" } else { "" };
    known
        .iter()
        .find(|(size, _)| *size == value.abs())
        .map_or_else(|| value.to_string(), |(_, name)| format!("{sign}{name}"))
}

/// The type of a value in memory: `f64`.
pub(super) fn type_of(kind: Kind) -> String {
    match kind {
        Kind::Bool | Kind::Code(_) => "u8".to_owned(),
        Kind::Flags => "u64".to_owned(),
        Kind::Count(bytes) => format!("u{}", 8 * bytes),
        Kind::Signed(bytes) => format!("i{}", 8 * bytes),
        Kind::Instant => "i64".to_owned(),
        Kind::Number => "f64".to_owned(),
    }
}

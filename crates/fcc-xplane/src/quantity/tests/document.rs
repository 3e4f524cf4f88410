//! The table of datarefs in `datarefs.md` is [`TABLE`](super::TABLE).
//!
//! `FCC_UPDATE=1 cargo test -p fcc-xplane document` writes it.

use core::fmt::Write;
use std::path::Path;
use std::{env, fs};

use super::table::{Entry, IfMissing, Place, StatedBy, TABLE};
use crate::units::Unit;

const BEGIN: &str =
    "<!-- datarefs: written by FCC_UPDATE=1 cargo test -p fcc-xplane document -->\n";
const END: &str = "<!-- end of datarefs -->\n";

fn row(entry: &Entry) -> Option<String> {
    let name = match entry.place {
        Place::Position(name) => format!("P`{name}`"),
        Place::Dataref(path) => format!("`{path}`"),
        Place::EngageSwitch => "`x-plane.engage_switch`".to_owned(),
        Place::Row | Place::ServoBoard(_) => return None,
    };
    let unit = match entry.unit {
        Unit::Seconds => "s",
        Unit::Flag => "0 or 1",
        Unit::Number => "number",
        Unit::Ratio => "ratio",
        Unit::MetresPerSecond => "m/s",
        Unit::MetresPerSecondSquared => "m/s²",
        Unit::RadiansPerSecond => "rad/s",
        Unit::Degrees => "°",
        Unit::Knots => "kt",
        Unit::Feet => "ft",
        Unit::InchesOfMercury => "inHg",
        Unit::Gravities => "g",
        Unit::Pascals => "Pa",
        Unit::Metres => "m",
        Unit::RevolutionsPerMinute => "1/min",
        Unit::Volts => "V",
    };
    let access = if entry.is_written {
        "written, read back"
    } else {
        "read"
    };
    let since = match entry.place {
        Place::EngageSwitch => "as configured",
        _ => entry.since,
    };
    let source = match entry.stated_by {
        StatedBy::List => "D",
        StatedBy::ListAndArduPilot => "D, A",
        StatedBy::ListAndSimHub => "D, S",
    };
    let missing = match entry.if_missing {
        IfMissing::Reported(consequence) => format!("reported; {consequence}"),
        IfMissing::Instead(substitute) => substitute.to_owned(),
    };
    Some(format!(
        "| {name} | {unit} | {} | {access} | {since} | {source} | {missing} |\n",
        entry.meaning
    ))
}

fn markdown() -> String {
    let mut text = String::from(
        "\n| dataref | unit | what it is, positive for | access | since | source | if it never comes |\n",
    );
    text.push_str("|---|---|---|---|---|---|---|\n");
    for row in TABLE.iter().filter_map(row) {
        write!(text, "{row}").unwrap();
    }
    text.push('\n');
    text
}

#[test]
fn the_document_has_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("datarefs.md");
    let document = fs::read_to_string(&path).unwrap();
    let begin = document.find(BEGIN).expect("the table begins") + BEGIN.len();
    let end = document.find(END).expect("the table ends");
    let table = markdown();
    if env::var_os("FCC_UPDATE").is_some() {
        let updated = [&document[..begin], &table, &document[end..]].concat();
        fs::write(path, updated).unwrap();
    } else {
        assert_eq!(document[begin..end], table, "run it with FCC_UPDATE=1");
    }
}

/// A row that tells a reader nothing would be a gap in the document.
#[test]
fn every_dataref_is_described() {
    for entry in TABLE.iter().filter(|entry| entry.place != Place::Row) {
        let (IfMissing::Reported(text) | IfMissing::Instead(text)) = entry.if_missing;
        assert!(
            !entry.meaning.is_empty() && !text.is_empty(),
            "{:?}",
            entry.quantity
        );
    }
}

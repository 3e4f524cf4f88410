//! The layouts in `proto/layout.md` are those of the structs: programs in
//! other languages rely on that page.

use std::fmt::Write as _;
use std::mem::offset_of;

use fcc_live::{Event, Info, LAYOUT, Status};

const DOCUMENT: &str = include_str!("../../../../proto/layout.md");

/// The layout that this version of the page describes: increase `LAYOUT`, and
/// the version in the services' names, with every change of a struct or a
/// meaning.
const DESCRIBED: u32 = 5;

/// A table of fields: offset in `$of`, type.
macro_rules! table {
    ($of:ty; $($($field:ident).+: $kind:literal;)+) => {{
        let mut text = String::from("| offset | field | type\n|---:|---|---\n");
        $(
            let offset = offset_of!($of, $($field).+);
            let name = stringify!($($field).+).replace(' ', "");
            let _ = writeln!(text, "| {offset} | `{name}` | {}", $kind);
        )+
        let _ = writeln!(text, "| {} | |", size_of::<$of>());
        text
    }};
}

/// The page's lines, of a table's rows the first three cells.
fn without_meanings() -> String {
    let lines = DOCUMENT.lines().map(|line| {
        let cells = line.splitn(5, '|').take(4).collect::<Vec<_>>().join("|");
        cells.trim_end().to_owned() + "\n"
    });
    lines.collect()
}

fn assert_documented(table: &str) {
    assert!(
        without_meanings().contains(table),
        "proto/layout.md lacks this table:\n{table}"
    );
}

#[test]
fn the_version_is_the_documented_one() {
    assert_eq!(LAYOUT, DESCRIBED);
    for topic in ["columns", "record", "event", "status"] {
        assert!(DOCUMENT.contains(&format!("{topic}/v{LAYOUT}`")), "{topic}");
    }
}

#[test]
fn event() {
    assert_documented(&table!(Event;
        tick: "u64";
        time_ns: "i64";
        code: "u32";
        index: "u32";
        values: "u64[3]";
        text: "char[976]";
    ));
}

#[test]
fn status() {
    assert_documented(&table!(Status;
        time_ns: "i64";
        ticks: "u64";
        missed: "u64";
        lateness_p50_ns: "u64";
        lateness_p99_ns: "u64";
        lateness_p99_9_ns: "u64";
        lateness_max_ns: "u64";
        lateness_counts: "u64[14]";
        not_published: "u64";
        cpu_ns: "u64";
        watchers: "u32";
        recorder_state: "u32";
        recorded: "u64";
        not_recorded: "u64";
        recording_bytes: "u64";
        recording: "char[128]";
    ));
}

#[test]
fn info() {
    assert_documented(&table!(Info;
        layout: "u32";
        record_bytes: "u32";
        event_bytes: "u32";
        status_bytes: "u32";
        process_id: "u32";
        priority: "i32";
        memory_locked: "u32";
        requests_denied: "u32";
        started_unix_ns: "i64";
        started_ns: "i64";
        rate_hz: "f64";
        software: "char[32]";
        commit: "char[48]";
        timer: "char[16]";
        policy: "char[16]";
        plant: "char[64]";
        refusals: "char[280]";
    ));
}

//! The layouts in `docs/telemetry.md` are those of the structs: programs in
//! other languages rely on that page.

use std::fmt::Write as _;
use std::mem::offset_of;

use fcc_live::{EVENT_HISTORY, Event, Info, LAYOUT, MAX_WATCHERS, RECORD_BUFFER, Status};

const DOCUMENT: &str = include_str!("../../../../docs/telemetry.md");

/// The layout that this version of the page describes: increase `LAYOUT`, and
/// the version in the services' names, with every change of a struct or a
/// meaning.
const DESCRIBED: u32 = 5;

/// A table of fields: offset in `$of`, type, meaning.
macro_rules! table {
    ($of:ty; $($($field:ident).+: $kind:literal, $meaning:literal;)+) => {{
        let mut text = String::from("| offset | field | type | what |\n|---:|---|---|---|\n");
        $(
            let offset = offset_of!($of, $($field).+);
            let name = stringify!($($field).+).replace(' ', "");
            let _ = writeln!(text, "| {offset} | `{name}` | {} | {} |", $kind, $meaning);
        )+
        let _ = writeln!(text, "| {} | | | end |", size_of::<$of>());
        text
    }};
}

fn assert_documented(table: &str) {
    assert!(
        DOCUMENT.contains(table),
        "docs/telemetry.md lacks this table:\n{table}"
    );
}

#[test]
fn the_version_is_the_documented_one() {
    assert_eq!(LAYOUT, DESCRIBED);
    for topic in ["columns", "record", "event", "status"] {
        assert!(DOCUMENT.contains(&format!("{topic}/v{LAYOUT}`")), "{topic}");
    }
    assert!(DOCUMENT.contains(&format!("the one you support (here: {LAYOUT})")));
    assert!(DOCUMENT.contains(&format!("for up to {MAX_WATCHERS} programs")));
    let buffers = format!("1,{:03} records are one second", RECORD_BUFFER - 1_000);
    assert!(DOCUMENT.contains(&buffers), "{buffers}");
    assert!(DOCUMENT.contains(&format!("the last {EVENT_HISTORY} events")));
}

#[test]
fn event() {
    assert_documented(&table!(Event;
        tick: "u64", "the tick it happened in";
        time_ns: "i64", "that tick's wake-up";
        code: "u32", "kind of event, see below";
        index: "u32", "sensor or actuator, from 0";
        values: "u64[3]", "depends on the code";
        text: "char[976]", "as text";
    ));
}

#[test]
fn status() {
    assert_documented(&table!(Status;
        time_ns: "i64", "wake-up of the last tick";
        ticks: "u64", "since the loop's start";
        missed: "u64", "missed periods";
        lateness_p50_ns: "u64", "of all ticks since the start";
        lateness_p99_ns: "u64", "";
        lateness_p99_9_ns: "u64", "";
        lateness_max_ns: "u64", "";
        lateness_counts: "u64[14]", "ticks by lateness: up to 0.1, 0.316, 1, 3.16, ... µs, half a decade each, up to 100 ms; the last bin counts those above";
        not_published: "u64", "records that were not published";
        cpu_ns: "u64", "CPU time of the publishing thread";
        watchers: "u32", "programs that watch the records";
        recorder_state: "u32", "0 off, 1 recording, 2 cannot write";
        recorded: "u64", "records in the file";
        not_recorded: "u64", "records that are not in the file";
        recording_bytes: "u64", "size of the file";
        recording: "char[128]", "the file's name, or why there is none";
    ));
}

#[test]
fn info() {
    assert_documented(&table!(Info;
        layout: "u32", "version of all other layouts";
        record_bytes: "u32", "size of a record";
        event_bytes: "u32", "size of an event";
        status_bytes: "u32", "size of a status";
        process_id: "u32", "the daemon's process";
        priority: "i32", "of the loop's thread under SCHED_FIFO, else 0";
        memory_locked: "u32", "1 if the daemon's memory is locked";
        requests_denied: "u32", "real-time requests that the kernel denied";
        started_unix_ns: "i64", "when publishing began, since 1970, UTC";
        started_ns: "i64", "the same instant on the loop's clock";
        rate_hz: "f64", "nominal";
        software: "char[32]", "version of the daemon";
        commit: "char[48]", "the commit it was built from; empty if unknown";
        timer: "char[16]", "timerfd, posix or nanosleep";
        policy: "char[16]", "scheduling of the loop's thread";
        plant: "char[64]", "name of the plant";
        refusals: "char[280]", "the denied requests, as text";
    ));
}

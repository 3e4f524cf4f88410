//! Files generated from the declarations and committed: the `.proto` of a
//! recording and the table of a record in shared memory.
//!
//! `FCC_UPDATE=1 cargo test -p fcc-record --all-features --test it declared` writes both again.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::{env, fs};

use fcc_fixed_wing::Autopilot;
use fcc_record::{PACKAGE, messages};
use fcc_telemetry::FlightRecord;
use fcc_telemetry::schema::layout_table;
use fcc_telemetry::schema::protobuf::{File, text};
use prost_types::{DescriptorProto, FileDescriptorProto};

const PROTO: &str = "proto/fcc/v2/flight.proto";
const DOCUMENT: &str = "proto/layout.md";
const RECORD: &str = "## `fcc.v2.Record`\n";

fn path(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(file)
}

/// The committed `.proto`, compiled by another program than the one that wrote
/// it.
fn committed() -> FileDescriptorProto {
    let root = path("proto");
    let compiled = protox::compile(["fcc/v2/flight.proto"], [root]).unwrap();
    compiled.file.into_iter().next_back().unwrap()
}

/// A field keeps its number: no field of the committed messages may get
/// another, and a number that is no longer used is reserved.
fn with_reserved(committed: &FileDescriptorProto) -> File {
    let mut file = messages::<Autopilot>();
    for old in &committed.message_type {
        let name = old.name();
        let Some(new) = file.messages.iter_mut().find(|new| new.name == name) else {
            continue;
        };
        let numbers: BTreeMap<_, _> = new
            .fields
            .iter()
            .map(|field| (field.number as i32, field.name.clone()))
            .collect();
        for (number, gone) in numbers_of(old) {
            match (numbers.get(&number), gone) {
                (Some(now), Some(was)) => {
                    assert_eq!(
                        *now, was,
                        "{name}: {number} was {was}: give {now} a new number"
                    );
                }
                (Some(now), None) => {
                    panic!("{name}: {number} was used before: give {now} a new one")
                }
                (None, was) => {
                    let moved = was.and_then(|was| numbers.iter().find(|(_, now)| **now == was));
                    assert_eq!(moved, None, "{name}: was {number}, and keeps it");
                    new.reserved.push(number as u32);
                }
            }
        }
    }
    file
}

/// The numbers of a message: with the field's name, or none if it was removed.
fn numbers_of(of: &DescriptorProto) -> BTreeMap<i32, Option<String>> {
    let gone = of
        .reserved_range
        .iter()
        .flat_map(|range| range.start()..range.end());
    let fields = of
        .field
        .iter()
        .map(|field| (field.number(), Some(field.name().to_owned())));
    gone.map(|number| (number, None)).chain(fields).collect()
}

fn update() -> bool {
    env::var_os("FCC_UPDATE").is_some()
}

#[test]
fn no_number_was_changed_or_used_again() {
    let _ = with_reserved(&committed());
}

#[test]
fn the_proto_matches_the_declarations() {
    let declared = if path(PROTO).exists() {
        text(&with_reserved(&committed()), PACKAGE)
    } else {
        text(&messages::<Autopilot>(), PACKAGE)
    };
    if update() {
        fs::create_dir_all(path(PROTO).parent().unwrap()).unwrap();
        fs::write(path(PROTO), &declared).unwrap();
    }
    let found = fs::read_to_string(path(PROTO)).unwrap();
    assert!(
        found == declared,
        "{PROTO} does not match the declarations: see the head of this test"
    );
}

#[test]
fn the_table_of_a_record_matches_the_declarations() {
    let document = fs::read_to_string(path(DOCUMENT)).unwrap();
    let (before, rest) = document.split_once(RECORD).unwrap();
    let (_, after) = rest.split_once("end |\n").unwrap();
    let declared = format!(
        "{before}{RECORD}\n{}{after}",
        layout_table::<FlightRecord>()
    );
    if update() {
        fs::write(path(DOCUMENT), &declared).unwrap();
    }
    let found = fs::read_to_string(path(DOCUMENT)).unwrap();
    assert!(
        found == declared,
        "{DOCUMENT} does not match the declarations: see the head of this test"
    );
}

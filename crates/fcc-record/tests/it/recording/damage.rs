//! Damage inside a recording: in each of its structures, at random places.

use std::fs;
use std::ops::Range;
use std::path::Path;
use std::sync::LazyLock;

use fcc_core::framework::{EventKind, Message};
use fcc_record::{Compression, Damage, Recording, Wholeness, entry, glance, recover};
use fcc_telemetry::FlightMessage;
use mcap::records::op;
use proptest::prelude::*;

use crate::recording::cut::{TICKS, read, whole};

/// The bytes of a finished recording, its messages, and the places of its
/// records.
pub(crate) struct Original {
    pub(crate) bytes: Vec<u8>,
    pub(crate) messages: Vec<FlightMessage>,
    records: Vec<(u8, Range<usize>)>,
}

pub(crate) static ORIGINALS: LazyLock<[Original; 3]> = LazyLock::new(|| {
    [Compression::None, Compression::Zstd, Compression::Lz4].map(|compression| {
        let folder = tempfile::tempdir().unwrap();
        let path = whole(folder.path(), compression);
        let bytes = fs::read(&path).unwrap();
        Original {
            messages: read(&path).0,
            records: records(&bytes),
            bytes,
        }
    })
});

/// Opcode and place of each record of a file (MCAP specification: opcode, eight
/// bytes of length, content).
fn records(bytes: &[u8]) -> Vec<(u8, Range<usize>)> {
    let magic = mcap::MAGIC.len();
    let mut at = magic;
    let mut records = Vec::new();
    while at < bytes.len() - magic {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        let end = at + 9 + length;
        records.push((bytes[at], at..end));
        at = end;
    }
    records
}

impl Original {
    /// Where the records of a kind are.
    pub(crate) fn all(&self, opcode: u8) -> Vec<Range<usize>> {
        let of_kind = |(kind, place): &(u8, Range<usize>)| (*kind == opcode).then(|| place.clone());
        self.records.iter().filter_map(of_kind).collect()
    }
}

/// What is read from a damaged file: messages, damage, and whether it is cut
/// off.
pub(crate) fn read_damaged(path: &Path) -> (Vec<FlightMessage>, Vec<Damage>, Option<String>) {
    let mut messages = Recording::open(path).unwrap().messages().unwrap();
    let all = messages.by_ref().collect();
    let cut = messages.cut().map(str::to_owned);
    (all, messages.damages().to_vec(), cut)
}

pub(crate) fn ticks(messages: &[FlightMessage]) -> Vec<u64> {
    let tick = |message: &FlightMessage| match message {
        Message::Tick(record) => Some(record.tick.number),
        Message::Event(_) => None,
    };
    messages.iter().filter_map(tick).collect()
}

/// The ticks reported missing.
pub(crate) fn reported_missing(damages: &[Damage]) -> Vec<u64> {
    damages
        .iter()
        .filter_map(|damage| Some(damage.first_tick?..=damage.last_tick?))
        .flatten()
        .collect()
}

/// Number, first, last and sum: shorter to print than all.
pub(crate) fn span(ticks: &[u64]) -> Option<(usize, u64, u64, u64)> {
    let (first, last) = (ticks.first()?, ticks.last()?);
    Some((ticks.len(), *first, *last, ticks.iter().sum()))
}

/// Changes bytes in a place; returns the changed file.
fn changed(bytes: &[u8], place: &Range<usize>, change: Change) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    match change {
        Change::Bit(at, bit) => bytes[place.start + at.index(place.len())] ^= 1 << (bit % 8),
        Change::Zeros(at, length) => {
            let start = place.start + at.index(place.len());
            let end = (start + length).min(place.end);
            // Zeroing zeros is not damage.
            bytes[start] = !bytes[start];
            bytes[start + 1..end.max(start + 1)].fill(0);
        }
    }
    bytes
}

#[derive(Clone, Copy, Debug)]
enum Change {
    Bit(prop::sample::Index, u8),
    Zeros(prop::sample::Index, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let place = any::<prop::sample::Index>;
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(at, bit)| Change::Bit(at, bit)),
        (place(), 1_usize..5_000).prop_map(|(at, length)| Change::Zeros(at, length)),
    ]
}

/// Which part of a file is damaged.
#[derive(Clone, Copy, Debug)]
enum DamagedPart {
    ChunkHeader,
    ChunkData,
    MessageIndex,
    Metadata,
    DataEnd,
    Index,
    Footer,
}

const PARTS: [DamagedPart; 7] = [
    DamagedPart::ChunkHeader,
    DamagedPart::ChunkData,
    DamagedPart::MessageIndex,
    DamagedPart::Metadata,
    DamagedPart::DataEnd,
    DamagedPart::Index,
    DamagedPart::Footer,
];

/// Opcode and length of a record; times, lengths, checksum and compression of
/// a chunk (its specification's fields, with a string of at most 4 bytes).
const CHUNK_HEADER_BYTES: usize = 9 + 8 + 8 + 8 + 4 + 4 + 4 + 8;

fn place(original: &Original, part: DamagedPart, which: prop::sample::Index) -> Range<usize> {
    let one_of = |opcode| {
        let all = original.all(opcode);
        all[which.index(all.len())].clone()
    };
    match part {
        DamagedPart::ChunkHeader => {
            let chunk = one_of(op::CHUNK);
            chunk.start..chunk.start + CHUNK_HEADER_BYTES
        }
        DamagedPart::ChunkData => {
            let chunk = one_of(op::CHUNK);
            chunk.start + CHUNK_HEADER_BYTES..chunk.end
        }
        DamagedPart::MessageIndex => one_of(op::MESSAGE_INDEX),
        DamagedPart::Metadata => one_of(op::METADATA),
        DamagedPart::DataEnd => one_of(op::DATA_END),
        DamagedPart::Index => {
            let from = original.all(op::DATA_END)[0].end;
            from..original.all(op::FOOTER)[0].start
        }
        DamagedPart::Footer => original.all(op::FOOTER)[0].start..original.bytes.len(),
    }
}

/// The ticks in the chunks that overlap a place; read by another program,
/// `mcap`'s own reader.
pub(crate) fn ticks_in(original: &Original, place: &Range<usize>) -> Vec<u64> {
    let summary = mcap::Summary::read(&original.bytes).unwrap().unwrap();
    summary
        .chunk_indexes
        .iter()
        .filter(|chunk| {
            let start = chunk.chunk_start_offset as usize;
            start < place.end && place.start < start + chunk.chunk_length as usize
        })
        .flat_map(|chunk| summary.stream_chunk(&original.bytes, chunk).unwrap())
        .filter_map(|message| {
            let message = message.unwrap();
            // A record's first field is its tick, a message shorter than 128
            // bytes, whose first is its number, a varint.
            (message.channel.topic == "/fcc/record").then(|| varint(&message.data[2..]))
        })
        .collect()
}

/// The value of a message's first field, its number being 1.
fn varint(bytes: &[u8]) -> u64 {
    assert_eq!(bytes[0], 8);
    bytes[1..]
        .iter()
        .scan(true, |more, byte| {
            std::mem::replace(more, byte & 0x80 != 0).then_some(u64::from(byte & 0x7f))
        })
        .enumerate()
        .fold(0, |value, (n, seven)| value | seven << (7 * n))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Whatever is damaged: the rest is read, the missing ticks are reported,
    /// and recovery saves everything that can be read.
    #[test]
    fn damage_loses_only_its_chunk_and_is_reported(
        compression in 0_usize..3,
        part in prop::sample::select(&PARTS[..]),
        which in any::<prop::sample::Index>(),
        change in change(),
    ) {
        let original = &ORIGINALS[compression];
        let place = place(original, part, which);
        let bytes = changed(&original.bytes, &place, change);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.mcap");
        fs::write(&path, &bytes).unwrap();

        let (messages, damages, cut) = read_damaged(&path);
        prop_assert!(!damages.is_empty() || cut.is_some());
        let there = ticks(&messages);
        let missing: Vec<u64> = (1..=TICKS)
            .filter(|tick| there.binary_search(tick).is_err())
            .collect();
        // The times in a chunk's header are not used.
        if !missing.is_empty() {
            prop_assert_eq!(span(&missing), span(&ticks_in(original, &place)));
        }
        prop_assert_eq!(span(&reported_missing(&damages)), span(&missing));
        let is_there = |message: &&FlightMessage| match message {
            Message::Tick(record) => missing.binary_search(&record.tick.number).is_err(),
            Message::Event(_) => missing.first() != Some(&1),
        };
        let expected: Vec<_> = original.messages.iter().filter(is_there).copied().collect();
        let same = messages == expected;
        prop_assert!(same, "{} messages of {}", messages.len(), expected.len());
        if !matches!(part, DamagedPart::ChunkHeader | DamagedPart::ChunkData) {
            prop_assert_eq!(span(&missing), None);
        }
        let seen = entry(&path).unwrap();
        prop_assert_ne!(seen.file, Wholeness::Whole);
        prop_assert_eq!(seen.ticks, TICKS - missing.len() as u64);

        let recovered = recover(&path, |_| {}).unwrap();
        prop_assert!(!recovered.was_whole);
        prop_assert_eq!(&recovered.damages, &damages);
        if let Some(kept) = &recovered.kept {
            let kept_as_it_was = fs::read(kept).unwrap() == bytes;
            prop_assert!(kept_as_it_was);
        }
        prop_assert_eq!(recovered.kept.is_some(), !damages.is_empty());
        let made = entry(&path).unwrap();
        prop_assert_eq!(made.file, Wholeness::Whole);
        prop_assert_eq!(made.ticks, seen.ticks);
        let (again, none, cut) = read_damaged(&path);
        prop_assert_eq!((none, cut), (Vec::new(), None));
        prop_assert_eq!(span(&ticks(&again)), span(&there));
        let whole = recover(&path, |_| {}).unwrap().was_whole;
        prop_assert!(whole);
    }
}

/// Half of the chunks, each damaged in another way, and the index.
#[test]
fn each_of_several_damages_is_reported_and_the_rest_is_read() {
    let original = &ORIGINALS[0];
    let chunks = original.all(op::CHUNK);
    assert!(chunks.len() > 5, "{}", chunks.len());
    let mut bytes = original.bytes.clone();
    let mut missing = Vec::new();
    for chunk in [&chunks[2], &chunks[4]] {
        // Its length, then its data.
        bytes[chunk.start + 3] ^= 4;
        bytes[chunk.end - 9] ^= 1;
        missing.extend(ticks_in(original, chunk));
    }
    let index = original.all(op::CHUNK_INDEX)[0].clone();
    bytes[index.start + 12] ^= 1;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    fs::write(&path, &bytes).unwrap();

    let (messages, damages, cut) = read_damaged(&path);
    assert_eq!(cut, None);
    assert_eq!(damages.len(), 3, "{damages:?}");
    assert_eq!(span(&reported_missing(&damages)), span(&missing));
    assert_eq!(messages.len() as u64 + missing.len() as u64, TICKS + 1);
    let words = damages[0].to_string();
    let (first, last) = (
        damages[0].first_tick.unwrap(),
        damages[0].last_tick.unwrap(),
    );
    assert!(
        words.contains(&format!("ticks {first} to {last} are missing")),
        "{words}"
    );
    // A tick takes 25 ms plus 1 µs of growing lateness.
    let periods = (last - first + 2) as f64;
    assert!((damages[0].span_s.unwrap() - periods * 0.025_001).abs() < 1e-9);

    // At its beginning and end alone it looks undamaged.
    let glanced = glance(&path).unwrap();
    assert_eq!(glanced.file, Wholeness::Damaged);
}

/// A recovered file reports missing ticks like those the recorder lost.
#[test]
fn a_recovered_file_reports_what_is_missing() {
    let original = &ORIGINALS[1];
    let chunk = original.all(op::CHUNK)[2].clone();
    let mut bytes = original.bytes.clone();
    bytes[chunk.end - 20] ^= 0x10;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    fs::write(&path, &bytes).unwrap();
    assert_eq!(glance(&path).unwrap().file, Wholeness::Whole);
    assert_eq!(entry(&path).unwrap().file, Wholeness::Damaged);

    let missing = ticks_in(original, &chunk);
    let recovered = recover(&path, |_| {}).unwrap();
    assert_eq!(recovered.ticks, TICKS - missing.len() as u64);
    let recording = Recording::open(&path).unwrap();
    let end = recording.end().unwrap();
    assert_eq!(end.ending, "stopped by command");
    assert_eq!(end.not_recorded, missing.len() as u64);
    let lost = read(&path).0.into_iter().find_map(|message| match message {
        Message::Event(event) => match event.kind {
            EventKind::NotRecorded { count, first, last } => Some((count, first, last)),
            _ => None,
        },
        Message::Tick(_) => None,
    });
    let (first, last) = (missing[0], missing[missing.len() - 1]);
    assert_eq!(lost, Some((missing.len() as u64, first, last)));

    // The kept damaged file is not overwritten by another.
    fs::write(&path, &bytes).unwrap();
    let again = recover(&path, |_| {}).unwrap();
    assert_ne!(again.kept, recovered.kept);
    assert_eq!(fs::read(recovered.kept.unwrap()).unwrap(), bytes);
}

//! Damage at the beginning of a recording, and after its last data.

use std::collections::BTreeSet;
use std::fs;

use fcc_record::{Wholeness, entry, recover};
use mcap::records::op;

use crate::recording::cut::{TICKS, read};
use crate::recording::damage::{ORIGINALS, read_damaged, reported_missing, span, ticks, ticks_in};

/// The first chunk declares the channels, and an unfinished file has no copy of
/// that.
#[test]
fn an_unfinished_file_with_a_damaged_first_chunk_is_read_and_recovered() {
    let original = &ORIGINALS[1];
    let chunks = original.all(op::CHUNK);
    let mut bytes = original.bytes[..chunks[4].start].to_vec();
    bytes[chunks[0].end - 20] ^= 0x10;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    fs::write(&path, &bytes).unwrap();
    let all = ticks_in(original, &(0..chunks[4].start)).len();
    let rest = all - ticks_in(original, &chunks[0]).len();
    assert!(rest > 0);
    assert_eq!(ticks(&read_damaged(&path).0).len(), rest);

    assert_eq!(recover(&path, |_| {}).unwrap().ticks, rest as u64);
    assert_eq!(ticks(&read(&path).0).len(), rest);
    // With the schemas that other programs need.
    let bytes = fs::read(&path).unwrap();
    let messages = mcap::MessageStream::new(&bytes).unwrap();
    let channels: BTreeSet<_> = messages
        .map(|message| message.unwrap().channel)
        .map(|channel| {
            (
                channel.topic.clone(),
                channel.schema.clone().unwrap().name.clone(),
            )
        })
        .collect();
    let known = |topic: &str, schema: &str| channels.contains(&(topic.into(), schema.into()));
    assert!(known("/fcc/record", "fcc.v2.Record"), "{channels:?}");
    assert!(known("/fcc/log", "foxglove.Log"), "{channels:?}");
}

#[test]
fn a_file_whose_beginning_is_overwritten_is_read_from_the_next_record() {
    let original = &ORIGINALS[1];
    for length in [8, 512, 4_096, 65_536] {
        let mut bytes = original.bytes.clone();
        bytes[..length].fill(0);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.mcap");
        fs::write(&path, &bytes).unwrap();
        let (messages, damages, cut) = read_damaged(&path);
        assert_eq!((damages[0].from_byte, cut), (0, None), "{length}");
        let missing = ticks_in(original, &(0..length));
        assert_eq!(
            span(&reported_missing(&damages)),
            span(&missing),
            "{length}"
        );
        assert_eq!(
            ticks(&messages).len() + missing.len(),
            TICKS as usize,
            "{length}"
        );
        assert_eq!(
            recover(&path, |_| {}).unwrap().ticks,
            ticks(&messages).len() as u64
        );
        assert_eq!(entry(&path).unwrap().file, Wholeness::Whole);
    }
}

/// What cannot be read here, another program may read.
#[test]
fn a_recording_without_a_readable_tick_is_kept_when_it_is_recovered() {
    let original = &ORIGINALS[1];
    let chunks = original.all(op::CHUNK);
    let first = chunks
        .iter()
        .find(|chunk| !ticks_in(original, chunk).is_empty());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.mcap");
    let cut = &original.bytes[..first.unwrap().end - 100];
    fs::write(&path, cut).unwrap();
    let recovered = recover(&path, |_| {}).unwrap();
    assert_eq!(recovered.ticks, 0);
    assert_eq!(fs::read(recovered.kept.unwrap()).unwrap(), cut);
}

/// As `cat` joins two files.
#[test]
fn bytes_behind_a_finished_file_are_damage_and_no_cut() {
    let original = &ORIGINALS[0];
    for others in [&b"\0"[..], &[7; 100], &original.bytes] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("joined.mcap");
        fs::write(&path, [&original.bytes, others].concat()).unwrap();
        let (messages, damages, cut) = read_damaged(&path);
        assert_eq!((ticks(&messages).len(), cut), (TICKS as usize, None));
        let places: Vec<_> = damages.iter().map(|damage| damage.from_byte).collect();
        assert_eq!(places, [original.bytes.len() as u64], "{damages:?}");
    }
}

/// What is known of the flight is lost, and its records are identified by their
/// content.
#[test]
fn an_unfinished_file_without_header_and_first_chunk_is_read_and_recovered() {
    let original = &ORIGINALS[1];
    let chunks = original.all(op::CHUNK);
    let mut bytes = original.bytes[..chunks[4].start].to_vec();
    bytes[..chunks[0].end].fill(0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    fs::write(&path, &bytes).unwrap();
    let rest = ticks_in(original, &(chunks[0].end..chunks[4].start)).len();
    assert!(rest > 0);
    assert_eq!(ticks(&read_damaged(&path).0).len(), rest);
    assert_eq!(entry(&path).unwrap().started, "unknown");

    assert_eq!(recover(&path, |_| {}).unwrap().ticks, rest as u64);
    assert_eq!(ticks(&read(&path).0).len(), rest);
    assert_eq!(entry(&path).unwrap().file, Wholeness::Whole);
}

/// A loss of power can leave zeros in place of data.
#[test]
fn zeros_after_the_data_are_reported_and_removed() {
    let original = &ORIGINALS[1];
    let chunks = original.all(op::CHUNK);
    let mut bytes = original.bytes[..chunks[2].start + 1_000].to_vec();
    bytes[chunks[2].start..].fill(0);
    bytes.resize(bytes.len() + 100_000, 0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    fs::write(&path, &bytes).unwrap();
    let (messages, damages, cut) = read_damaged(&path);
    assert!(messages == original.messages[..messages.len()]);
    assert_eq!(
        messages.len(),
        1 + ticks_in(original, &(0..chunks[2].start)).len()
    );
    assert_eq!(damages.len(), 1);
    assert_eq!(damages[0].from_byte, chunks[2].start as u64);
    assert_eq!(cut.unwrap(), format!("cut off after {} bytes", bytes.len()));
}

//! Recordings that are cut off, damaged or invalid.

use std::fs;
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use fcc_core::framework::Message;
use fcc_record::{
    Compression, OpenError, Recorder, RecorderSettings, Recording, RecoverError, Wholeness, entry,
    recover,
};
use fcc_telemetry::FlightMessage;
use proptest::prelude::*;

use crate::recording::flight::{about, flight, only_file, record_all, settings};

/// A flight of several chunks.
pub(crate) const TICKS: u64 = 6_000;

pub(crate) fn whole(folder: &Path, compression: Compression) -> PathBuf {
    let settings = RecorderSettings {
        compression,
        ..settings(folder)
    };
    record_all(Recorder::start(about(), settings).unwrap(), &flight(TICKS));
    only_file(folder)
}

/// All messages, and where the file is cut off.
pub(crate) fn read(path: &Path) -> (Vec<FlightMessage>, Option<String>) {
    let mut messages = Recording::open(path).unwrap().messages().unwrap();
    let all = messages.by_ref().collect();
    (all, messages.cut().map(str::to_owned))
}

#[test]
fn a_file_cut_anywhere_is_read_to_its_end_and_recovered() {
    let folder = tempfile::tempdir().unwrap();
    for compression in [Compression::None, Compression::Zstd, Compression::Lz4] {
        let folder = tempfile::tempdir_in(folder.path()).unwrap();
        let path = whole(folder.path(), compression);
        let bytes = fs::read(&path).unwrap();
        let (all, cut) = read(&path);
        assert_eq!((all.len() as u64, cut), (TICKS + 1, None));
        let mut before = 0;
        for twentieth in 4..20 {
            let length = bytes.len() * twentieth / 20;
            fs::write(&path, &bytes[..length]).unwrap();
            let (some, cut) = read(&path);
            assert_eq!(cut.unwrap(), format!("cut off after {length} bytes"));
            assert!(some.len() >= before, "more of a file is more messages");
            assert_eq!(some, all[..some.len()]);
            before = some.len();

            let recovered = recover(&path, |_| {}).unwrap();
            assert!(!recovered.was_whole);
            let recording = Recording::open(&path).unwrap();
            assert!(recording.is_whole());
            assert_eq!(*recording.about(), about());
            assert_eq!(read(&path), (some, None));
            assert_eq!(recording.end().unwrap().ticks, recovered.ticks);
        }
        assert!(
            before as u64 > TICKS / 2,
            "{compression:?}: {before} messages"
        );
        // No other file is left.
        let names = fs::read_dir(folder.path()).unwrap();
        let names = names.map(|entry| entry.unwrap().file_name());
        assert_eq!(names.filter(|name| name != ".order").count(), 1);
    }
}

#[test]
fn a_finished_file_is_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), Compression::default());
    let before = fs::read(&path).unwrap();
    let recovered = recover(&path, |_| {}).unwrap();
    assert!(recovered.was_whole);
    assert_eq!(recovered.ticks, TICKS);
    assert_eq!(fs::read(&path).unwrap(), before);
}

/// Another user can make one that claims 2 TB, in the name of a recording.
#[test]
fn a_hole_of_terabytes_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), Compression::default());
    let bytes = fs::read(&path).unwrap();
    let began = std::time::Instant::now();
    let mut file = fs::File::create(&path).unwrap();
    file.write_all(&bytes[..bytes.len() / 2]).unwrap();
    file.set_len(2 << 40).unwrap();
    let holed = entry(&path).unwrap();
    assert!(holed.ticks < TICKS && holed.file != Wholeness::Whole);
    file.seek(SeekFrom::Start(2 << 40)).unwrap();
    file.write_all(&bytes[bytes.len() - 1_000..]).unwrap();
    let holed = entry(&path).unwrap();
    assert!(holed.ticks < TICKS && holed.file == Wholeness::Damaged);
    assert!(began.elapsed().as_secs() < 60);
}

#[test]
fn through_a_link_nothing_is_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), Compression::default());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let link = folder.path().join("latest.mcap");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    let refused = recover(&link, |_| {}).unwrap_err().to_string();
    assert!(refused.contains(path.to_str().unwrap()), "{refused}");
    assert!(link.is_symlink());
    assert_eq!(fs::read(&path).unwrap(), bytes[..bytes.len() / 2]);
}

#[test]
fn what_is_being_written_is_not_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    for message in &flight(10) {
        recorder.take(message);
    }
    while recorder.status().ticks < 10 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let path = only_file(folder.path());
    assert!(matches!(
        recover(&path, |_| {}),
        Err(RecoverError::BeingWritten(_))
    ));
    let seen = entry(&path).unwrap();
    assert_eq!((seen.file, seen.ticks), (Wholeness::BeingWritten, 10));
    recorder.finish("stopped by command");
    assert_eq!(entry(&path).unwrap().file, Wholeness::Whole);
}

/// Two programs started at once in one folder repair one file.
#[test]
fn a_file_being_recovered_is_not_recovered_twice() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), Compression::default());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let mut tried = false;
    recover(&path, |_| {
        if !tried {
            tried = true;
            assert!(matches!(
                recover(&path, |_| {}),
                Err(RecoverError::BeingWritten(_))
            ));
        }
    })
    .unwrap();
    assert!(tried);
    assert!(recover(&path, |_| {}).unwrap().was_whole);
}

#[test]
fn other_files_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.mcap");
    for bytes in [&b""[..], b"hello", &[0; 100]] {
        fs::write(&path, bytes).unwrap();
        assert!(matches!(
            Recording::open(&path),
            Err(OpenError::NotARecording { .. })
        ));
    }
    // Another program's recording.
    let file = fs::File::create(&path).unwrap();
    mcap::Writer::new(file).unwrap().finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in [bytes.len(), bytes.len() - 10] {
        fs::write(&path, &bytes[..length]).unwrap();
        let error = Recording::open(&path).unwrap_err().to_string();
        assert!(error.ends_with("another program wrote it"), "{error}");
    }
    // It may be one of fccd.
    fs::write(&path, mcap::MAGIC).unwrap();
    assert!(matches!(
        Recording::open(&path),
        Err(OpenError::CutInDescription { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever a file contains, reading it ends, and returns nothing that is
    /// not in it.
    #[test]
    fn a_damaged_file_never_panics(
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
        length in any::<prop::sample::Index>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.mcap");
        let recorder = Recorder::start(about(), settings(folder.path())).unwrap();
        record_all(recorder, &flight(50));
        let mut bytes = fs::read(fcc_record::files(folder.path()).unwrap().remove(0)).unwrap();
        for (place, value) in damage {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        bytes.truncate(length.index(bytes.len()) + 1);
        fs::write(&path, &bytes).unwrap();
        if let Ok(recording) = Recording::open(&path) {
            let ticks = recording
                .messages::<FlightMessage>()
                .unwrap()
                .filter(|message| matches!(message, Message::Tick(_)))
                .count();
            prop_assert!(ticks <= 50);
        }
    }
}

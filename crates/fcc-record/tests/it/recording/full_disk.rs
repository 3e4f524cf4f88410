//! Full and read-only disks: the flight continues, nothing that was committed
//! is lost, and the loss is reported once there is room again.

use std::fs::File;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use fcc_core::framework::Message;
use fcc_record::{Disk, DiskFile, Item, Recorder, RecorderSettings, Recording, recover};

use crate::recording::disks::{Small, gaps, ticks, wait_for, wait_for_ticks};
use crate::recording::flight::{about, flight, only_file, record, settings};

/// A recorder on a disk with room for everything, and its free bytes.
fn recorder(settings: RecorderSettings, in_the_way: Option<&Path>) -> (Recorder, Arc<AtomicU64>) {
    let free = Arc::new(AtomicU64::new(u64::MAX));
    let disk = Small {
        free: Arc::clone(&free),
        in_the_way: in_the_way.map(Path::to_owned),
    };
    let recorder = Recorder::start_on(Box::new(disk), about(), settings).unwrap();
    (recorder, free)
}

/// Records 40 ticks that are safe.
fn begin_well(recorder: &mut Recorder) {
    for message in &flight(40) {
        recorder.take(message);
    }
    wait_for_ticks(recorder, 40);
}

fn take(recorder: &mut Recorder, numbers: RangeInclusive<u64>) {
    for number in numbers {
        recorder.take(&Message::Tick(record(number)));
    }
}

#[test]
fn a_full_disk_ends_the_recording_and_keeps_what_was_committed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut recorder, free) = recorder(settings(folder.path()), None);
    begin_well(&mut recorder);
    // Room for a part of the next chunk.
    free.store(100, Ordering::SeqCst);
    take(&mut recorder, 41..=80);
    let (status, notices) = recorder.finish("stopped by command");

    let stopped = status.stopped.unwrap();
    assert!(
        stopped
            .ends_with("; 40 messages of ticks 41 to 80 are lost, all earlier ones are recorded"),
        "{stopped}"
    );
    assert!(
        notices
            .last()
            .unwrap()
            .text
            .starts_with("recording stopped: "),
        "{notices:?}"
    );
    assert_eq!((status.ticks, status.not_recorded), (40, 40));
    let path = only_file(folder.path());
    assert_eq!(ticks(&path), (1..=40).collect::<Vec<_>>());
    // No partial record is left: with room again, the file can be recovered.
    let recovered = recover(&path, |_| {}).unwrap();
    assert_eq!(recovered.ticks, 40);
    assert!(Recording::open(&path).unwrap().is_whole());
    assert_eq!(ticks(&path), (1..=40).collect::<Vec<_>>());
}

#[test]
fn a_disk_that_is_full_from_the_beginning_asks_for_room_and_not_for_another_folder() {
    let folder = tempfile::tempdir().unwrap();
    let disk = Small {
        free: Arc::new(AtomicU64::new(0)),
        in_the_way: None,
    };
    let recorder = Recorder::start_on(Box::new(disk), about(), settings(folder.path())).unwrap();
    let (status, _) = recorder.finish("stopped by command");
    let stopped = status.stopped.unwrap();
    assert!(stopped.contains("Make room on its disk"), "{stopped}");
    assert!(!stopped.contains("writable folder"), "{stopped}");
}

#[test]
fn with_keep_total_mb_a_full_disk_deletes_the_oldest_recording() {
    let folder = tempfile::tempdir().unwrap();
    let old = folder
        .path()
        .join("2020-01-01T00-00-00.000Z-built-in-01.mcap");
    let kept = folder
        .path()
        .join("2021-01-01T00-00-00.000Z-built-in-01.mcap");
    let unrelated = folder.path().join("2019.mcap");
    for path in [&old, &kept, &unrelated] {
        std::fs::write(path, [0; 1_000]).unwrap();
    }
    let limits = RecorderSettings {
        keep_total_bytes: Some(1_000_000_000),
        ..settings(folder.path())
    };
    let (mut recorder, free) = recorder(limits, Some(&old));
    begin_well(&mut recorder);
    free.store(10, Ordering::SeqCst);
    take(&mut recorder, 41..=50);
    // The file that follows is begun as soon as there is room.
    wait_for(&recorder, |status| status.files.len() == 2);
    take(&mut recorder, 51..=60);
    let (status, notices) = recorder.finish("stopped by command");
    assert_eq!(status.stopped, None, "{notices:?}");
    assert!(!old.exists() && kept.exists() && unrelated.exists());
    assert_eq!(status.files.len(), 2, "{notices:?}");
    assert_eq!(ticks(&status.files[0]), (1..=40).collect::<Vec<_>>());
    assert_recorded_or_reported(&status.files[1], 41, 60);
    // Only those that came before the disk was found to be full.
    assert!(gaps(&status.files[1])[0].2 <= 50, "{status:?}");
}

/// Asserts that a file contains the ticks up to `last`, and reports all before
/// them, from `first` on, as one gap.
fn assert_recorded_or_reported(path: &Path, first: u64, last: u64) {
    assert!(Recording::open(path).unwrap().is_whole());
    let [(count, from, to)] = gaps(path)[..] else {
        panic!("{:?}", gaps(path));
    };
    assert_eq!((count, from), (to - first + 1, first));
    assert_eq!(ticks(path), (to + 1..=last).collect::<Vec<_>>());
}

/// The last messages meet a full disk: room is made, and the gap is reported in
/// another file.
#[test]
fn a_disk_that_is_full_at_the_very_end_leaves_no_file_unfinished() {
    let folder = tempfile::tempdir().unwrap();
    let old = folder
        .path()
        .join("2020-01-01T00-00-00.000Z-built-in-01.mcap");
    std::fs::write(&old, [0; 1_000]).unwrap();
    let limits = RecorderSettings {
        keep_total_bytes: Some(1_000_000_000),
        ..settings(folder.path())
    };
    let (mut recorder, free) = recorder(limits, Some(&old));
    begin_well(&mut recorder);
    free.store(10, Ordering::SeqCst);
    take(&mut recorder, 41..=50);
    let (status, notices) = recorder.finish("stopped by command");
    assert_eq!(status.stopped, None, "{notices:?}");
    assert!(!old.exists());
    let [first, second] = &status.files[..] else {
        panic!("{status:?}");
    };
    assert_eq!(ticks(first), (1..=40).collect::<Vec<_>>());
    assert_recorded_or_reported(second, 41, 50);
}

/// Without room for the last messages, no retry is announced.
#[test]
fn a_recording_that_cannot_be_finished_is_reported_without_a_retry() {
    let folder = tempfile::tempdir().unwrap();
    let (mut recorder, free) = recorder(settings(folder.path()), None);
    begin_well(&mut recorder);
    free.store(0, Ordering::SeqCst);
    let (status, notices) = recorder.finish("stopped by command");
    assert!(
        status.stopped.unwrap().contains("fccd recover"),
        "{notices:?}"
    );
    let last = &notices.last().unwrap().text;
    assert!(last.starts_with("recording stopped: "), "{last}");
    assert!(!last.contains("tried again"), "{last}");
    assert_eq!((status.ticks, status.not_recorded), (40, 0));
    assert_eq!(recover(&status.files[0], |_| {}).unwrap().ticks, 40);
}

/// As a full disk on which room is made, or one that is plugged in again.
#[test]
fn a_disk_that_has_room_again_is_recorded_to_again() {
    let folder = tempfile::tempdir().unwrap();
    let eager = RecorderSettings {
        retry_every: Duration::from_millis(20),
        ..settings(folder.path())
    };
    let (mut recorder, free) = recorder(eager, None);
    wait_for(&recorder, |status| status.file.is_some());
    let beginning = std::fs::metadata(only_file(folder.path())).unwrap().len();
    begin_well(&mut recorder);
    free.store(0, Ordering::SeqCst);
    take(&mut recorder, 41..=80);
    wait_for(&recorder, |status| status.stopped.is_some());
    // Room to begin a file, and for nothing more. It fails at its first commit
    // and is deleted.
    free.store(beginning + 10, Ordering::SeqCst);
    take(&mut recorder, 81..=90);
    wait_for(&recorder, |status| {
        free.load(Ordering::SeqCst) == 0 && status.file.is_none()
    });
    assert_eq!(recorder.status().files.len(), 1);

    free.store(u64::MAX, Ordering::SeqCst);
    wait_for(&recorder, |status| status.file.is_some());
    take(&mut recorder, 91..=100);
    let (status, notices) = recorder.finish("stopped by command");
    assert_eq!((status.stopped, status.not_recorded), (None, 50));
    assert_eq!((status.ticks, status.files.len()), (50, 2));
    assert_eq!(fcc_record::files(folder.path()).unwrap(), status.files);
    let (before, after) = (&status.files[0], &status.files[1]);
    assert_eq!(ticks(before), (1..=40).collect::<Vec<_>>());
    assert_eq!(gaps(after), [(50, 41, 90)]);
    assert_eq!(ticks(after), (91..=100).collect::<Vec<_>>());
    let recording = Recording::open(after).unwrap();
    assert!(recording.is_whole());
    assert_eq!(recording.about().part, 2);
    assert_eq!(recording.end().unwrap().not_recorded, 50);
    let remarks: Vec<_> = recording
        .items::<fcc_telemetry::FlightMessage>()
        .unwrap()
        .filter_map(|item| match item {
            Item::Remark(remark) => Some(remark.text),
            Item::Message(_) | Item::Document(_) | Item::Damage(_) => None,
        })
        .collect();
    assert!(remarks[0].starts_with("recording stopped: "), "{remarks:?}");
    // Reported when it stops and when it continues, and not at every attempt.
    let texts: Vec<_> = notices
        .iter()
        .map(|notices| notices.text.as_str())
        .collect();
    let [begins, stops, continues] = texts[..] else {
        panic!("{texts:?}");
    };
    assert!(begins.starts_with("recording to "), "{begins}");
    assert!(stops.starts_with("recording stopped: "), "{stops}");
    assert!(stops.contains("tried again every 0.02 s"), "{stops}");
    assert!(
        continues.starts_with("recording continues in "),
        "{continues}"
    );
    assert!(
        continues
            .ends_with(": 50 messages of ticks 41 to 90 are lost, all earlier ones are recorded"),
        "{continues}"
    );
}

/// A folder that cannot be created, because a file has its name: root sees this
/// on a read-only file system, too.
#[test]
fn a_folder_that_cannot_be_written_is_a_notice_and_not_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let in_the_way = folder.path().join("recordings");
    File::create(&in_the_way).unwrap();
    let mut recorder = Recorder::start(about(), settings(&in_the_way)).unwrap();
    for message in &flight(10) {
        recorder.take(message);
    }
    let (status, notices) = recorder.finish("stopped by command");
    assert_eq!(notices.len(), 1);
    assert!(
        notices[0].text.starts_with("recording stopped: "),
        "{notices:?}"
    );
    assert!(
        notices[0].is_trouble && notices[0].text.contains("--recordings"),
        "{notices:?}"
    );
    assert_eq!((status.ticks, status.not_recorded), (0, 11));
}

/// A disk that panics.
struct Broken;

impl Disk for Broken {
    fn create(&mut self, _: &Path) -> std::io::Result<Box<dyn DiskFile>> {
        panic!("required by the test");
    }
}

#[test]
fn a_recorder_that_panics_is_reported_in_flight() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder =
        Recorder::start_on(Box::new(Broken), about(), settings(folder.path())).unwrap();
    wait_for(&recorder, |status| status.stopped.is_some());
    for message in &flight(10) {
        recorder.take(message);
    }
    let (status, notices) = recorder.finish("stopped by command");
    assert!(status.stopped.unwrap().contains("panicked"), "{notices:?}");
    assert_eq!((status.ticks, status.not_recorded), (0, 11));
    assert_eq!(notices.len(), 1);
    assert!(notices[0].is_trouble);
}

//! Rotation of files, and the size limit of a folder.

use std::fs;
use std::time::Duration;

use fcc_core::framework::Message;
use fcc_record::{Compression, Notice, Recorder, RecorderSettings, Recording};

use crate::recording::disks::{gaps, ticks, wait_for, wait_for_ticks};
use crate::recording::flight::{about, flight, only_file, record, record_all, settings};

fn parts(settings: RecorderSettings, ticks: u64) -> Vec<Recording> {
    let folder = settings.folder.clone();
    record_all(Recorder::start(about(), settings).unwrap(), &flight(ticks));
    fcc_record::files(&folder)
        .unwrap()
        .iter()
        .map(|path| Recording::open(path).unwrap())
        .collect()
}

#[test]
fn a_recording_is_split_by_age_without_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let parts = parts(
        RecorderSettings {
            max_file_age: Some(Duration::from_secs(10)),
            ..settings(folder.path())
        },
        1_000,
    );
    // 25 s of flight.
    assert_eq!(parts.len(), 3);
    let all: Vec<u64> = parts.iter().flat_map(|part| ticks(part.path())).collect();
    assert_eq!(all, (1..=1_000).collect::<Vec<_>>());
    for (n, part) in (1..).zip(&parts) {
        assert!(part.is_whole());
        assert_eq!(part.about().part, n);
        assert_eq!(part.about().config, about().config);
    }
    assert_eq!(parts[2].end().unwrap().ending, "stopped by command");
    assert_eq!(
        parts[0].end().unwrap().ending,
        "the recording continues in its next file"
    );
}

#[test]
fn a_recording_is_split_by_size_and_earlier_ones_are_deleted() {
    split_and_kept_small(Some(2_000_000));
}

/// A file larger than the total would never be deleted.
#[test]
fn a_folder_is_kept_small_whatever_the_limit_of_a_file() {
    split_and_kept_small(None);
}

fn split_and_kept_small(max_file_bytes: Option<u64>) {
    let folder = tempfile::tempdir().unwrap();
    let limits = RecorderSettings {
        max_file_bytes,
        keep_total_bytes: Some(5_000_000),
        compression: Compression::None,
        ..settings(folder.path())
    };
    let old = folder
        .path()
        .join("2020-01-01T00-00-00.000Z-built-in-01.mcap");
    let unrelated = folder.path().join("notes.txt");
    fs::write(&old, vec![0; 1_000_000]).unwrap();
    fs::write(&unrelated, vec![0; 10_000_000]).unwrap();
    let parts = parts(limits, 20_000);
    assert!(!old.exists() && unrelated.exists());
    assert!(parts.len() >= 2);
    let sizes: Vec<u64> = parts.iter().map(Recording::bytes).collect();
    // A chunk of 1 MiB is written as a whole, and the index at the end.
    assert!(
        sizes.iter().all(|bytes| *bytes < 2_000_000 + 1_300_000),
        "{sizes:?}"
    );
    // The flight in progress keeps its own, from the first tick.
    assert!(sizes.iter().sum::<u64>() > 5_000_000, "{sizes:?}");
    let kept: Vec<u64> = parts.iter().flat_map(|part| ticks(part.path())).collect();
    assert_eq!(kept, (1..=20_000).collect::<Vec<_>>());
}

/// On a board without a clock, which says 1970 or the time of its last shutdown: flights
/// of other dates are in the folder, and the last was cut off.
#[test]
fn a_clock_that_goes_back_changes_no_order() {
    const DAY_NS: u64 = 86_400 * 1_000_000_000;
    let folder = tempfile::tempdir().unwrap();
    let fly = |started_unix_ns: u64, keep_total_bytes: Option<u64>| {
        let settings = RecorderSettings {
            keep_total_bytes,
            max_file_age: Some(Duration::from_secs(20)),
            compression: Compression::None,
            ..settings(folder.path())
        };
        let about = fcc_record::About {
            started_unix_ns,
            ..about()
        };
        let before = fcc_record::files(folder.path()).unwrap();
        record_all(Recorder::start(about, settings).unwrap(), &flight(1_000));
        let mut files = fcc_record::files(folder.path()).unwrap();
        files.retain(|file| !before.contains(file));
        files
    };
    let today = 20_000 * DAY_NS;
    let [month_ago, yesterday, last] = [today, 1, 0].map(|started_ns| fly(started_ns, None));
    assert_eq!(
        last.len(),
        2,
        "25 s of flight, with a power cut in the second part"
    );
    let bytes = fs::read(&last[1]).unwrap();
    fs::write(&last[1], &bytes[..bytes.len() / 2]).unwrap();
    let total: u64 = [&month_ago, &yesterday, &last]
        .into_iter()
        .flatten()
        .map(|path| fs::metadata(path).unwrap().len())
        .sum();
    let present = fly(12 * 1_000_000_000, Some(total * 2 / 3));
    assert!(month_ago.iter().all(|path| !path.exists()), "the oldest");
    let left = fcc_record::files(folder.path()).unwrap();
    assert!(left.ends_with(&[last, present].concat()), "{left:?}");
}

/// By another program: for example by a user who makes room.
#[test]
fn a_file_deleted_or_truncated_in_flight_is_reported_and_the_next_begun() {
    for truncated in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let mut recorder = Recorder::start(about(), settings(folder.path())).unwrap();
        for message in &flight(10) {
            recorder.take(message);
        }
        wait_for_ticks(&recorder, 10);
        let first = only_file(folder.path());
        if truncated {
            fs::File::create(&first).unwrap();
        } else {
            fs::remove_file(&first).unwrap();
        }
        recorder.take(&Message::Tick(record(11)));
        // Ten ticks and an event committed, and the last.
        wait_for(&recorder, |status| status.not_recorded == 12);
        recorder.take(&Message::Tick(record(12)));
        let (status, notices) = recorder.finish("stopped by command");
        let told = |notice: &Notice| notice.is_trouble && notice.text.contains("in flight; 12");
        assert!(notices.iter().any(told), "{notices:?}");
        assert_eq!(
            (status.ticks, status.not_recorded, status.stopped),
            (1, 12, None)
        );
        let [file] = &status.files[..] else {
            panic!("{:?}", status.files);
        };
        assert_eq!((ticks(file), gaps(file)), (vec![12], vec![(12, 1, 11)]));
    }
}

/// What was lost before is not recorded.
#[test]
fn a_file_that_is_deleted_again_does_not_deny_the_first_gap() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    let mut lost = 0;
    for first in [1, 11] {
        for number in first..first + 9 {
            recorder.take(&Message::Tick(record(number)));
        }
        wait_for(&recorder, |status| status.ticks >= 9);
        fs::remove_file(only_file(folder.path())).unwrap();
        recorder.take(&Message::Tick(record(first + 9)));
        lost += 10;
        wait_for(&recorder, |status| status.not_recorded >= lost);
    }
    let (_, notices) = recorder.finish("stopped by command");
    let told = |what: &str| {
        notices
            .iter()
            .filter(|notice| notice.text.contains(what))
            .count()
    };
    assert_eq!(told("in flight; "), 2, "{notices:?}");
    assert_eq!(told("all earlier ones are recorded"), 0, "{notices:?}");
}

#[test]
fn two_flights_of_one_millisecond_have_two_files() {
    let folder = tempfile::tempdir().unwrap();
    for _ in 0..2 {
        let recorder = Recorder::start(about(), settings(folder.path())).unwrap();
        record_all(recorder, &flight(3));
    }
    assert_eq!(fcc_record::files(folder.path()).unwrap().len(), 2);
}

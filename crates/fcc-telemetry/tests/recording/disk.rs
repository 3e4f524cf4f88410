//! Bad disks: full, read-only, slow, torn. The flight goes on, and nothing that
//! was recorded before is lost.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, Message};
use fcc_telemetry::FlightMessage;
use fcc_telemetry::recording::{
    Disk, DiskFile, FileSystem, Recorder, RecorderSettings, Recording, recover,
};

use crate::flight::{about, flight, only_file, record, settings};

/// A disk that holds so many bytes and not one more, until a file that takes up
/// its room is gone.
struct Small {
    free: Arc<AtomicU64>,
    in_the_way: Option<PathBuf>,
}

struct SmallFile {
    file: Box<dyn DiskFile>,
    free: Arc<AtomicU64>,
    in_the_way: Option<PathBuf>,
}

impl Disk for Small {
    fn create(&mut self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        Ok(Box::new(SmallFile {
            file: FileSystem.create(path)?,
            free: Arc::clone(&self.free),
            in_the_way: self.in_the_way.clone(),
        }))
    }
}

impl Write for SmallFile {
    /// As a file system does: what still fits is written, torn in the middle.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Deleting makes room at once, as it does on a disk.
        if self.in_the_way.as_ref().is_some_and(|file| !file.exists()) {
            self.free.store(u64::MAX, Ordering::SeqCst);
        }
        let free = self.free.load(Ordering::SeqCst) as usize;
        if free == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let written = self.file.write(&bytes[..bytes.len().min(free)])?;
        self.free.fetch_sub(written as u64, Ordering::SeqCst);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl DiskFile for SmallFile {
    fn sync(&mut self) -> io::Result<()> {
        self.file.sync()
    }

    fn cut_to(&mut self, bytes: u64) -> io::Result<()> {
        self.file.cut_to(bytes)
    }
}

/// Waits until the recorder has committed, as it does each second.
fn wait_for_ticks(recorder: &Recorder, ticks: u64) {
    let began = Instant::now();
    while recorder.status().ticks < ticks {
        assert!(
            began.elapsed() < Duration::from_secs(10),
            "{:?}",
            recorder.status()
        );
        thread::sleep(Duration::from_millis(5));
    }
}

fn ticks(path: &Path) -> Vec<u64> {
    let recording = Recording::open(path).unwrap();
    recording
        .messages()
        .unwrap()
        .filter_map(|message| match message {
            Message::Tick(record) => Some(record.tick.number),
            Message::Event(_) => None,
        })
        .collect()
}

#[test]
fn a_full_disk_ends_the_recording_and_keeps_what_was_committed() {
    let folder = tempfile::tempdir().unwrap();
    let free = Arc::new(AtomicU64::new(u64::MAX));
    let disk = Small {
        free: Arc::clone(&free),
        in_the_way: None,
    };
    let mut recorder =
        Recorder::start_on(Box::new(disk), about(), settings(folder.path())).unwrap();
    for message in &flight(40) {
        recorder.take(message);
    }
    wait_for_ticks(&recorder, 40);
    // Room for a part of the next chunk.
    free.store(100, Ordering::SeqCst);
    for number in 41..=80 {
        recorder.take(&Message::Tick(record(number)));
    }
    let (status, news) = recorder.finish("ordered to stop");

    let stopped = status.stopped.unwrap();
    assert!(
        stopped.contains("ticks 41 to 80 are lost, all before is safe"),
        "{stopped}"
    );
    assert!(
        news.last().unwrap().text.starts_with("recording stopped: "),
        "{news:?}"
    );
    assert_eq!((status.ticks, status.not_recorded), (40, 40));
    let path = only_file(folder.path());
    assert_eq!(ticks(&path), (1..=40).collect::<Vec<_>>());
    // Nothing torn is left: with room again, it becomes a whole file.
    let recovered = recover(&path, |_| {}).unwrap();
    assert_eq!(recovered.ticks, 40);
    assert!(Recording::open(&path).unwrap().is_whole());
    assert_eq!(ticks(&path), (1..=40).collect::<Vec<_>>());
}

#[test]
fn where_deleting_is_configured_a_full_disk_costs_the_oldest_recording() {
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
    let free = Arc::new(AtomicU64::new(u64::MAX));
    let mut recorder = Recorder::start_on(
        Box::new(Small {
            free: Arc::clone(&free),
            in_the_way: Some(old.clone()),
        }),
        about(),
        RecorderSettings {
            keep_total_bytes: Some(1_000_000_000),
            ..settings(folder.path())
        },
    )
    .unwrap();
    for message in &flight(40) {
        recorder.take(message);
    }
    wait_for_ticks(&recorder, 40);
    free.store(10, Ordering::SeqCst);
    for number in 41..=50 {
        recorder.take(&Message::Tick(record(number)));
    }
    let began = Instant::now();
    while old.exists() && began.elapsed() < Duration::from_secs(10) {
        thread::sleep(Duration::from_millis(5));
    }
    // The file that follows is begun as soon as there is room.
    while recorder.status().files.len() < 2 && began.elapsed() < Duration::from_secs(10) {
        thread::sleep(Duration::from_millis(5));
    }
    for number in 51..=60 {
        recorder.take(&Message::Tick(record(number)));
    }
    let (status, news) = recorder.finish("ordered to stop");
    assert_eq!(status.stopped, None, "{news:?}");
    assert!(!old.exists() && kept.exists() && unrelated.exists());
    assert_eq!(status.files.len(), 2, "{news:?}");
    assert_eq!(ticks(&status.files[0]), (1..=40).collect::<Vec<_>>());
    assert_eq!(ticks(&status.files[1]), (51..=60).collect::<Vec<_>>());
    let told: Vec<_> = Recording::open(&status.files[1])
        .unwrap()
        .messages()
        .unwrap()
        .filter_map(|message| match message {
            Message::Event(event) => Some(event.kind),
            Message::Tick(_) => None,
        })
        .collect();
    assert_eq!(
        told,
        [EventKind::NotRecorded {
            count: 10,
            first: 41,
            last: 50
        }]
    );
}

/// A folder that cannot be made, because a file is in its place: what a
/// read-only file system looks like to root, too.
#[test]
fn a_folder_that_cannot_be_written_is_news_and_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let in_the_way = folder.path().join("recordings");
    File::create(&in_the_way).unwrap();
    let mut recorder = Recorder::start(about(), settings(&in_the_way)).unwrap();
    for message in &flight(10) {
        recorder.take(message);
    }
    let (status, news) = recorder.finish("ordered to stop");
    assert_eq!(news.len(), 1);
    assert!(news[0].text.starts_with("recording stopped: "), "{news:?}");
    assert!(
        news[0].is_trouble && news[0].text.contains("--recordings"),
        "{news:?}"
    );
    assert_eq!((status.ticks, status.not_recorded), (0, 11));
}

/// A disk whose syncs wait until they are let go.
struct Stuck {
    gate: Arc<(Mutex<bool>, Condvar)>,
}

struct StuckFile {
    file: Box<dyn DiskFile>,
    gate: Arc<(Mutex<bool>, Condvar)>,
}

impl Disk for Stuck {
    fn create(&mut self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        Ok(Box::new(StuckFile {
            file: FileSystem.create(path)?,
            gate: Arc::clone(&self.gate),
        }))
    }
}

impl Write for StuckFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl DiskFile for StuckFile {
    fn sync(&mut self) -> io::Result<()> {
        let (open, changed) = &*self.gate;
        let mut open = open.lock().unwrap();
        while !*open {
            open = changed.wait(open).unwrap();
        }
        self.file.sync()
    }

    fn cut_to(&mut self, bytes: u64) -> io::Result<()> {
        self.file.cut_to(bytes)
    }
}

fn set(gate: &(Mutex<bool>, Condvar), open: bool) {
    *gate.0.lock().unwrap() = open;
    gate.1.notify_all();
}

#[test]
fn what_a_slow_disk_costs_is_counted_and_told_with_its_span() {
    let folder = tempfile::tempdir().unwrap();
    let gate = Arc::new((Mutex::new(false), Condvar::new()));
    let disk = Stuck {
        gate: Arc::clone(&gate),
    };
    let capacity = 16;
    let mut recorder = Recorder::start_on(
        Box::new(disk),
        about(),
        RecorderSettings {
            capacity,
            ..RecorderSettings::new(folder.path())
        },
    )
    .unwrap();
    // The disk hangs in the file's first sync: the recorder's thread takes
    // nothing, and 16 messages fit on the way to it.
    let began = Instant::now();
    for number in 1..=1_000 {
        recorder.take(&Message::Tick(record(number)));
    }
    assert!(
        began.elapsed() < Duration::from_secs(2),
        "somebody waited for the disk"
    );
    let dropped = recorder.status().not_recorded;
    assert_eq!(dropped, 1_000 - capacity as u64);
    set(&gate, true);
    wait_for_ticks(&recorder, capacity as u64);
    recorder.take(&Message::Tick(record(1_001)));
    let (status, _) = recorder.finish("ordered to stop");
    assert_eq!((status.ticks, status.stopped), (17, None));

    let path = only_file(folder.path());
    let messages: Vec<FlightMessage> = Recording::open(&path)
        .unwrap()
        .messages()
        .unwrap()
        .skip(capacity)
        .collect();
    let [Message::Event(gap), Message::Tick(last)] = messages[..] else {
        panic!("{messages:?}");
    };
    assert_eq!(
        gap.kind,
        EventKind::NotRecorded {
            count: 984,
            first: 17,
            last: 1_000
        }
    );
    assert_eq!((gap.tick, last.tick.number), (1_001, 1_001));
    assert_eq!(
        Recording::open(&path).unwrap().end().unwrap().not_recorded,
        984
    );
}

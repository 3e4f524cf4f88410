//! Failing disks, and the files they leave.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, Message};
use fcc_record::{Disk, DiskFile, FileSystem, Recorder, RecorderStatus, Recording};

/// A disk with a limited number of bytes. Deleting `in_the_way` makes room.
pub(crate) struct Small {
    pub(crate) free: Arc<AtomicU64>,
    pub(crate) in_the_way: Option<PathBuf>,
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
    /// As a file system does: what fits is written, even a part of a record.
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

/// A disk whose syncs block until the gate opens.
pub(crate) struct StuckDisk {
    pub(crate) gate: Arc<(Mutex<bool>, Condvar)>,
}

struct StuckFile {
    file: Box<dyn DiskFile>,
    gate: Arc<(Mutex<bool>, Condvar)>,
}

impl Disk for StuckDisk {
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

pub(crate) fn set(gate: &(Mutex<bool>, Condvar), open: bool) {
    *gate.0.lock().unwrap() = open;
    gate.1.notify_all();
}

/// Waits until the recorder's status meets a condition.
pub(crate) fn wait_for(recorder: &Recorder, so: impl Fn(&RecorderStatus) -> bool) {
    let began = Instant::now();
    while !so(&recorder.status()) {
        assert!(
            began.elapsed() < Duration::from_secs(30),
            "{:?}",
            recorder.status()
        );
        thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until the recorder has committed.
pub(crate) fn wait_for_ticks(recorder: &Recorder, ticks: u64) {
    wait_for(recorder, |status| status.ticks >= ticks);
}

pub(crate) fn ticks(path: &Path) -> Vec<u64> {
    let recording = Recording::open(path).unwrap();
    recording
        .messages::<fcc_telemetry::FlightMessage>()
        .unwrap()
        .filter_map(|message| match message {
            Message::Tick(record) => Some(record.tick.number),
            Message::Event(_) => None,
        })
        .collect()
}

/// The gaps reported in a file: number of messages, first and last tick.
pub(crate) fn gaps(path: &Path) -> Vec<(u64, u64, u64)> {
    let recording = Recording::open(path).unwrap();
    recording
        .messages::<fcc_telemetry::FlightMessage>()
        .unwrap()
        .filter_map(|message| match message {
            Message::Event(event) => match event.kind {
                EventKind::NotRecorded { count, first, last } => Some((count, first, last)),
                _ => None,
            },
            Message::Tick(_) => None,
        })
        .collect()
}

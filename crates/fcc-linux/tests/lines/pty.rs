//! A serial line of which the test has the other end, and may pull it out.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

use fcc_conformance::Ticks;
use fcc_core::framework::Time;
use fcc_linux::{DeviceError, DeviceSensor, DeviceThread, Measured, Sample, Source};
use nix::pty::openpty;
use nix::unistd::ttyname;
use tempfile::TempDir;

/// No test waits as long as this, unless something is wrong.
const AT_MOST: Duration = Duration::from_secs(20);

/// A source, and when it has handed over what it read.
struct Watched<S> {
    source: S,
    has_given: bool,
    handed_over: Sender<()>,
}

impl<S: Source> Source for Watched<S> {
    type Value = S::Value;

    fn read(&mut self) -> Result<Option<Sample<S::Value>>, DeviceError> {
        if self.has_given {
            let _ = self.handed_over.send(());
        }
        let read = self.source.read();
        self.has_given = matches!(read, Ok(Some(_)));
        read
    }
}

/// A line, and the sensor that reads it. The clock is that of the test's ticks.
pub(crate) struct Line<V> {
    pub(crate) sensor: DeviceSensor<V>,
    device: Option<File>,
    folder: TempDir,
    handed_over: Receiver<()>,
    clock: Arc<AtomicI64>,
    now: Ticks,
}

/// The device's clock.
pub(crate) type Clock = Box<dyn Fn() -> Time + Send>;

impl<V: Measured> Line<V> {
    pub(crate) fn new<S: Source<Value = V> + 'static>(
        open: impl Fn(PathBuf, Clock) -> Result<S, DeviceError> + Send + 'static,
    ) -> Self {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("line");
        let (handing_over, handed_over) = mpsc::channel();
        let clock = Arc::new(AtomicI64::new(0));
        let shown = Arc::clone(&clock);
        let opens = move || {
            let shown = Arc::clone(&shown);
            let clock = move || Time::from_nanos(shown.load(Ordering::Relaxed));
            Ok(Watched {
                source: open(path.clone(), Box::new(clock))?,
                has_given: true,
                handed_over: handing_over.clone(),
            })
        };
        let pause = Duration::from_millis(1);
        let sensor = DeviceThread::new("line")
            .pauses(pause, pause)
            .start(opens)
            .unwrap();
        let mut line = Self {
            sensor,
            device: None,
            folder,
            handed_over,
            clock,
            now: Ticks::default(),
        };
        line.plug_in();
        line
    }

    /// The line is there, under the same name, and is open.
    pub(crate) fn plug_in(&mut self) {
        let pair = openpty(None, None).unwrap();
        let path = self.folder.path().join("line");
        let _ = fs::remove_file(&path);
        symlink(ttyname(&pair.slave).unwrap(), path).unwrap();
        self.device = Some(pair.master.into());
        self.handed_over.recv_timeout(AT_MOST).unwrap();
    }

    /// The line is gone.
    pub(crate) fn pull_out(&mut self) {
        self.device = None;
    }

    /// The device sends, a moment before the next tick; it has been read then, if
    /// it is there.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        let taken = self.now.next_tick().woke - Duration::from_millis(1);
        self.clock.store(taken.as_nanos(), Ordering::Relaxed);
        if let Some(device) = &mut self.device {
            device.write_all(bytes).unwrap();
            self.handed_over.recv_timeout(AT_MOST).unwrap();
        }
    }
}

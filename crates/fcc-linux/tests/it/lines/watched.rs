//! A sensor whose thread says when it has handed over what it read, with the clock
//! of the test's ticks.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

use fcc_conformance::Ticks;
use fcc_core::framework::Time;
use fcc_linux::{DeviceError, DeviceSensor, DeviceThread, Measured, Sample, Source};

/// No test waits as long as this, unless something is wrong.
pub(crate) const AT_MOST: Duration = Duration::from_secs(20);

/// The device's clock.
pub(crate) type Clock = Box<dyn Fn() -> Time + Send>;

/// A source, and when it has handed over what it read.
struct Telling<S> {
    source: S,
    has_given: bool,
    handed_over: Sender<()>,
}

impl<S: Source> Source for Telling<S> {
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

/// The sensor, and its clock.
pub(crate) struct Watched<V> {
    pub(crate) sensor: DeviceSensor<V>,
    handed_over: Receiver<()>,
    clock: Arc<AtomicI64>,
    now: Ticks,
}

impl<V: Measured> Watched<V> {
    pub(crate) fn new<S: Source<Value = V> + 'static>(
        open: impl Fn(Clock) -> Result<S, DeviceError> + Send + 'static,
    ) -> Self {
        let (handing_over, handed_over) = mpsc::channel();
        let clock = Arc::new(AtomicI64::new(0));
        let shown = Arc::clone(&clock);
        let opens = move || {
            let shown = Arc::clone(&shown);
            let clock = move || Time::from_nanos(shown.load(Ordering::Relaxed));
            Ok(Telling {
                source: open(Box::new(clock))?,
                has_given: true,
                handed_over: handing_over.clone(),
            })
        };
        let pause = Duration::from_millis(1);
        let sensor = DeviceThread::new("device")
            .pauses(pause, pause)
            .start(opens)
            .unwrap();
        Self {
            sensor,
            handed_over,
            clock,
            now: Ticks::default(),
        }
    }

    /// What is read next is read a moment before the next tick.
    pub(crate) fn next(&mut self) {
        let taken = self.now.next_tick().woke - Duration::from_millis(1);
        self.clock.store(taken.as_nanos(), Ordering::Relaxed);
    }

    /// Waits until the device is open, or what was read is handed over.
    pub(crate) fn settle(&self) {
        self.handed_over.recv_timeout(AT_MOST).unwrap();
    }
}

//! The thread that opens a device, reads it, and opens it again.

use core::time::Duration;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use fcc_core::framework::{FALLBACK_AFTER, SensorFault, Time};
use rtrb::{Producer, RingBuffer};

use crate::device_sensor::{DeviceSensor, Message, ThreadHandle};
use crate::{DeviceError, Source};

/// Messages that fit between a thread and the loop: a tick every 100 ms takes
/// those of a device that gives 2,500 a second.
const CAPACITY: usize = 256;

/// The most that its thread needs; the default, 2 MiB, would be locked in memory
/// for each device.
const STACK_BYTES: usize = 256 * 1024;

/// Invalid samples in a row after which a device is set up again: one that lost
/// its power for a moment has lost its registers.
const MALFORMED_IN_A_ROW: u32 = 20;

/// How the thread of a device is started.
///
/// ```
/// # use core::time::Duration;
/// # use fcc_device::DeviceThread;
/// let slow = DeviceThread::new("GNSS").silent_after(Duration::from_secs(2));
/// # drop(slow);
/// ```
#[derive(Clone, Debug)]
pub struct DeviceThread {
    kind: &'static str,
    name: String,
    silent_after: Duration,
    fallback_after: Duration,
    pauses: (Duration, Duration),
    status: DeviceStatus,
}

impl DeviceThread {
    /// A thread for a device of this kind, which is the name of its sensor, too.
    pub fn new(kind: &'static str) -> Self {
        Self {
            kind,
            name: kind.to_owned(),
            silent_after: Duration::from_millis(500),
            fallback_after: FALLBACK_AFTER,
            pauses: (Duration::from_millis(100), Duration::from_secs(2)),
            status: DeviceStatus::default(),
        }
    }

    /// Another name of its sensor: which of several of its kind it is.
    #[must_use]
    pub fn named(mut self, name: String) -> Self {
        self.name = name;
        self
    }

    /// After how long without a sample silence is a fault; 500 ms by default.
    #[must_use]
    pub fn silent_after(mut self, silent_after: Duration) -> Self {
        self.silent_after = silent_after;
        self
    }

    /// See [`Sensor::fallback_after`](fcc_core::framework::Sensor::fallback_after).
    #[must_use]
    pub fn fallback_after(mut self, fallback_after: Duration) -> Self {
        self.fallback_after = fallback_after;
        self
    }

    /// The first and the longest pause before the device is opened again; each
    /// is twice the one before. 100 ms and 2 s by default.
    #[must_use]
    pub fn pauses(mut self, first: Duration, longest: Duration) -> Self {
        self.pauses = (first, longest);
        self
    }

    /// The device's state, for outside of the loop.
    pub fn status(&self) -> DeviceStatus {
        self.status.clone()
    }

    /// Starts the thread. The device is opened there: one that is not connected
    /// yet is a fault of the sensor until it is.
    ///
    /// # Errors
    /// When the thread cannot be started.
    pub fn start<S: Source + 'static>(
        self,
        open: impl FnMut() -> Result<S, DeviceError> + Send + 'static,
    ) -> io::Result<DeviceSensor<S::Value>> {
        let (producer, messages) = RingBuffer::new(CAPACITY);
        let handle = Arc::new(AtomicBool::new(false));
        let reader = Reader {
            open,
            producer,
            end: Arc::clone(&handle),
            pauses: self.pauses,
            silent_after: self.silent_after,
            status: self.status,
        };
        let thread = thread::Builder::new()
            .name(self.kind.chars().take(15).collect())
            .stack_size(STACK_BYTES)
            .spawn(move || reader.run())?;
        Ok(DeviceSensor {
            messages,
            name: self.name,
            silent_after: self.silent_after,
            fallback_after: self.fallback_after,
            newest: Time::NEVER,
            fault: None,
            malformed: false,
            _thread: ThreadHandle {
                end: handle,
                thread: Some(thread),
            },
        })
    }
}

/// A device's state, for programs that show it; not for a tick.
#[derive(Clone, Debug, Default)]
pub struct DeviceStatus(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    trouble: Option<String>,
    waits_for: Option<&'static str>,
}

impl DeviceStatus {
    /// What is wrong with the device now, where, and what to do; `None` if nothing
    /// is.
    pub fn trouble(&self) -> Option<String> {
        self.lock().trouble.clone()
    }

    /// What a device that works waits for ([`Source::waits_for`]); `None` if it is
    /// read, or something is wrong with it.
    pub fn waits_for(&self) -> Option<&'static str> {
        self.lock().waits_for
    }

    /// Sets what is wrong with it; `None` if it is used.
    pub fn set(&self, error: Option<&DeviceError>) {
        *self.lock() = State {
            trouble: error.map(ToString::to_string),
            waits_for: None,
        };
    }

    fn set_waiting(&self, waits_for: &'static str) {
        *self.lock() = State {
            trouble: None,
            waits_for: Some(waits_for),
        };
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Why a device is read no more.
enum Ended {
    /// The thread is to end.
    Asked,
    /// It failed; whether there was a sample before.
    Failed(DeviceError, bool),
}

struct Reader<S: Source, O> {
    open: O,
    producer: Producer<Message<S::Value>>,
    end: Arc<AtomicBool>,
    pauses: (Duration, Duration),
    silent_after: Duration,
    status: DeviceStatus,
}

impl<S: Source, O: FnMut() -> Result<S, DeviceError>> Reader<S, O> {
    fn run(mut self) {
        let (first, longest) = self.pauses;
        let mut pause = first;
        while !self.is_to_end() {
            match (self.open)() {
                // Reported before it is closed.
                Ok(mut source) => match self.read(&mut source) {
                    Ended::Asked => return,
                    Ended::Failed(error, delivered) => {
                        self.report(&error);
                        // What is refused is so the next time, too.
                        if delivered && !matches!(error, DeviceError::Refused { .. }) {
                            pause = first;
                        }
                    }
                },
                Err(error) => self.report(&error),
            }
            // Shorter if it is to end.
            thread::park_timeout(pause);
            pause = (pause * 2).min(longest);
        }
    }

    fn read(&mut self, source: &mut S) -> Ended {
        let mut delivered = false;
        let mut malformed = 0;
        let (mut latest, mut waits) = (Instant::now(), None);
        while !self.is_to_end() {
            match source.read() {
                Ok(None) if latest.elapsed() < self.silent_after => {}
                Ok(None) => {
                    let waits_for = source.waits_for();
                    if let Some(what) = waits_for.filter(|_| waits_for != waits) {
                        self.status.set_waiting(what);
                        waits = waits_for;
                    }
                }
                Ok(Some(sample)) => {
                    if !delivered || malformed > 0 || waits.is_some() {
                        self.status.set(None);
                    }
                    (delivered, malformed) = (true, 0);
                    (latest, waits) = (Instant::now(), None);
                    self.send(Message::Sample(sample));
                }
                Err(error @ DeviceError::Malformed { .. }) => {
                    malformed += 1;
                    if malformed == MALFORMED_IN_A_ROW {
                        return Ended::Failed(error, delivered);
                    }
                    self.report(&error);
                    waits = None;
                }
                Err(error) => return Ended::Failed(error, delivered),
            }
        }
        Ended::Asked
    }

    fn report(&mut self, error: &DeviceError) {
        self.status.set(Some(error));
        let fault: SensorFault = error.fault();
        self.send(Message::Fault(fault));
    }

    /// If the ring is full the loop does not run, and has no use for more.
    fn send(&mut self, message: Message<S::Value>) {
        let _ = self.producer.push(message);
    }

    fn is_to_end(&self) -> bool {
        self.end.load(Ordering::Relaxed)
    }
}

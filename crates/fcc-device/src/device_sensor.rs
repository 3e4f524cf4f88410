//! The sensor of a device that another thread reads.

use core::time::Duration;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, Tick, Time};
use rtrb::Consumer;

use crate::{Measured, Sample};

/// What the thread of a device hands over.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Message<V> {
    Sample(Sample<V>),
    Fault(SensorFault),
}

/// How far a sample may be ahead of a tick: it may be taken after the tick woke,
/// and then belongs to the next one. One that is further ahead has a wrong clock.
const MOST_AHEAD: Duration = Duration::from_millis(10);

/// How long the drop of a sensor waits for its thread.
const END_WITHIN: Duration = Duration::from_secs(1);

/// A device as a sensor: takes what its thread has read since the last tick.
///
/// Waits for nothing, and allocates nothing. When it is dropped, the thread ends.
#[derive(Debug)]
pub struct DeviceSensor<V> {
    pub(crate) messages: Consumer<Message<V>>,
    pub(crate) name: String,
    pub(crate) silent_after: Duration,
    pub(crate) fallback_after: Duration,
    pub(crate) newest: Time,
    /// Until the next sample.
    pub(crate) fault: Option<SensorFault>,
    /// Whether something arrived since the last sample that is none.
    pub(crate) malformed: bool,
    pub(crate) _thread: ThreadHandle,
}

impl<V: Measured> DeviceSensor<V> {
    /// How much was handed over since the last tick, samples and faults.
    pub fn waiting(&self) -> usize {
        self.messages.slots()
    }

    /// Whether there was ever a sample.
    pub const fn has_delivered(&self) -> bool {
        !self.newest.is_never()
    }

    /// The next message for this tick, if there is one.
    fn next(&mut self, woke: Time) -> Option<Message<V>> {
        if let Ok(Message::Sample(sample)) = self.messages.peek()
            && sample.taken > woke
            && sample.taken <= woke + MOST_AHEAD
        {
            return None;
        }
        self.messages.pop().ok()
    }

    /// Whether a sample is not before the last one, and not of the future.
    fn is_in_order(&self, sample: &Sample<V>, woke: Time) -> bool {
        sample.taken >= self.newest && sample.taken <= woke
    }
}

impl<V: Measured> Sensor<Measurements> for DeviceSensor<V> {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut pending: Option<Sample<V>> = None;
        for _ in 0..self.messages.buffer().capacity() {
            match self.next(tick.woke) {
                Some(Message::Sample(sample)) if self.is_in_order(&sample, tick.woke) => {
                    self.newest = sample.taken;
                    (self.fault, self.malformed) = (None, false);
                    let merged = pending.as_ref().and_then(|old| V::merged(old, &sample));
                    if let (None, Some(old)) = (&merged, &pending) {
                        V::write(old, into);
                    }
                    pending = Some(merged.unwrap_or(sample));
                }
                Some(Message::Sample(_) | Message::Fault(SensorFault::Malformed)) => {
                    self.malformed = true;
                }
                Some(Message::Fault(fault)) => self.fault = Some(fault),
                None => break,
            }
        }
        if let Some(sample) = &pending {
            V::write(sample, into);
        }
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        if self.newest.is_never() || tick.woke.since(self.newest) > self.silent_after {
            return Err(SensorFault::Silent);
        }
        if self.malformed {
            return Err(SensorFault::Malformed);
        }
        Ok(())
    }

    fn fallback_after(&self) -> Duration {
        self.fallback_after
    }

    fn name(&self) -> &str {
        &self.name
    }
}

/// Ends the thread when it is dropped.
#[derive(Debug)]
pub(crate) struct ThreadHandle {
    pub(crate) end: Arc<AtomicBool>,
    pub(crate) thread: Option<JoinHandle<()>>,
}

impl Drop for ThreadHandle {
    /// Waits for the thread, but not for a driver that hangs.
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        let Some(thread) = self.thread.take() else {
            return;
        };
        let until = Instant::now() + END_WITHIN;
        while !thread.is_finished() && Instant::now() < until {
            thread.thread().unpark();
            thread::sleep(Duration::from_millis(1));
        }
    }
}

//! The truth of a built-in vehicle, tick by tick, for scoring.

use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, Tick};
use fcc_sim::{HasTruth, Truth};
use rtrb::{Consumer, Producer, RingBuffer};

/// A built-in vehicle's sensor, which also writes the truth of each tick to
/// a ring. A full ring drops truths: scoring must not delay a flight.
pub(crate) struct TruthRecorder<S> {
    sensor: S,
    truth: Producer<(u64, Truth)>,
}

/// The other end of the ring.
pub struct TruthReceiver {
    truth: Consumer<(u64, Truth)>,
}

/// Records the truth of a sensor; the ring holds `capacity` ticks.
pub(crate) fn tap<S>(sensor: S, capacity: usize) -> (TruthRecorder<S>, TruthReceiver) {
    let (producer, consumer) = RingBuffer::new(capacity);
    (
        TruthRecorder {
            sensor,
            truth: producer,
        },
        TruthReceiver { truth: consumer },
    )
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl<S: Sensor<Measurements> + HasTruth> Sensor<Measurements> for TruthRecorder<S> {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let sampled = self.sensor.sample(tick, into);
        let _ = self.truth.push((tick.number, self.sensor.truth()));
        sampled
    }

    fn fallback_after(&self) -> Duration {
        self.sensor.fallback_after()
    }

    fn warm_up(&self, tick: &Tick) {
        self.sensor.warm_up(tick);
    }

    fn name(&self) -> &str {
        self.sensor.name()
    }
}

impl TruthReceiver {
    /// The truth of a tick, if it is in the ring; earlier ones are skipped.
    pub(crate) fn of_tick(&mut self, number: u64) -> Option<Truth> {
        while let Ok((tick, truth)) = self.truth.peek().copied() {
            if tick > number {
                return None;
            }
            let _ = self.truth.pop();
            if tick == number {
                return Some(truth);
            }
        }
        None
    }
}

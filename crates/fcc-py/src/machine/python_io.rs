//! The sensor and the actuator of a loop whose plant is in Python.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Actuator, ActuatorFault, Sensor, SensorFault, Tick};
use rtrb::{Consumer, Producer, RingBuffer};

use crate::values::Shape;

/// The name of both.
pub(super) const NAME: &str = "lockstep";

/// A sensor whose measurements Python queues, one sample for each tick; silent
/// in a tick without one.
pub(crate) struct QueuedSensor<M> {
    samples: Consumer<M>,
    shape: &'static Shape,
}

impl<M: Schema> QueuedSensor<M> {
    /// The queue and the sensor.
    pub(crate) fn new() -> (Producer<M>, Self) {
        let (queue, samples) = RingBuffer::new(1);
        let shape = Shape::of::<M>();
        (queue, Self { samples, shape })
    }
}

impl<M: Schema> Sensor<M> for QueuedSensor<M> {
    fn sample(&mut self, tick: &Tick, into: &mut M) -> Result<(), SensorFault> {
        let sample = self.samples.pop().map_err(|_| SensorFault::Silent)?;
        // A missing reading keeps its value and its time.
        self.shape.copy(&sample, into, Some(tick.woke));
        Ok(())
    }

    fn name(&self) -> &'static str {
        NAME
    }
}

/// An actuator that stores only whether the loop holds it; the outputs are in
/// the record of the tick.
pub(crate) struct HeldFlag(Arc<AtomicBool>);

impl HeldFlag {
    /// The flag and the actuator.
    pub(crate) fn new() -> (Arc<AtomicBool>, Self) {
        let held = Arc::new(AtomicBool::new(false));
        (Arc::clone(&held), Self(held))
    }
}

impl<O: Schema> Actuator<O> for HeldFlag {
    fn apply(&mut self, _: &Tick, _: &O) -> Result<(), ActuatorFault> {
        self.0.store(true, Ordering::Relaxed);
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.store(false, Ordering::Relaxed);
        Ok(())
    }

    fn name(&self) -> &'static str {
        NAME
    }
}

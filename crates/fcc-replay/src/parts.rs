//! Replacements for the clock and the plant in a replay.

use std::time::Duration;

use fcc_core::framework::{Actuator, ActuatorFault, Sensor, SensorFault, Tick};
use fcc_timer::{Expiry, Timer, TimerError};
use rtrb::{Consumer, Producer, RingBuffer};

/// A timer with only a period: the machine receives the recorded times tick by
/// tick.
pub(super) struct RecordedTimes {
    pub(super) period: Duration,
}

impl Timer for RecordedTimes {
    fn start(&mut self) -> Result<(), TimerError> {
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        Err(TimerError::Ended)
    }

    fn period(&self) -> Duration {
        self.period
    }

    /// It only times stages, and their times come from the record.
    fn now_ns(&self) -> i64 {
        0
    }

    fn name(&self) -> &'static str {
        "recorded"
    }
}

/// Returns recorded measurements.
///
/// They are the newest measurements of all sensors at that time, with their
/// times: a silent or failed sensor does not change them.
pub(super) struct RecordedSensor<M> {
    measured: Consumer<M>,
}

impl<M> RecordedSensor<M> {
    /// A sensor, and where to put the measurements that it returns next.
    pub(super) fn new() -> (Producer<M>, Self) {
        let (measured_in, measured) = RingBuffer::new(1);
        (measured_in, Self { measured })
    }
}

impl<M: Send> Sensor<M> for RecordedSensor<M> {
    fn sample(&mut self, _: &Tick, into: &mut M) -> Result<(), SensorFault> {
        *into = self.measured.pop().map_err(|_| SensorFault::Silent)?;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "recording"
    }
}

/// No plant: the outputs are taken from the machine's record.
pub(super) struct NoPlant;

impl<O> Actuator<O> for NoPlant {
    fn apply(&mut self, _: &Tick, _: &O) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn name(&self) -> &'static str {
        "nothing"
    }
}

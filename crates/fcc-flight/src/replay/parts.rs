//! What takes the place of clock and aircraft in a replay.

use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Sensor, SensorFault, Tick};
use fcc_timer::{Expiry, Timer, TimerError};
use rtrb::{Consumer, Producer, RingBuffer};

/// A timer that is there for its period: the recorded times are handed to the
/// machine tick by tick.
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

    /// Only stages are timed with it, and those are taken from the record.
    fn now_ns(&self) -> i64 {
        0
    }

    fn name(&self) -> &'static str {
        "recorded"
    }
}

/// Hands out recorded measurements.
///
/// They are what all sensors of the loop had measured by then, with the times
/// they were taken: a sensor that was silent or failed left them as they were.
pub(super) struct RecordedSensor {
    measured: Consumer<Measurements>,
}

impl RecordedSensor {
    /// A sensor, and where to put what it is to hand out next.
    pub(super) fn new() -> (Producer<Measurements>, Self) {
        let (measured_in, measured) = RingBuffer::new(1);
        (measured_in, Self { measured })
    }
}

impl Sensor<Measurements> for RecordedSensor {
    fn sample(&mut self, _: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        *into = self.measured.pop().map_err(|_| SensorFault::Silent)?;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "recording"
    }
}

/// No aircraft: what would be sent is taken from the machine's record.
pub(super) struct NoAircraft;

impl Actuator<Surfaces> for NoAircraft {
    fn apply(&mut self, _: &Tick, _: &Surfaces) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn name(&self) -> &'static str {
        "nothing"
    }
}

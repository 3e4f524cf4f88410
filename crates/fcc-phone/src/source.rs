//! A sensor as a source.

use core::time::Duration;
use std::collections::VecDeque;
use std::ffi::CString;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use fcc_core::framework::Time;
use fcc_device::{DeviceError, RawValues, Sample, Source, WAIT};

use crate::Kind;
use crate::health::Health;
use crate::kind::Reading;
use crate::library::{Event, EventQueue, refused};
use crate::stamps::{Clocks, Now, StampClock, Trial};

/// Without an event for so long the sensor is opened anew: some phones let one
/// stop, and go on with the next listener.
const STALLED: Duration = Duration::from_secs(1);
/// Over this time the rate is measured.
const RATE_OVER: Duration = Duration::from_secs(1);

/// What opens a sensor.
#[derive(Clone)]
pub(crate) struct Opening {
    pub(crate) kind: Kind,
    pub(crate) package: CString,
    pub(crate) rate_hz: f64,
    pub(crate) uses_own_bias: bool,
    pub(crate) clocks: Clocks,
    pub(crate) health: Health,
    /// What the phone took the bias for when it was first asked: kept, so that what it
    /// estimates anew is no jump.
    pub(crate) bias: Arc<OnceLock<[f64; 3]>>,
}

/// An open sensor.
pub(crate) struct PhoneSource {
    of: Opening,
    queue: EventQueue,
    of_type: i32,
    phase: Phase,
    /// Events that were taken together, and when.
    arrived: VecDeque<(Event, Now)>,
    heard: Instant,
    rate: RateMeter,
}

/// How far the sensor is known.
enum Phase {
    Trial(Trial),
    Known(StampClock),
}

impl Opening {
    /// Opens the sensor.
    ///
    /// # Errors
    /// When the phone has none, or refuses.
    pub(crate) fn open(&self) -> Result<PhoneSource, DeviceError> {
        let device = self.kind.name();
        let types = self.kind.types();
        let (queue, of_type, asked_hz) =
            EventQueue::open(device, &self.package, types, self.rate_hz)?;
        let mut health = self.health.write();
        health.name = queue.name();
        health.is_uncalibrated = self.kind != Kind::Barometer && types.first() == Some(&of_type);
        health.asked_hz = Some(asked_hz);
        health.measured_hz = None;
        drop(health);
        Ok(PhoneSource {
            of: self.clone(),
            queue,
            of_type,
            phase: Phase::Trial(Trial::default()),
            arrived: VecDeque::new(),
            heard: Instant::now(),
            rate: RateMeter::default(),
        })
    }
}

impl PhoneSource {
    /// Waits for events; whether there are any.
    fn wait(&mut self) -> Result<bool, DeviceError> {
        let events = self.queue.wait(WAIT)?;
        let now = self.of.clocks.now();
        let of_type = self.of_type;
        // Others say that a queue was flushed.
        let own = events.iter().filter(|event| event.sensor_type == of_type);
        self.arrived.extend(own.map(|event| (*event, now)));
        if !self.arrived.is_empty() {
            self.heard = Instant::now();
            return Ok(true);
        }
        if self.heard.elapsed() > STALLED {
            return Err(DeviceError::Stalled {
                device: self.of.kind.name().to_owned(),
                after: STALLED,
            });
        }
        Ok(false)
    }

    fn take(&mut self, event: &Event, now: Now) -> Result<Option<Sample<RawValues>>, DeviceError> {
        let device = self.of.kind.name();
        let malformed = |what| DeviceError::Malformed {
            device: device.to_owned(),
            what,
        };
        let reading = self.of.kind.read(event.sensor_type, &event.data);
        let reading = reading.map_err(malformed)?;
        let clock = match &mut self.phase {
            Phase::Known(clock) => *clock,
            Phase::Trial(trial) => {
                let Some((clock, rate_hz)) = trial.take(device, event.timestamp, now)? else {
                    return Ok(None);
                };
                self.of.accept(clock, rate_hz)?;
                self.phase = Phase::Known(clock);
                clock
            }
        };
        let taken = clock.time(event.timestamp, now);
        let taken = taken.ok_or_else(|| malformed("its time stamp is of no known clock"))?;
        let bias = match reading.bias {
            Some(bias) if self.of.uses_own_bias => *self.of.bias.get_or_init(|| bias),
            _ => [0.0; 3],
        };
        self.show(taken, &reading);
        Ok(Some(Sample::new(
            taken,
            self.of.kind.raw_values(&reading, bias),
        )))
    }

    fn show(&mut self, taken: Time, reading: &Reading) {
        let rate_hz = self.rate.take(taken);
        let mut health = self.of.health.write();
        health.newest = taken;
        if rate_hz.is_some() {
            health.measured_hz = rate_hz;
        }
        health.accuracy = reading.accuracy;
    }
}

impl Opening {
    /// Whether a sensor may be used, whose clock and rate are known now.
    fn accept(&self, clock: StampClock, rate_hz: f64) -> Result<(), DeviceError> {
        let mut health = self.health.write();
        health.clock = Some(clock);
        health.measured_hz = Some(rate_hz);
        let asked_hz = health.asked_hz.unwrap_or(self.rate_hz);
        drop(health);
        let lowest_hz = self.kind.lowest_rate_hz();
        if rate_hz < lowest_hz {
            let what = format!(
                "it gives {rate_hz:.1} events a second, of {asked_hz:.0} that were asked for: \
                 {lowest_hz:.0} are needed; end other apps, and switch battery saving off"
            );
            return Err(refused(self.kind.name(), what));
        }
        Ok(())
    }
}

impl Source for PhoneSource {
    type Value = RawValues;

    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        if self.arrived.is_empty() && !self.wait()? {
            return Ok(None);
        }
        match self.arrived.pop_front() {
            Some((event, now)) => self.take(&event, now),
            None => Ok(None),
        }
    }
}

impl Drop for PhoneSource {
    /// What is closed has no rate.
    fn drop(&mut self) {
        self.of.health.write().measured_hz = None;
    }
}

/// Counts events.
#[derive(Debug, Default)]
struct RateMeter {
    since: Option<Time>,
    events: u32,
}

impl RateMeter {
    /// Takes an event; the rate, Hz, each time that it is known anew.
    fn take(&mut self, taken: Time) -> Option<f64> {
        let since = *self.since.get_or_insert(taken);
        let lasted = taken.since(since);
        if lasted < RATE_OVER {
            self.events += 1;
            return None;
        }
        let rate_hz = f64::from(self.events) / lasted.as_secs_f64();
        (self.since, self.events) = (Some(taken), 1);
        Some(rate_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_the_stamps() {
        let mut meter = RateMeter::default();
        let rates: Vec<f64> = (0..=400)
            .filter_map(|number| meter.take(Time::from_nanos(number * 5_000_000)))
            .collect();
        assert_eq!(rates.len(), 2);
        assert!(rates.iter().all(|rate_hz| (rate_hz - 200.0).abs() < 1e-9));
    }
}

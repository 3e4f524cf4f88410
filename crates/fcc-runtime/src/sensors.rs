//! The loop's sensors and their health.

use fcc_core::framework::{EventKind, Sensor, SensorFault, Tick};

use crate::faults::{Change, Health};
use crate::telemetry_producer::Events;

struct Watched<M> {
    sensor: Box<dyn Sensor<M>>,
    health: Health<SensorFault>,
}

/// The loop's sensors and their health.
pub(crate) struct Sensors<M> {
    all: Vec<Watched<M>>,
    faults: u64,
}

impl<M> Sensors<M> {
    pub(crate) fn new(sensors: Vec<Box<dyn Sensor<M>>>) -> Self {
        let watched = |sensor| Watched {
            sensor,
            health: Health::new(),
        };
        Self {
            all: sensors.into_iter().map(watched).collect(),
            faults: 0,
        }
    }

    /// Samples every sensor, even if one fails.
    pub(crate) fn sample<O>(&mut self, tick: &Tick, into: &mut M, events: &mut Events<O>) {
        for (index, watched) in (0..).zip(&mut self.all) {
            let result = watched.sensor.sample(tick, into);
            self.faults += u64::from(result.is_err());
            match watched.health.update(result) {
                Some(Change::Fault(fault)) => {
                    events.push(tick, EventKind::SensorFault { index, fault });
                }
                Some(Change::Recovered) => events.push(tick, EventKind::SensorRecovered { index }),
                None => {}
            }
        }
    }

    /// Warms every sensor up for this tick, without effect.
    pub(crate) fn warm_up(&self, tick: &Tick) {
        for watched in &self.all {
            watched.sensor.warm_up(tick);
        }
    }

    /// Failed samples since the start.
    pub(crate) const fn faults(&self) -> u64 {
        self.faults
    }
}

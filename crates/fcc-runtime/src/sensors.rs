//! The loop's sensors: sampled, watched, and of several the best chosen.

use std::time::Duration;

use fcc_core::framework::{EventKind, Preference, Readings, Sensor, SensorFault, Sources, Tick};

use crate::faults::{Change, Health};
use crate::telemetry_producer::Events;

struct Watched<M> {
    sensor: Box<dyn Sensor<M>>,
    health: Health<SensorFault>,
    /// What it has measured, where it is one of several.
    own: M,
}

/// The loop's sensors, the most preferred first.
pub(crate) struct Sensors<M> {
    all: Vec<Watched<M>>,
    fresh_for: Vec<Duration>,
    sources: Sources,
    faults: u64,
}

impl<M: Readings + Copy + Default> Sensors<M> {
    pub(crate) fn new(sensors: Vec<Box<dyn Sensor<M>>>) -> Self {
        let watched = |sensor| Watched {
            sensor,
            health: Health::new(),
            own: M::default(),
        };
        Self {
            fresh_for: sensors.iter().map(|s| s.fallback_after()).collect(),
            all: sensors.into_iter().map(watched).collect(),
            sources: Sources::default(),
            faults: 0,
        }
    }

    /// Samples every sensor, one that fails included: the others go on. Then
    /// takes each reading from the first sensor that has a fresh one.
    pub(crate) fn sample<O>(&mut self, tick: &Tick, into: &mut M, events: &mut Events<O>) {
        if let [only] = &mut self.all[..] {
            // Nothing to choose: what it writes is what is measured.
            let result = only.sensor.sample(tick, into);
            self.faults += u64::from(result.is_err());
            only.note(0, result, tick, events);
        } else {
            self.sample_several(tick, into, events);
        }
        self.sources.watch(into, |change| {
            events.push(tick, EventKind::SourceChanged(change));
        });
    }

    fn sample_several<O>(&mut self, tick: &Tick, into: &mut M, events: &mut Events<O>) {
        let by = Preference {
            now: tick.woke,
            fresh_for: &self.fresh_for,
        };
        for (index, watched) in (0..).zip(&mut self.all) {
            let result = watched.sensor.sample(tick, &mut watched.own);
            self.faults += u64::from(result.is_err());
            watched.note(index, result, tick, events);
            // There are no more than a reading's source can name.
            let place = index as u8;
            if place == 0 {
                *into = watched.own;
            } else {
                into.choose(&watched.own, place, &by);
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

impl<M> Watched<M> {
    fn note<O>(
        &mut self,
        index: u16,
        result: Result<(), SensorFault>,
        tick: &Tick,
        events: &mut Events<O>,
    ) {
        match self.health.update(result) {
            Some(Change::Fault(fault)) => {
                events.push(tick, EventKind::SensorFault { index, fault });
            }
            Some(Change::Recovered) => events.push(tick, EventKind::SensorRecovered { index }),
            None => {}
        }
    }
}

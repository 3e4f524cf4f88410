//! The loop's sensors: sampled, watched, and of several the best chosen.

use fcc_core::framework::{
    Controller, EventKind, Preference, Preferred, ReadingSet, Readings, Sensor, SensorFault,
    Sources, Tick,
};

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
    preferred: Vec<Preferred>,
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
            preferred: sensors
                .iter()
                .map(|sensor| Preferred {
                    fresh_for: sensor.fallback_after(),
                    plausible: ReadingSet::ALL,
                })
                .collect(),
            all: sensors.into_iter().map(watched).collect(),
            sources: Sources::default(),
            faults: 0,
        }
    }

    /// Samples every sensor, one that fails included: the others go on. Then
    /// takes each reading from the first sensor that has a fresh one which the
    /// controller calls plausible.
    pub(crate) fn sample<C: Controller<Measurements = M>>(
        &mut self,
        tick: &Tick,
        into: &mut M,
        controller: &mut C,
        events: &mut Events<C::Command>,
    ) {
        if let [only] = &mut self.all[..] {
            // Nothing to choose: what it writes is what is measured.
            let result = only.sensor.sample(tick, into);
            self.faults += u64::from(result.is_err());
            only.note(0, result, tick, events);
        } else {
            self.sample_several(tick, into, controller, events);
        }
        self.sources.watch(into, |change| {
            events.push(tick, EventKind::SourceChanged(change));
        });
    }

    fn sample_several<C: Controller<Measurements = M>>(
        &mut self,
        tick: &Tick,
        into: &mut M,
        controller: &mut C,
        events: &mut Events<C::Command>,
    ) {
        // There are no more than a reading's source can name.
        for ((index, watched), by) in (0_u8..).zip(&mut self.all).zip(&mut self.preferred) {
            let result = watched.sensor.sample(tick, &mut watched.own);
            self.faults += u64::from(result.is_err());
            watched.note(index.into(), result, tick, events);
            controller.observe_sensor(index, &watched.own);
            by.plausible = controller.plausible(index, &watched.own);
        }
        let by = Preference {
            now: tick.woke,
            sensors: &self.preferred,
            reading: 0,
            of_one_sensor: controller.of_one_sensor(),
        };
        for (place, watched) in (0_u8..).zip(&self.all) {
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

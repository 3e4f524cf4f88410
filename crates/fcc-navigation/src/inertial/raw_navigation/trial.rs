//! Two sensors disagree: a second filter finds out which of them is wrong.

use super::super::{InertialNavigation, KalmanNavigation, Observation};
use super::consistency::Consistency;
use super::sensor_kind::{Samples, SensorKind};
use fcc_core::framework::Time;

/// A filter contradicts the other kinds of sensors, and the other filter does not, for so
/// long, s.
const CONTRADICTS_FOR_S: f64 = 0.5;

/// Only after so long, s, biases are those of the sensors: at first they are also of the
/// errors with which the filter began.
const BIASES_AFTER_S: f64 = 8.0;

/// Which of the two sensors is wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Wrong {
    /// The one that is used.
    Used,
    /// The other one.
    Other,
}

/// A copy of the filter, from when two sensors began to disagree, that takes the samples of
/// the other one, and all else as the filter does. The one that is wrong will contradict the
/// other kinds of sensors.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub(super) kind: SensorKind,
    pub(super) sensor: u8,
    pub(super) began: Time,
    filter: KalmanNavigation,
    /// When the other sensor's samples were taken, of the quantities that it has.
    taken: [Option<Time>; 2],
    /// Of the filter that is used, and of this one.
    consistency: [Consistency; 2],
    since: [Time; 2],
}

impl Trial {
    /// Begins with what the other sensor measures, where it is not the one that is used.
    pub(super) fn new(
        kind: SensorKind,
        other: &Samples,
        used: &Samples,
        filter: &KalmanNavigation,
        began: Time,
    ) -> Option<Self> {
        let mut filter = filter.clone();
        filter.set_compared(true);
        let mut taken = [None; 2];
        let mut sensor = None;
        for ((taken, other), used) in taken.iter_mut().zip(other).zip(used) {
            let other = other.filter(|other| used.is_none_or(|used| used.sensor != other.sensor));
            sensor = sensor.or(other.map(|other| other.sensor));
            *taken = other.map(|other| other.taken);
            if let Some(other) = other.filter(|_| kind != SensorKind::InertialUnit) {
                filter.forget(other.observation.kind());
            }
            match other.map(|other| other.observation) {
                Some(Observation::Rates(_)) => filter.change_gyroscopes(0.0),
                Some(Observation::SpecificForce(_)) => filter.change_accelerometers(0.0),
                Some(Observation::MagneticField(_)) => filter.change_magnetometer(),
                Some(Observation::StaticPressure(_)) => filter.change_barometer(),
                _ => {}
            }
        }
        Some(Self {
            kind,
            sensor: sensor?,
            began,
            filter,
            taken,
            consistency: [Consistency::default(); 2],
            since: [Time::NEVER; 2],
        })
    }

    /// Takes what the other sensor measures.
    pub(super) fn observe(&mut self, other: &Samples) {
        for (latest, sample) in self.taken.iter_mut().zip(other) {
            if let (Some(latest), Some(sample)) = (latest, sample)
                && sample.taken > *latest
            {
                *latest = sample.taken;
                self.filter.observe(sample.taken, sample.observation);
            }
        }
    }

    /// Takes a sample that is used, unless the other sensor has the same quantity.
    pub(super) fn share(&mut self, taken: Time, observation: Observation) {
        let replaced = SensorKind::of(&observation)
            .filter(|(kind, _)| *kind == self.kind)
            .and_then(|(_, place)| self.taken.get(place).copied().flatten());
        if replaced.is_none() {
            self.filter.observe(taken, observation);
        }
    }

    pub(super) fn learn_earth_field(&mut self, field_ut: [f64; 3]) {
        self.filter.learn_earth_field(field_ut);
    }

    /// Judges at a time, after the step of the filter that is used.
    pub(super) fn judge(&mut self, now: Time, filter: &KalmanNavigation) -> Option<Wrong> {
        self.filter.catch_up(now);
        for (of, filter) in self.consistency.iter_mut().zip([filter, &self.filter]) {
            of.add(filter.innovations());
            if now.since(self.began).as_secs_f64() > BIASES_AFTER_S {
                of.add_biases(now, filter.biases());
            }
        }
        let [used, other] = &self.consistency;
        let contradicts = match [used.contradicts(other, now), other.contradicts(used, now)] {
            // Neither is sound, or it cannot be said.
            [true, true] => [false; 2],
            one => one,
        };
        for (since, contradicts) in self.since.iter_mut().zip(contradicts) {
            if !contradicts {
                *since = Time::NEVER;
            } else if since.is_never() {
                *since = now;
            }
        }
        let lasts =
            |since: Time| !since.is_never() && now.since(since).as_secs_f64() >= CONTRADICTS_FOR_S;
        match self.since.map(lasts) {
            [true, _] => Some(Wrong::Used),
            [_, true] => Some(Wrong::Other),
            _ => None,
        }
    }
}

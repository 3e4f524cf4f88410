//! The samples that the filter has not used yet, in the order in which they were
//! taken.

use crate::inertial::{Observation, ObservationKind};
use fcc_core::framework::Time;

/// Half a second of an inertial unit at 400 Hz with everything else, or of one
/// at 1 kHz alone: two samples each time.
const CAPACITY: usize = 1_024;

/// A sample and its time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) taken: Time,
    pub(super) observation: Observation,
}

const NONE: Sample = Sample {
    taken: Time::NEVER,
    observation: Observation::StaticPressure(f64::NAN),
};

/// A ring in the order of time.
#[derive(Clone, Debug)]
pub(super) struct History {
    samples: [Sample; CAPACITY],
    first: usize,
    length: usize,
}

impl History {
    #[allow(
        clippy::large_stack_arrays,
        reason = "made once, where there is no heap"
    )]
    pub(super) const fn new() -> Self {
        Self {
            samples: [NONE; CAPACITY],
            first: 0,
            length: 0,
        }
    }

    /// Inserts a sample behind those that were taken before or with it. A full
    /// history refuses it.
    pub(super) fn insert(&mut self, sample: Sample) -> bool {
        if self.length == CAPACITY {
            return false;
        }
        let mut at = self.length;
        self.length += 1;
        while at > 0 {
            let Some(before) = self.get(at - 1).copied() else {
                break;
            };
            if before.taken <= sample.taken {
                break;
            }
            self.set(at, before);
            at -= 1;
        }
        self.set(at, sample);
        true
    }

    /// Removes the oldest sample if it was taken at `until` or before, or in any
    /// case if the history is nearly full.
    pub(super) fn pop(&mut self, until: Time) -> Option<Sample> {
        let sample = *self.get(0)?;
        if sample.taken > until && self.length < CAPACITY - CAPACITY / 16 {
            return None;
        }
        self.first = (self.first + 1) % CAPACITY;
        self.length -= 1;
        Some(sample)
    }

    /// Removes the samples of a sensor.
    pub(super) fn remove(&mut self, kind: ObservationKind) {
        let before = core::mem::take(&mut self.length);
        for at in 0..before {
            let sample = self.samples.get((self.first + at) % CAPACITY).copied();
            if let Some(sample) = sample.filter(|sample| sample.observation.kind() != kind) {
                self.set(self.length, sample);
                self.length += 1;
            }
        }
    }

    /// The samples behind the first `skip`, the oldest first.
    pub(super) fn after(&self, skip: usize) -> impl Iterator<Item = &Sample> {
        (skip..self.length).filter_map(|at| self.get(at))
    }

    fn get(&self, at: usize) -> Option<&Sample> {
        if at >= self.length {
            return None;
        }
        self.samples.get((self.first + at) % CAPACITY)
    }

    fn set(&mut self, at: usize, sample: Sample) {
        if let Some(place) = self.samples.get_mut((self.first + at) % CAPACITY) {
            *place = sample;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(taken: i64) -> Sample {
        Sample {
            taken: Time::from_nanos(taken),
            observation: Observation::Airspeed(taken as f64),
        }
    }

    #[test]
    fn samples_come_out_in_the_order_in_which_they_were_taken() {
        let mut history = History::new();
        // More than once around the ring.
        for round in 0..500 {
            for taken in [3, 1, 5, 2, 4] {
                assert!(history.insert(sample(10 * round + taken)));
            }
            for taken in 1..=5 {
                let until = Time::from_nanos(10 * round + taken);
                assert_eq!(history.pop(until).unwrap().taken, until);
                assert!(history.pop(until).is_none());
            }
        }
    }

    #[test]
    fn the_samples_of_a_sensor_are_removed() {
        let mut history = History::new();
        for taken in 1..=5 {
            history.insert(sample(taken));
            history.insert(Sample {
                observation: Observation::StaticPressure(1e5),
                ..sample(taken)
            });
        }
        history.pop(Time::from_nanos(1));
        history.remove(ObservationKind::StaticPressure);
        let left = history.after(0).map(|sample| sample.taken.as_nanos());
        assert!(left.eq([2, 3, 4, 5]));
    }

    #[test]
    fn a_full_history_gives_its_oldest_and_refuses_more() {
        let mut history = History::new();
        assert!((0..1_024).all(|taken| history.insert(sample(taken))));
        assert!(!history.insert(sample(2_000)));
        let oldest = history.pop(Time::from_nanos(-1)).unwrap();
        assert_eq!(oldest.taken, Time::from_nanos(0));
    }
}

//! Samples of an inertial sensor that no motion makes: a single one, far from both beside
//! it, as a bus under interference gives.

use nalgebra::Vector3;

use super::history::{History, Sample};
use crate::inertial::Observation;

/// As a multiple of how far its neighbours are from each other.
const BESIDE: f64 = 3.0;
/// So many samples are averaged; if more than this share of them are far from their
/// neighbours it is vibration, of which no half is left out.
const SAMPLES: f64 = 200.0;
const SELDOM: f64 = 0.05;
/// What lasts longer may be a motion: from the sample before to the one after, s.
const LONGEST_S: f64 = 0.03;
/// Samples of other sensors may come between two of one.
const LOOKED_AT: usize = 16;

/// Finds single samples of one inertial sensor that no motion makes.
#[derive(Clone, Copy, Debug)]
pub struct Spikes {
    /// How far from both neighbours.
    far: f64,
    /// Of the samples, those that are.
    share: f64,
}

impl Spikes {
    /// Of an accelerometer: beyond what one sample of vibration or of a touch-down weighs,
    /// 40 m/s².
    pub const OF_FORCE: Self = Self {
        far: 40.0,
        share: 0.0,
    };
    /// Of gyroscopes: 5 rad/s.
    pub const OF_RATES: Self = Self {
        far: 5.0,
        share: 0.0,
    };

    /// Whether a sample is one, by those before and after it, which are `span_s` apart. Call
    /// it for each in turn. Of what is sampled at less than 67 Hz none is.
    pub fn is_one(
        &mut self,
        before: [f64; 3],
        here: [f64; 3],
        after: [f64; 3],
        span_s: f64,
    ) -> bool {
        let [before, here, after] = [before, here, after].map(Vector3::from);
        let off = (here - before).norm().min((here - after).norm());
        let is_far =
            span_s <= LONGEST_S && off > self.far && off > BESIDE * (after - before).norm();
        self.share += (f64::from(u8::from(is_far)) - self.share) / SAMPLES;
        is_far && self.share < SELDOM
    }

    /// Puts the middle of its neighbours in the place of the latest sample of this sensor, if
    /// it is one; the next has just come.
    pub(super) fn replace(&mut self, history: &mut History, next: &Sample) {
        let kind = next.observation.kind();
        let mut latest = history.latest(LOOKED_AT, kind);
        let (Some((at, spike)), Some((_, before))) = (latest.next(), latest.next()) else {
            return;
        };
        drop(latest);
        let span_s = next.taken.since(before.taken).as_secs_f64();
        let all = [&before, &spike, next].map(|sample| vector(sample.observation));
        let [Some(before), Some(here), Some(after)] = all else {
            return;
        };
        if spike.taken < next.taken && self.is_one(before, here, after, span_s) {
            let middle = [0, 1, 2].map(|axis| 0.5 * (before[axis] + after[axis]));
            let observation = match spike.observation {
                Observation::SpecificForce(_) => Observation::SpecificForce(middle),
                _ => Observation::Rates(middle),
            };
            history.set(
                at,
                Sample {
                    observation,
                    ..spike
                },
            );
        }
    }
}

fn vector(observation: Observation) -> Option<[f64; 3]> {
    match observation {
        Observation::SpecificForce(vector) | Observation::Rates(vector) => Some(vector),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_sample_is_one_and_neither_a_step_nor_vibration() {
        let still = [0.0, 0.0, -9.8];
        let hit = [150.0, 0.0, -9.8];
        let (mut force, mut rates) = (Spikes::OF_FORCE, Spikes::OF_RATES);
        assert!(force.is_one(still, hit, still, 0.02));
        assert!(!force.is_one(still, hit, hit, 0.02));
        assert!(!force.is_one(still, [30.0, 0.0, -9.8], still, 0.02));
        assert!(!rates.is_one([0.0; 3], [3.0, 0.0, 0.0], [0.0; 3], 0.02));
        assert!(rates.is_one([0.0; 3], [9.0, 0.0, 0.0], [0.0; 3], 0.02));
        // At 10 Hz a hand can turn as fast as that.
        assert!(!rates.is_one([0.0; 3], [9.0, 0.0, 0.0], [0.0; 3], 0.2));
        // 1 % of the samples are found, each; of every other one few.
        let found = |every: u32| {
            let mut spikes = Spikes::OF_FORCE;
            let is_hit = |at: u32| at.is_multiple_of(every);
            let shown = |at: u32| if is_hit(at) { hit } else { still };
            (1..10_000)
                .filter(|&at| spikes.is_one(shown(at - 1), shown(at), shown(at + 1), 0.02))
                .count()
        };
        assert_eq!(found(100), 99);
        assert!(found(2) < 20, "{}", found(2));
    }
}

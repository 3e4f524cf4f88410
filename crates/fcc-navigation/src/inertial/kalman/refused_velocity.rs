//! Velocities of a receiver that are not used: its own places, or air and compass, contradict
//! them.

use nalgebra::Vector3;

use super::filter::{Filter, WIND};
use super::parameters as p;
use fcc_core::framework::Time;

impl Filter {
    /// Whether the receiver's velocities are not used because its own places, or air and
    /// compass, contradict them.
    pub(super) fn refuses_velocity(&self) -> bool {
        self.displacement.is_velocity_wrong || self.is_contradicted(self.time)
    }

    /// Whether the receiver's velocity is another one than airspeed, compass and the wind so far
    /// make, by more than a wind can have changed, and became that in no time.
    pub(super) fn contradicts_air(&self, (before, was): (Time, Vector3<f64>)) -> bool {
        let (taken, velocity) = self.receiver;
        let passed_s = taken.since(before).as_secs_f64();
        let jumped = (velocity - was).norm() > p::OTHER_WIND.max(p::JUMP * passed_s);
        let agree = [self.tracks.airspeed, self.tracks.field]
            .iter()
            .all(|track| track.since_used_s(taken) < p::AGREE_S);
        let wind = self.sigma(WIND).max(self.sigma(WIND + 1));
        let off = (velocity - self.motion.velocity).xy().norm();
        (jumped || self.is_contradicted(taken))
            && agree
            && off > p::OTHER_WIND.max(p::OTHER_WINDS * wind)
    }

    /// Whether a receiver contradicted the air lately.
    pub(super) fn is_contradicted(&self, now: Time) -> bool {
        now.since(self.contradicted).as_secs_f64() < p::CONTRADICTED_S
    }
}

//! Velocities of a receiver that are not used: its own places, or air and compass, contradict
//! them.

use nalgebra::Vector3;

use super::filter::Filter;
use super::parameters as p;
use super::receiver::DOUBTED_ATTITUDE;
use super::states::{ATTITUDE, POSITION, VELOCITY, WIND};
use fcc_core::framework::Time;

/// Places that contradict a velocity within this time, s, after it was taken for the filter's own
/// show that it misled this.
const MISLED_S: f64 = 4.0;

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

    /// Follows whether the receiver's velocities are wrong and its positions are not: they
    /// contradict each other, and this filter refuses the velocities only.
    pub(super) fn follow_displacement(
        &mut self,
        taken: Time,
        velocity: Vector3<f64>,
        contradicts_air: bool,
    ) {
        let (position, tracked) = (self.tracks.position, self.tracks.velocity);
        let was = self.displacement.is_contradicted;
        let contradicts = self.displacement.contradicts(&self.motion, taken, velocity);
        let followed_s = taken.since(self.taken_over).as_secs_f64();
        if contradicts && !was && followed_s < MISLED_S {
            self.displacement.is_velocity_wrong = true;
            let faster = self.displacement.faster(followed_s);
            let off = (velocity - self.motion.velocity).xy() + faster;
            self.settle();
            self.motion.velocity += off.push(0.0);
            self.path.corrected(Vector3::zeros(), off.push(0.0));
            self.reset_covariance(VELOCITY, 2, faster.norm_squared());
            self.add_variance(POSITION, 2, faster.norm_squared());
            self.add_variance(ATTITUDE, 3, DOUBTED_ATTITUDE);
        } else if !contradicts || position.refused_s(taken) > p::RECEIVER_REFUSED_S {
            if self.displacement.is_velocity_wrong {
                // It is judged anew.
                self.tracks.velocity.refused_since = Time::NEVER;
            }
            self.displacement.is_velocity_wrong = false;
        } else if position.refused_since.is_never() {
            self.displacement.is_velocity_wrong |=
                contradicts_air || !tracked.refused_since.is_never();
        }
    }
}

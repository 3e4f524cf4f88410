//! What is known without a receiver and without airspeed: velocities end, and
//! what stands still stands still.

use nalgebra::Vector3;

use super::filter::Filter;
use super::noise::Noise;
use super::parameters as p;
use super::receiver::on;
use super::states::{RATE_BIAS, VELOCITY};
use super::update::{Corrects, Measurement};
use fcc_core::framework::Time;

/// How often, s.
const INTERVAL_S: f64 = 0.1;

impl Filter {
    /// The velocity of something that nothing is known of is zero on average:
    /// what a hand moves returns. So the mean of the specific force is gravity,
    /// over a time that follows from how fast it moves: a velocity of V lasts
    /// V over a typical acceleration. What has an airspeed sensor is no hand: it
    /// may take off, and below the sensor's least airspeed it may be that fast.
    pub(super) fn velocity_ends(&mut self, now: Time) {
        if self.is_aided() || self.tracks.unaided.since_tried_s(now) < INTERVAL_S {
            return;
        }
        let each_axis = libm::sqrt(0.5 * self.mean_square_velocity);
        let is_aircraft = now.since(self.tracks.airspeed_heard).as_secs_f64() < p::UNAIDED_S;
        let least = if is_aircraft {
            p::LEAST_AIRSPEED
        } else {
            p::HAND_VELOCITY
        };
        let sigma = each_axis.clamp(least, p::LARGEST_VELOCITY);
        let noise = Noise::new(sigma, sigma / p::TYPICAL_ACCELERATION);
        self.settle();
        let since_s = self.tracks.unaided.since_tried_s(now);
        let measurement = on(VELOCITY, -self.motion.velocity, [noise; 3], since_s);
        self.correct(&measurement, self.corrected_by_rest());
        self.tracks.unaided.judged(now, true);
    }

    /// Standing still for `still_s`: the gyroscopes, averaged, show their bias,
    /// and there is no velocity. Neither is believed against what is known well,
    /// but for a velocity that nothing confirms for long.
    pub(super) fn stands_still(&mut self, now: Time, rates: Vector3<f64>, still_s: f64) {
        /// Nothing accelerates as steadily for this long, s.
        const BEYOND_DOUBT_S: f64 = 10.0;
        let since_s = self.tracks.rest.since_tried_s(now);
        if since_s < INTERVAL_S {
            return;
        }
        self.settle();
        let bias = on(
            RATE_BIAS,
            rates - self.rate_bias,
            [p::REST_RATE; 3],
            since_s,
        );
        let velocity = on(
            VELOCITY,
            -self.motion.velocity,
            [p::REST_VELOCITY; 3],
            since_s,
        );
        let is_plausible = self.distance(&bias) <= p::GATE
            && (self.distance(&velocity) <= p::GATE || still_s > BEYOND_DOUBT_S);
        if is_plausible {
            let corrects = self.corrected_by_rest();
            self.correct(&bias, corrects);
            let difference = -self.motion.velocity;
            self.correct(
                &Measurement {
                    difference,
                    ..velocity
                },
                corrects,
            );
        }
        self.tracks.rest.judged(now, is_plausible);
    }

    /// No rest tells a heading.
    fn corrected_by_rest(&self) -> Corrects {
        if self.has_heading() {
            Corrects::All
        } else {
            Corrects::AllButHeading
        }
    }

    /// Whether it stands still.
    pub(super) fn stands(&self) -> bool {
        self.tracks.rest.since_used_s(self.time) < 1.0
    }

    /// Whether a receiver or an airspeed sensor says how fast this is.
    pub(super) fn is_aided(&self) -> bool {
        self.has_receiver() || self.flies()
    }

    /// Whether there is an airspeed of something that flies.
    pub(super) fn flies(&self) -> bool {
        self.tracks.airspeed.since_used_s(self.time) < p::UNAIDED_S
    }

    /// Whether it moves, and a moment ago was slower than anything flies.
    pub(super) fn begins_to_fly(&mut self) -> bool {
        let is_measured = self.tracks.velocity.since_used_s(self.time) < p::UNAIDED_S;
        if self.stands() || is_measured && self.speed() < p::LEAST_AIRSPEED {
            self.slow = self.time;
        }
        self.is_moving() && self.time.since(self.slow).as_secs_f64() < p::BEGINS_S
    }

    /// What is taken for standing has no velocity in the filter, whatever a receiver says.
    fn speed(&self) -> f64 {
        self.receiver.1.norm().max(self.motion.velocity.norm())
    }

    /// Whether a receiver or an airspeed sensor says that this moves.
    pub(super) fn is_moving(&self) -> bool {
        /// Beyond the noise of a receiver at rest, m/s.
        const MOVING_MPS: f64 = 1.0;
        self.flies() || (self.has_receiver() && self.speed() > MOVING_MPS)
    }
}

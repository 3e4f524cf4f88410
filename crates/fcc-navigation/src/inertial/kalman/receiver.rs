//! Positions and velocities of a satellite receiver.

use nalgebra::{SMatrix, Vector3};

use super::earlier;
use super::filter::Filter;
use super::noise::{Noise, variances};
use super::parameters as p;
use super::path::Path;
use super::states::{
    ATTITUDE, BAROMETER_BIAS, FORCE_BIAS, LATENESS, POSITION, RATE_BIAS, STATES, VELOCITY,
};
use super::update::{Corrects, Measurement};
use crate::inertial::{GeodeticPosition, ObservationKind};
use fcc_core::framework::Time;

/// A velocity that was refused for seconds may mean a wrong attitude: at most so
/// wrong, rad².
pub(super) const DOUBTED_ATTITUDE: f64 = 0.03;
/// It took this time at least to make such a velocity, s.
const LEAST_TILTED_S: f64 = 1.0;

/// A heading less certain than this is none, rad.
pub(super) const UNKNOWN_HEADING: f64 = 0.7;
/// The variance of a vertical velocity that is not measured, (m/s)².
const UNKNOWN_DOWN: f64 = 1e6;
/// A course says where the nose points from this speed on, m/s, and how far that
/// is from it, rad².
const MOVING_MPS: f64 = 5.0;
const CRAB: f64 = 0.15;

impl Filter {
    /// A position, taken `after_s` after the time of the state.
    pub(super) fn position(&mut self, taken: Time, place: GeodeticPosition, after_s: f64) {
        let (horizontal, vertical) = (p::POSITION_HORIZONTAL, p::POSITION_VERTICAL);
        self.displacement.take_place(taken, place);
        if self.is_contradicted(taken) {
            return;
        }
        if !self.motion.is_located {
            self.settle();
            self.locate(place);
            self.tracks.position.judged(taken, true);
            return;
        }
        let seen = self.seen(taken, place, after_s);
        let difference = seen.difference;
        let since_s = self.tracks.position.since_tried_s(taken);
        let mut measurement = on(
            POSITION,
            difference,
            [horizontal, horizontal, vertical],
            since_s,
        );
        measurement.come_late(-seen.velocity * self.shows_lateness(taken));
        measurement.excess *= self.late_excess();
        if self.fuse(
            ObservationKind::Position,
            taken,
            &measurement,
            p::GATE,
            self.corrected_by_fix(taken),
        ) {
            let shows_heading = !self.has_heading()
                && self.tracks.velocity.since_used_s(taken) > p::UNAIDED_S
                && self.motion.velocity.xy().norm() > MOVING_MPS;
            if shows_heading {
                self.take_heading_from_course();
            }
            return;
        }
        if self.tracks.position.refused_s(taken) >= p::RECEIVER_REFUSED_S {
            self.motion.shift(difference);
            self.path.corrected(difference, Vector3::zeros());
            self.forget(POSITION, &measurement);
            self.tracks.position.judged(taken, true);
        }
    }

    /// The first position: altitude is the receiver's from here on, and the
    /// barometer's difference to it becomes its bias.
    fn locate(&mut self, place: GeodeticPosition) {
        let climbed = place.altitude_m - self.motion.place.altitude_m;
        self.motion.place = place;
        self.motion.is_located = true;
        self.path = Path::new();
        let (horizontal, vertical) = (p::POSITION_HORIZONTAL, p::POSITION_VERTICAL);
        let noises = [horizontal, horizontal, vertical];
        let mut measurement = on(POSITION, Vector3::zeros(), noises, 0.0);
        measurement.come_late(-self.motion.velocity);
        self.forget(POSITION, &measurement);
        if !self.tracks.barometer.used.is_never() {
            self.barometer_bias -= climbed;
            self.take_barometer_bias_from_altitude();
        }
    }

    /// The barometer's bias is the difference of what it shows from the altitude,
    /// and as uncertain as both.
    pub(super) fn take_barometer_bias_from_altitude(&mut self) {
        let mut row = self.covariance.row(POSITION + 2).into_owned();
        let variance = row[POSITION + 2] + p::BAROMETER.variance();
        row[BAROMETER_BIAS] = variance;
        self.covariance.set_row(BAROMETER_BIAS, &row);
        self.covariance.set_column(BAROMETER_BIAS, &row.transpose());
    }

    /// A velocity over the ground, taken `after_s` after the time of the state.
    pub(super) fn velocity(&mut self, taken: Time, velocity: [f64; 3], after_s: f64) {
        let was_used = self.tracks.velocity.used;
        self.take_velocity(taken, velocity, after_s);
        if was_used.is_never() && !self.tracks.velocity.used.is_never() && self.motion.is_located {
            // It was located before it was known how it moves.
            self.settle();
            self.locate(self.motion.place);
        }
    }

    /// A velocity with the vertical one that is believed where it is not measured, and the
    /// variance of that.
    fn with_down(&self, [north, east, down]: [f64; 3]) -> (Vector3<f64>, f64) {
        if down.is_nan() {
            (
                Vector3::new(north, east, self.motion.velocity.z),
                UNKNOWN_DOWN,
            )
        } else {
            (Vector3::new(north, east, down), 0.0)
        }
    }

    fn take_velocity(&mut self, taken: Time, velocity: [f64; 3], after_s: f64) {
        let (velocity, vertical_variance) = self.with_down(velocity);
        let before = core::mem::replace(&mut self.receiver, (taken, velocity));
        let contradicts_air = self.contradicts_air(before);
        self.follow_displacement(taken, velocity, contradicts_air);
        if contradicts_air && !self.displacement.is_velocity_wrong {
            self.contradicted = taken;
            self.tracks.velocity.judged(taken, false);
            return;
        }
        if !self.displacement.is_velocity_wrong && self.align_in_flight(taken, velocity) {
            self.tracks.velocity.judged(taken, true);
            return;
        }
        let (horizontal, vertical) = (p::VELOCITY_HORIZONTAL, p::VELOCITY_VERTICAL);
        let since_s = self.tracks.velocity.since_tried_s(taken);
        let noises = [horizontal, horizontal, vertical];
        let place = self.motion.place;
        let seen = self.seen(taken, place, after_s);
        let difference = velocity - seen.velocity;
        let mut measurement = on(VELOCITY, difference, noises, since_s);
        let variance = horizontal.variance();
        let tilt = self.sigma(ATTITUDE).max(self.sigma(ATTITUDE + 1));
        let scatter = if tilt < p::SCATTER_TILT && self.is_calm(taken) {
            self.scatter.variance(taken, difference, variance)
        } else {
            variance
        };
        measurement.variance *= scatter / variance;
        measurement.variance.z += vertical_variance;
        measurement.come_late(-seen.acceleration * self.shows_lateness(taken));
        measurement.excess *= self.late_excess();
        let has_heading = self.has_heading();
        // Of a heading that is not known, what accelerated since the last fix went anywhere.
        let shows_heading = !has_heading && velocity.xy().norm() > MOVING_MPS;
        let is_first = shows_heading
            || self.tracks.velocity.used.is_never()
                && (self.tracks.airspeed.used.is_never() || !has_heading);
        if is_first {
            self.settle();
        } else if self.fuse(
            ObservationKind::Velocity,
            taken,
            &measurement,
            if self.displacement.is_velocity_wrong {
                0.0
            } else {
                p::GATE
            },
            self.corrected_by_fix(taken),
        ) {
            self.trend.add(taken, difference.xy(), scatter);
            return;
        }
        // What went in one direction before is an error of this filter, and not of a receiver.
        let leads = !self.is_compared
            && self.sigma(ATTITUDE + 2) < p::TREND_HEADING
            && self.trend.leads_to(difference.xy());
        let needed_s = if leads {
            p::TREND_REFUSED_S
        } else {
            p::RECEIVER_REFUSED_S
        };
        let is_against = self.displacement.is_velocity_wrong
            || self.tracks.position.refused_since.is_never()
                && self.displacement.is_against(difference.xy());
        if is_first || !is_against && self.tracks.velocity.refused_s(taken) >= needed_s {
            self.motion.velocity += difference;
            self.path.corrected(Vector3::zeros(), difference);
            self.forget(VELOCITY, &measurement);
            if !is_first {
                self.taken_over = taken;
                // One that is wrong by so much has turned gravity into this velocity. What
                // is off downwards, and as much beside it, is no attitude's error: it is of
                // an accelerometer at the end of its range, in a bank of 45° at most.
                let sideways = (difference.xy().norm() - difference.z.abs()).max(0.0);
                let tilt = sideways / (self.motion.gravity().z * needed_s.max(LEAST_TILTED_S));
                let tilt = (tilt * tilt).min(DOUBTED_ATTITUDE);
                self.add_variance(ATTITUDE, 3, tilt);
                if leads {
                    self.add_variance(RATE_BIAS, 3, p::TREND_RATE * tilt);
                }
                // Or an accelerometer is off by as much.
                let off = sideways / p::RECEIVER_REFUSED_S;
                self.add_variance(FORCE_BIAS, 2, off * off);
            }
            self.tracks.velocity.judged(taken, true);
        }
        if shows_heading {
            self.take_heading_from_course();
        }
    }

    /// What a fix is compared with, that was taken `after_s` after the time of the state and
    /// comes as much later as is estimated.
    fn seen(&self, taken: Time, place: GeodeticPosition, after_s: f64) -> Seen {
        /// The state of the latest moment can be moved back by this, s.
        const MOMENT_S: f64 = 0.1;
        let after_s = after_s - self.late_s;
        let known = if after_s < -MOMENT_S {
            self.path
                .then(&self.motion, earlier(taken, self.late_s), place)
        } else {
            None
        };
        known.map_or_else(
            || Seen {
                difference: self.motion.to_place(place) - self.motion.velocity * after_s,
                velocity: self.motion.velocity + self.acceleration * after_s,
                acceleration: self.path.acceleration(self.time, &self.motion),
            },
            |[difference, velocity, acceleration]| Seen {
                difference,
                velocity,
                acceleration,
            },
        )
    }

    /// The share of what a fix shows of its lateness that is taken for that: none while an
    /// accelerometer may be at the end of its range, which looks the same.
    fn shows_lateness(&self, now: Time) -> f64 {
        f64::from(u8::from(self.is_calm(now)))
    }

    fn is_calm(&self, now: Time) -> bool {
        now.since(self.rough).as_secs_f64() > p::CALM_S
    }

    /// What begins to move may be held for standing, which looks like fixes that come early.
    fn corrected_by_fix(&self, now: Time) -> Corrects {
        if !self.has_heading() {
            Corrects::AllButHeading
        } else if now.since(self.tracks.rest.used).as_secs_f64() > p::UNDER_WAY_S {
            Corrects::All
        } else {
            Corrects::AllButLateness
        }
    }

    /// By how much the variance of a fix is larger: the present error is not that of its time,
    /// and what is corrected shows only after this.
    fn late_excess(&self) -> f64 {
        1.0 + self.late_s * self.late_s
    }

    pub(super) fn has_heading(&self) -> bool {
        self.sigma(ATTITUDE + 2) < UNKNOWN_HEADING
    }

    /// Without a compass: most of what moves, moves ahead.
    fn take_heading_from_course(&mut self) {
        let (course, nose) = (self.motion.velocity, self.rotation().column(0).into_owned());
        let across = nose.x * course.y - nose.y * course.x;
        let along = nose.x * course.x + nose.y * course.y;
        self.turn_heading(libm::atan2(across, along));
        self.reset_covariance(ATTITUDE + 2, 1, CRAB);
        // What was correlated with the heading that it had is not known either.
        self.forget_wind();
    }

    /// Three states are as measured from here on: as uncertain as that, and wrong by as much
    /// as it comes later than is believed.
    fn forget(&mut self, at: usize, measurement: &Measurement<3>) {
        for axis in 0..3 {
            self.reset_covariance(at + axis, 1, measurement.variance[axis]);
        }
        let by_lateness = measurement.jacobian.column(LATENESS).into_owned();
        let (mut lateness, variance) = (
            self.covariance.row(LATENESS).into_owned(),
            self.covariance[(LATENESS, LATENESS)],
        );
        for axis in 0..3 {
            lateness[at + axis] = -by_lateness[axis] * variance;
        }
        for axis in 0..3 {
            let mut row = lateness * -by_lateness[axis];
            row[at + axis] += measurement.variance[axis];
            self.covariance.set_row(at + axis, &row);
            self.covariance.set_column(at + axis, &row.transpose());
        }
    }

    /// Whether a receiver has said lately how this moves.
    pub(super) fn has_receiver(&self) -> bool {
        self.tracks.velocity.since_used_s(self.time) < p::UNAIDED_S
            || self.tracks.position.since_used_s(self.time) < p::UNAIDED_S
    }
}

/// What a fix is compared with.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// How far its place is from where this was, m.
    difference: Vector3<f64>,
    /// How this moved then, m/s, m/s².
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
}

impl Measurement<3> {
    /// What is measured changes by so much with each second that it comes later.
    fn come_late(&mut self, by: Vector3<f64>) {
        self.jacobian.set_column(LATENESS, &by);
    }
}

/// A measurement of three states themselves.
pub(super) fn on(
    at: usize,
    difference: Vector3<f64>,
    noises: [Noise; 3],
    since_s: f64,
) -> Measurement<3> {
    let mut jacobian = SMatrix::<f64, 3, STATES>::zeros();
    for axis in 0..3 {
        jacobian[(axis, at + axis)] = 1.0;
    }
    Measurement {
        difference,
        jacobian,
        variance: variances(noises),
        excess: Vector3::from(noises.map(|noise| noise.excess(since_s))),
    }
}

//! What a satellite receiver says of the gyroscopes where the magnetic field contradicts
//! them.
//!
//! Gyroscopes that are wrong tip the horizon, or in a turn the heading, and gravity or the
//! force of the turn becomes a velocity that the receiver does not show: the filter's
//! innovations go one way. In straight flight a wrong turn about the vertical does not do
//! that, but the course through the air turns as the nose does.

use libm::atan2;
use nalgebra::{UnitQuaternion, Vector2, Vector3};

use super::kalman::{GAP_S, Innovation};
use super::{ObservationKind, Solution};
use fcc_core::blocks::{smoothing_factor, wrap_pi};
use fcc_core::framework::Time;

/// Innovations of the velocity are averaged over this time, s, and beyond this, m/s, their
/// mean contradicts: 12° of tilt make it within 0.3 s. Without a fault it is below half of this
/// for 99 % of the time, in turbulence 5 (flights of JSBSim).
const INNOVATIONS_S: f64 = 0.3;
const CONTRADICTS_MPS: f64 = 0.4;
/// The course less the turn of the gyroscopes is compared with its mean of this time, s, and
/// beyond this, rad (10°), it contradicts: a gust from the side of 9 m/s at 50 m/s.
const COURSE_S: f64 = 5.0;
const CONTRADICTS_RAD: f64 = 0.17;
/// Slower through the air, m/s, there is no course.
const COURSE_MPS: f64 = 15.0;
/// It was so within this time, s: the filter follows the receiver, and does not differ any more
/// when the field has shown enough.
const LATELY_S: f64 = 2.5;
/// A receiver or a magnetometer that was not heard for this time, s, says nothing.
pub(super) const SILENT_S: f64 = 1.0;

/// Compares the gyroscopes with a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceiverWitness {
    innovation: Vector2<f64>,
    heard: Time,
    contradicted: Time,
    /// What the gyroscopes have turned about the vertical, rad.
    turned_rad: f64,
    rates_taken: Time,
    /// The mean of the course less that, and by how much the latest one differs, rad.
    course_rad: f64,
    off_rad: f64,
    course_taken: Time,
}

impl ReceiverWitness {
    pub(super) const fn new() -> Self {
        Self {
            innovation: Vector2::new(0.0, 0.0),
            heard: Time::NEVER,
            contradicted: Time::NEVER,
            turned_rad: 0.0,
            rates_taken: Time::NEVER,
            course_rad: 0.0,
            off_rad: 0.0,
            course_taken: Time::NEVER,
        }
    }

    /// Whether the receiver agrees with the gyroscopes; `None` if it says nothing.
    pub(super) fn agrees(&self, now: Time) -> Option<bool> {
        (now.since(self.heard).as_secs_f64() < SILENT_S)
            .then(|| now.since(self.contradicted).as_secs_f64() > LATELY_S)
    }

    /// Takes a sample of the gyroscopes without their bias, rad/s, and the attitude.
    pub(super) fn add_rates(&mut self, taken: Time, rates: Vector3<f64>, known: &Solution) {
        let dt_s = taken.since(self.rates_taken).as_secs_f64();
        self.rates_taken = taken;
        let [w, x, y, z] = known.quaternion;
        let to_earth = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let turned = (to_earth * rates).z * dt_s;
        if dt_s > GAP_S || !turned.is_finite() {
            self.course_taken = Time::NEVER;
        } else {
            self.turned_rad += turned;
        }
    }

    /// Takes a velocity of the receiver, m/s, and the wind.
    pub(super) fn add_velocity(&mut self, taken: Time, velocity: [f64; 3], known: &Solution) {
        let [north, east, _] = velocity;
        let through_air = Vector2::new(north, east) - Vector2::from(known.wind_mps);
        let is_first = self.course_taken.is_never();
        let has_course = through_air.norm() > COURSE_MPS;
        if !has_course {
            self.course_taken = Time::NEVER;
            self.off_rad = 0.0;
            return;
        }
        let share = smoothing_factor(taken.since(self.course_taken).as_secs_f64(), COURSE_S);
        self.course_taken = taken;
        let course_rad = atan2(through_air.y, through_air.x) - self.turned_rad;
        self.off_rad = wrap_pi(course_rad - self.course_rad);
        self.course_rad += if is_first {
            self.off_rad
        } else {
            share * self.off_rad
        };
        if is_first {
            self.off_rad = 0.0;
        }
    }

    /// Takes what the measurements of a step differed by from what was expected of them.
    pub(super) fn add_innovations(&mut self, innovations: &[Innovation]) {
        for of in innovations {
            if of.kind != ObservationKind::Velocity {
                continue;
            }
            let [north, east, _] = of.difference;
            let since_s = of.time.since(self.heard).as_secs_f64();
            let share = smoothing_factor(since_s, INNOVATIONS_S);
            self.innovation += (Vector2::new(north, east) - self.innovation) * share;
            self.heard = of.time;
            if self.innovation.norm() > CONTRADICTS_MPS || self.off_rad.abs() > CONTRADICTS_RAD {
                self.contradicted = of.time;
            }
        }
    }
}

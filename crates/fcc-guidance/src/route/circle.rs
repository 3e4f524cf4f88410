//! A loiter: how far around, how long, and where it is left.

use libm::atan2;
use nalgebra::Vector2;

use super::step::Until;
use crate::path::{Path, cross, length};
use fcc_core::blocks::wrap_pi;

/// A circle around the origin of a plane.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Circle {
    pub(super) radius_m: f64,
    pub(super) clockwise: bool,
    pub(super) until: Until,
    pub(super) leave_towards_next: bool,
}

/// How far a circle was flown.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Circling {
    turned_rad: f64,
    elapsed_s: f64,
    /// The direction from the centre, rad, when it was last seen.
    last_rad: Option<f64>,
}

/// The aircraft is on a circle within this share of its radius and so far more, m.
const ON_SHARE: f64 = 0.2;
const ON_M: f64 = 100.0;
/// An altitude is reached within this, m.
const REACHED_M: f64 = 5.0;
/// The least angle ahead in which the direction of leaving is found, rad: more than a
/// tick turns.
const LEAST_AHEAD_RAD: f64 = 0.03;

impl Circle {
    pub(super) fn path(&self) -> Path {
        Path::Circle {
            centre_m: Vector2::zeros(),
            radius_m: self.radius_m,
            clockwise: self.clockwise,
        }
    }

    /// Whether it is to be left: its end is reached, and, where that matters, the way
    /// to the next place is at most `ahead_m` ahead.
    pub(super) fn is_over(
        &self,
        flown: &Circling,
        off_altitude_m: f64,
        position_m: Vector2<f64>,
        next_m: Option<Vector2<f64>>,
        ahead_m: f64,
    ) -> bool {
        let is_done = match self.until {
            Until::Never => false,
            Until::Turned(angle) => flown.turned_rad >= angle,
            Until::Elapsed(seconds) => flown.elapsed_s >= seconds,
            Until::AtAltitude => flown.last_rad.is_some() && off_altitude_m.abs() <= REACHED_M,
        };
        is_done
            && next_m
                .filter(|_| self.leave_towards_next)
                .is_none_or(|next| {
                    length(next) <= self.radius_m || self.points_at(next, position_m, ahead_m)
                })
    }

    fn points_at(&self, next_m: Vector2<f64>, position_m: Vector2<f64>, ahead_m: f64) -> bool {
        let course = self.path().nearest(position_m).course;
        let way = next_m - position_m;
        let right_rad = atan2(cross(course, way), course.dot(&way));
        let left_to_turn = if self.clockwise {
            right_rad
        } else {
            -right_rad
        };
        (0.0..(ahead_m / self.radius_m).max(LEAST_AHEAD_RAD)).contains(&left_to_turn)
    }
}

impl Circling {
    /// The aircraft is at a place in the plane of the circle, `dt_s` seconds after the
    /// last one.
    pub(super) fn follow(&mut self, circle: &Circle, position_m: Vector2<f64>, dt_s: f64) {
        let off_m = (length(position_m) - circle.radius_m).abs();
        if off_m > ON_SHARE * circle.radius_m + ON_M {
            self.last_rad = None;
            return;
        }
        let now_rad = atan2(position_m.y, position_m.x);
        let around = wrap_pi(now_rad - self.last_rad.unwrap_or(now_rad));
        self.turned_rad += if circle.clockwise { around } else { -around };
        self.elapsed_s += dt_s;
        self.last_rad = Some(now_rad);
    }
}

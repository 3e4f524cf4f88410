//! The pattern over a landing place: a circle over the key, downwind, the turn to the
//! final, and the final.
//!
//! ```text
//!              2R ───────────── low key ◄──┐    downwind, opposite to the landing
//!   turn (  )   R               (  circle  )    over the key
//!  final ────────────► aim ───────────────      the landing's line, to the aim
//!          -x                  0
//! ```
//!
//! All turns are to the same side, with the same radius R. The circle touches the line
//! over the aim, and is left at the low key. From there the way is as long as the height
//! wants it: the turn to the final begins where the rest of the way costs what is left.

use core::f64::consts::{PI, TAU};

use libm::{atan2, sin};
use nalgebra::Vector2;

use super::Glide;
use crate::blocks::wrap_pi;
use crate::flight::path::{Path, length, right_of, unit};
use crate::flight::route::leg::Leg;

/// The shortest final, m.
const LEAST_FINAL_M: f64 = 400.0;
/// The longest final takes up a full circle of height, and so much more, m.
const MORE_FINAL_M: f64 = 200.0;
/// An arc that is shorter than this by rounding is none, rad.
const LEAST_ARC_RAD: f64 = 0.15;
/// A way that leaves no more height than this fits it, m.
const MOST_LEFT_M: f64 = 15.0;
/// The length of the final is found to 1 / 2^n of its range.
const HALVINGS: u8 = 9;

/// A pattern in the plane of the aim.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Pattern {
    /// Of the landing; of length 1.
    pub(super) course: Vector2<f64>,
    pub(super) radius_m: f64,
    /// To the right of the landing's line, with turns to the right.
    pub(super) is_right: bool,
    /// How far before the plane's origin the glide leads to the ground, m: the flare carries
    /// the aircraft on.
    pub(super) float_m: f64,
}

/// What a path's height is computed with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Air {
    pub(super) glide: Glide,
    pub(super) wind_mps: Vector2<f64>,
}

fn course_rad(course: Vector2<f64>) -> f64 {
    atan2(course.y, course.x)
}

impl Pattern {
    const fn sign(&self) -> f64 {
        if self.is_right { 1.0 } else { -1.0 }
    }

    pub(super) const fn shortest_m(&self) -> f64 {
        LEAST_FINAL_M.max(self.radius_m)
    }

    pub(super) fn longest_m(&self) -> f64 {
        self.shortest_m() + PI * self.radius_m + MORE_FINAL_M
    }

    /// The centre of the turn onto a final of this length, m; of 0, of the circle over the
    /// key.
    pub(super) fn centre_m(&self, final_m: f64) -> Vector2<f64> {
        let before_m = final_m + self.float_m;
        right_of(self.course) * (self.sign() * self.radius_m) - self.course * before_m
    }

    pub(super) fn circle(&self, final_m: f64) -> Path {
        Path::Circle {
            centre_m: self.centre_m(final_m),
            radius_m: self.radius_m,
            clockwise: self.is_right,
        }
    }

    /// The line opposite to the landing.
    pub(super) fn downwind(&self) -> Path {
        Path::Line {
            through_m: right_of(self.course) * (2.0 * self.sign() * self.radius_m),
            course: -self.course,
        }
    }

    /// The line of the landing.
    pub(super) fn landing(&self) -> Path {
        Path::Line {
            through_m: Vector2::zeros(),
            course: self.course,
        }
    }

    /// How far before where the glide leads a place is, m along the line.
    pub(super) fn before_m(&self, position_m: Vector2<f64>) -> f64 {
        -self.course.dot(&position_m) - self.float_m
    }

    /// The direction in which the glide leads to the ground, from a place.
    pub(super) fn aim_from(&self, at_m: Vector2<f64>) -> Vector2<f64> {
        course_of(-self.course * self.float_m - at_m)
    }

    /// How far the circle has to be flown from one course to another, rad.
    fn around_rad(&self, from: Vector2<f64>, to: Vector2<f64>) -> f64 {
        let left = self.sign() * (course_rad(to) - course_rad(from));
        let left = left - TAU * libm::floor(left / TAU);
        if left > TAU - LEAST_ARC_RAD {
            0.0
        } else {
            left
        }
    }

    /// How far it is on a circle to a course, rad.
    pub(super) fn left_rad(&self, final_m: f64, position_m: Vector2<f64>, to: Vector2<f64>) -> f64 {
        let course = self.circle(final_m).nearest(position_m).course;
        self.around_rad(course, to)
    }

    fn arc_m(&self, from: Vector2<f64>, angle_rad: f64, air: &Air) -> f64 {
        let through = self.sign() * angle_rad;
        air.glide
            .arc_m(course_rad(from), through, self.radius_m, air.wind_mps)
    }

    /// The leg onto the turn to a final of this length; onto the circle over the key with 0.
    pub(super) fn leg(&self, from_m: Vector2<f64>, final_m: f64) -> Option<Leg> {
        Leg::to_circle(from_m, self.centre_m(final_m), self.radius_m, self.is_right)
    }

    /// What turning from a course onto a leg, and the leg, cost, m: a turn through Δ leads
    /// R sin Δ along the leg already.
    fn leg_cost_m(&self, from: Vector2<f64>, leg: &Leg, air: &Air) -> f64 {
        let (from_rad, to_rad) = (course_rad(from), course_rad(leg.course));
        let through_rad = wrap_pi(to_rad - from_rad);
        let turned_m = air
            .glide
            .arc_m(from_rad, through_rad, self.radius_m, air.wind_mps);
        let ahead_m = self.radius_m * sin(through_rad.abs());
        let way_m = (leg.length_m - ahead_m).max(0.0);
        turned_m + air.glide.straight_m(to_rad, way_m, air.wind_mps)
    }

    /// What the final costs, m.
    pub(super) fn final_cost_m(&self, final_m: f64, air: &Air) -> f64 {
        air.glide
            .straight_m(course_rad(self.course), final_m, air.wind_mps)
    }

    /// What the way from a place on a course costs, m, straight onto the turn to a final of
    /// this length.
    pub(super) fn direct_cost_m(
        &self,
        at_m: Vector2<f64>,
        course: Vector2<f64>,
        final_m: f64,
        air: &Air,
    ) -> f64 {
        let Some(leg) = self.leg(at_m, final_m) else {
            return f64::INFINITY;
        };
        let around_rad = self.around_rad(leg.course, self.course);
        self.leg_cost_m(course, &leg, air)
            + self.arc_m(leg.course, around_rad, air)
            + self.final_cost_m(final_m, air)
    }

    /// What the way by the circle over the key costs at least, m: to the low key, and with
    /// the shortest final.
    pub(super) fn key_cost_m(&self, at_m: Vector2<f64>, course: Vector2<f64>, air: &Air) -> f64 {
        let (onto, reached) = match self.leg(at_m, 0.0) {
            Some(leg) => (self.leg_cost_m(course, &leg, air), leg.course),
            None => (0.0, self.circle(0.0).nearest(at_m).course),
        };
        let around_rad = self.around_rad(reached, -self.course);
        onto + self.arc_m(reached, around_rad, air) + self.low_key_cost_m(0.0, air)
    }

    /// What the way costs from the downwind line, so far before the aim, m, with the final
    /// that begins there or, nearer, with the shortest one.
    pub(super) fn low_key_cost_m(&self, before_m: f64, air: &Air) -> f64 {
        let final_m = before_m.max(self.shortest_m());
        let back_rad = course_rad(-self.course);
        air.glide
            .straight_m(back_rad, final_m - before_m, air.wind_mps)
            + self.arc_m(-self.course, PI, air)
            + self.final_cost_m(final_m, air)
    }

    /// What a full circle costs, m.
    pub(super) fn circle_cost_m(&self, air: &Air) -> f64 {
        self.arc_m(self.course, TAU, air)
    }

    /// The length of the final with which the direct way costs this height, m: the shortest
    /// one if all cost more; none if no way costs it.
    pub(super) fn final_for_m(
        &self,
        height_m: f64,
        at_m: Vector2<f64>,
        course: Vector2<f64>,
        air: &Air,
    ) -> Option<f64> {
        let costs_m = |final_m: f64| self.direct_cost_m(at_m, course, final_m, air);
        let (mut short, mut long) = (self.shortest_m(), self.longest_m());
        if costs_m(short) >= height_m {
            return Some(short);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (short + long);
            if costs_m(middle) < height_m {
                short = middle;
            } else {
                long = middle;
            }
        }
        // Beyond the aircraft the way turns back, and costs far more.
        (costs_m(short) > height_m - MOST_LEFT_M).then_some(short)
    }
}

/// The course of a velocity.
pub(super) fn course_of(velocity_mps: Vector2<f64>) -> Vector2<f64> {
    unit(velocity_mps).unwrap_or(Vector2::new(1.0, 0.0))
}

/// Whether a wind, or another velocity, is one, and no noise.
pub(super) fn blows(wind_mps: Vector2<f64>) -> bool {
    /// m/s: 2 kt.
    const LEAST_WIND_MPS: f64 = 1.0;
    length(wind_mps) > LEAST_WIND_MPS
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Air = Air {
        // 30 m/s along the horizon, and 3 m/s down: 10 to 1.
        glide: Glide {
            true_airspeed_mps: 30.149_626,
            sink_mps: 3.0,
        },
        wind_mps: Vector2::new(0.0, 0.0),
    };

    fn north() -> Pattern {
        Pattern {
            course: Vector2::new(1.0, 0.0),
            radius_m: 300.0,
            is_right: true,
            float_m: 0.0,
        }
    }

    /// Bank for 300 m at 30 m/s: a/g = 900/300/9.80665 = 0.3059, and 1 + 0.3059²/2 = 1.0468
    /// times the sink.
    const TURNING: f64 = 1.046_8;

    /// From the low key 600 m east of the aim: 400 m south, half a circle of 942.5 m, 400 m
    /// north.
    #[test]
    fn the_way_from_the_low_key_costs_its_length() {
        let expected_m = (800.0 + TURNING * 942.48) / 10.0;
        let cost_m = north().low_key_cost_m(0.0, &STILL);
        assert!((cost_m - expected_m).abs() < 0.1, "{cost_m} {expected_m}");
        let by_key_m = north().key_cost_m(Vector2::new(0.0, 600.0), -north().course, &STILL);
        assert!((by_key_m - expected_m).abs() < 0.5, "{by_key_m}");
        let circle_m = north().circle_cost_m(&STILL);
        assert!((circle_m - TURNING * 188.5).abs() < 0.1, "{circle_m}");
    }

    /// From 5 km to the south, on the line, straight in: 500 m.
    #[test]
    fn straight_in_costs_the_distance() {
        for is_right in [true, false] {
            let pattern = Pattern {
                is_right,
                ..north()
            };
            let at_m = Vector2::new(-5_000.0, 0.0);
            let cost_m = pattern.direct_cost_m(at_m, pattern.course, 400.0, &STILL);
            assert!((cost_m - 500.0).abs() < 0.5, "{cost_m}");
        }
    }

    /// From abeam, flying against the landing, the final is as long as the height wants:
    /// 2 x m more for each metre.
    #[test]
    fn the_final_fits_the_height() {
        let at_m = Vector2::new(1_000.0, 600.0);
        let course = -north().course;
        for final_m in [500.0, 900.0, 1_300.0] {
            // 1,000 m and the final to the south, half a circle, the final.
            let height_m = (1_000.0 + 2.0 * final_m + TURNING * 942.48) / 10.0;
            let found_m = north().final_for_m(height_m, at_m, course, &STILL);
            assert!((found_m.unwrap() - final_m).abs() < 5.0, "{found_m:?}");
        }
        assert_eq!(north().final_for_m(1e4, at_m, course, &STILL), None);
        assert_eq!(north().final_for_m(10.0, at_m, course, &STILL), Some(400.0));
    }

    /// In wind from the south the final is a tail wind's, and costs less than the way
    /// against it.
    #[test]
    fn wind_moves_the_turn() {
        let air = Air {
            wind_mps: Vector2::new(-8.0, 0.0),
            ..STILL
        };
        // 400 m with 38 m/s, and back with 22 m/s.
        let straight_m = 3.0 * (400.0 / 38.0 + 400.0 / 22.0);
        let cost_m = north().low_key_cost_m(0.0, &air);
        let calm_m = north().low_key_cost_m(0.0, &STILL);
        assert!(cost_m > straight_m + 0.1 * 942.48 && cost_m > calm_m);
    }
}

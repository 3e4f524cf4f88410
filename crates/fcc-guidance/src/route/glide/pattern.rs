//! The pattern over a landing place: a circle over the key, downwind, the turn to the
//! final, and the final.
//!
//! ```text
//!      ╭──────────────────── low key ◄──┐     2R + B, downwind, opposite to the landing
//!      │                     (  circle  )     over the key
//!      │ base                                 B long
//!      ╰── final ───────────► aim             the landing's line, to the aim
//!               -x             0
//! ```
//!
//! All turns are to the same side, with the same radius R. The circle is left at the low
//! key, abeam the aim. From there the way is as long as the height wants it: the turn to
//! the base begins where the rest of the way costs what is left, and the base leads to a
//! final that is shorter or longer by what the air has made of it since. What is lost or
//! gained then, in the last quarter of a circle and on the final, is not made up for.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use libm::atan2;
use nalgebra::Vector2;

use super::Glide;
use crate::path::{Path, length, right_of, unit};
use crate::route::leg::Leg;
use fcc_core::blocks::wrap_pi;

/// The shortest final, m.
const LEAST_FINAL_M: f64 = 400.0;
/// The shortest one of the pattern leaves so much of it for a shorter way, m.
const SPARE_FINAL_M: f64 = 200.0;
/// The straight part of the base, m.
const BASE_M: f64 = 400.0;
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

    /// The shortest final of the way by the key, m.
    const fn planned_m(&self) -> f64 {
        self.shortest_m() + SPARE_FINAL_M
    }

    pub(super) fn longest_m(&self) -> f64 {
        self.planned_m() + PI * self.radius_m + MORE_FINAL_M
    }

    /// So far before the aim, m, and to the pattern's side.
    fn place_m(&self, before_m: f64, aside_m: f64) -> Vector2<f64> {
        let before_m = before_m + self.float_m;
        right_of(self.course) * (self.sign() * aside_m) - self.course * before_m
    }

    /// The centre of the turn onto a final of this length, m.
    fn turn_centre_m(&self, final_m: f64) -> Vector2<f64> {
        self.place_m(final_m, self.radius_m)
    }

    /// The centre of the circle over the key.
    fn key_centre_m(&self) -> Vector2<f64> {
        self.place_m(0.0, self.radius_m + BASE_M)
    }

    const fn circle(&self, centre_m: Vector2<f64>) -> Path {
        Path::Circle {
            centre_m,
            radius_m: self.radius_m,
            clockwise: self.is_right,
        }
    }

    /// The turn onto a final of this length, m.
    pub(super) fn turn(&self, final_m: f64) -> Path {
        self.circle(self.turn_centre_m(final_m))
    }

    /// The circle over the key.
    pub(super) fn key(&self) -> Path {
        self.circle(self.key_centre_m())
    }

    /// The line opposite to the landing.
    pub(super) fn downwind(&self) -> Path {
        Path::Line {
            through_m: self.place_m(0.0, 2.0 * self.radius_m + BASE_M),
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

    /// Away from the landing's line, to the pattern's side.
    pub(super) fn aside(&self) -> Vector2<f64> {
        right_of(self.course) * self.sign()
    }

    /// The circle of a turn that begins here.
    pub(super) fn circle_from(&self, at_m: Vector2<f64>, course: Vector2<f64>) -> Path {
        self.circle(at_m + right_of(course) * (self.sign() * self.radius_m))
    }

    /// How far the circle has to be flown from one course to another, rad.
    pub(super) fn around_rad(&self, from: Vector2<f64>, to: Vector2<f64>) -> f64 {
        let left = self.sign() * (course_rad(to) - course_rad(from));
        let left = left - TAU * libm::floor(left / TAU);
        if left > TAU - LEAST_ARC_RAD {
            0.0
        } else {
            left
        }
    }

    /// How far it is from a place to the end of the turn onto a final of this length, rad.
    pub(super) fn turn_left_rad(&self, final_m: f64, position_m: Vector2<f64>) -> f64 {
        let course = self.turn(final_m).nearest(position_m).course;
        self.around_rad(course, self.course)
    }

    /// How far it is from a place on the circle to the low key, rad.
    pub(super) fn key_left_rad(&self, position_m: Vector2<f64>) -> f64 {
        self.around_rad(self.key().nearest(position_m).course, -self.course)
    }

    fn arc_m(&self, from: Vector2<f64>, angle_rad: f64, air: &Air) -> f64 {
        let through = self.sign() * angle_rad;
        air.glide
            .arc_m(course_rad(from), through, self.radius_m, air.wind_mps)
    }

    /// The leg onto the turn to a final of this length.
    pub(super) fn leg(&self, from_m: Vector2<f64>, final_m: f64) -> Option<Leg> {
        let centre_m = self.turn_centre_m(final_m);
        Leg::to_circle(from_m, centre_m, self.radius_m, self.is_right)
    }

    /// The leg onto the circle over the key.
    pub(super) fn key_leg(&self, from_m: Vector2<f64>) -> Option<Leg> {
        Leg::to_circle(from_m, self.key_centre_m(), self.radius_m, self.is_right)
    }

    /// What turning from a place and a course onto the leg to a circle, and the leg, cost, m,
    /// and that leg's course. None where it begins inside of the circle.
    fn onto_m(
        &self,
        at_m: Vector2<f64>,
        course: Vector2<f64>,
        centre_m: Vector2<f64>,
        air: &Air,
    ) -> Option<(f64, Vector2<f64>)> {
        let radius_m = self.radius_m;
        let onto = |from_m| Leg::to_circle(from_m, centre_m, radius_m, self.is_right);
        let from_rad = course_rad(course);
        let through_rad = |leg: &Leg| wrap_pi(course_rad(leg.course) - from_rad);
        // The turn's end is not on the leg that begins where the turn does: on one beside it.
        let first = onto(at_m)?;
        let outwards = right_of(course) - right_of(first.course);
        let side = if through_rad(&first) < 0.0 { -1.0 } else { 1.0 };
        let leg = onto(at_m + outwards * (side * radius_m)).unwrap_or(first);
        let glide = &air.glide;
        let turned_m = glide.arc_m(from_rad, through_rad(&leg), radius_m, air.wind_mps);
        let way_m = glide.straight_m(course_rad(leg.course), leg.length_m, air.wind_mps);
        Some((turned_m + way_m, leg.course))
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
        let centre_m = self.turn_centre_m(final_m);
        let Some((onto_m, reached)) = self.onto_m(at_m, course, centre_m, air) else {
            return f64::INFINITY;
        };
        let around_rad = self.around_rad(reached, self.course);
        onto_m + self.arc_m(reached, around_rad, air) + self.final_cost_m(final_m, air)
    }

    /// What the way by the circle over the key costs at least, m: to the low key, and with
    /// the shortest final.
    pub(super) fn key_cost_m(&self, at_m: Vector2<f64>, course: Vector2<f64>, air: &Air) -> f64 {
        let (onto_m, reached) = self
            .onto_m(at_m, course, self.key_centre_m(), air)
            .unwrap_or_else(|| (0.0, self.key().nearest(at_m).course));
        let around_rad = self.around_rad(reached, -self.course);
        onto_m + self.arc_m(reached, around_rad, air) + self.low_key_cost_m(0.0, air)
    }

    /// What the way costs from the downwind line, so far before the aim, m, with the final
    /// that begins there or, nearer, with the shortest one.
    pub(super) fn low_key_cost_m(&self, before_m: f64, air: &Air) -> f64 {
        let final_m = before_m.max(self.planned_m());
        let (back, base) = (-self.course, right_of(self.course) * -self.sign());
        let straight_m = |course, way_m| {
            air.glide
                .straight_m(course_rad(course), way_m, air.wind_mps)
        };
        straight_m(back, final_m - before_m)
            + self.arc_m(back, FRAC_PI_2, air)
            + straight_m(base, BASE_M)
            + self.arc_m(base, FRAC_PI_2, air)
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

    /// From the low key 1,000 m east of the aim: 600 m south, two quarters of a circle of
    /// 942.5 m, between them 400 m west, 600 m north.
    #[test]
    fn the_way_from_the_low_key_costs_its_length() {
        let expected_m = (1_600.0 + TURNING * 942.48) / 10.0;
        let cost_m = north().low_key_cost_m(0.0, &STILL);
        assert!((cost_m - expected_m).abs() < 0.1, "{cost_m} {expected_m}");
        let by_key_m = north().key_cost_m(Vector2::new(0.0, 1_000.0), -north().course, &STILL);
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
        // 600 m with 38 m/s, and back with 22 m/s; 400 m across with √(30² - 8²).
        let straight_m = 3.0 * (600.0 / 38.0 + 600.0 / 22.0 + 400.0 / 28.914);
        let cost_m = north().low_key_cost_m(0.0, &air);
        let calm_m = north().low_key_cost_m(0.0, &STILL);
        assert!(cost_m > straight_m + 0.1 * 942.48 && cost_m > calm_m);
    }
}

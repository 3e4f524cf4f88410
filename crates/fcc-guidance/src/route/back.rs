//! The runway that a take-off has recorded, and the way to a landing on it.

use core::f64::consts::PI;

use libm::{cos, sin, tan};
use nalgebra::Vector2;

use super::step::{Step, Until};
use super::{OverGround, RouteConfig};
use crate::path::right_of;
use fcc_core::flight::Position;
use fcc_core::schema;

schema! {
    /// Where a take-off began, and in which direction; all 0 if it is not known.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct TookOff {
        /// Geodetic latitude, rad.
        #[field(1)]
        pub latitude_rad: f64,
        /// Longitude, rad.
        #[field(2)]
        pub longitude_rad: f64,
        /// True course along the runway, rad.
        #[field(3, range = -PI..=PI)]
        pub course_rad: f64,
        /// Of the aircraft on its wheels there, m above mean sea level.
        #[field(4)]
        pub elevation_m: f64,
    }
}

/// The steps of a landing where it took off.
pub(super) const BACK: usize = 4;

/// Level between the circle and the final, and on the final before the glide path, m.
const STRAIGHT_M: f64 = 1_000.0;
const LEVEL_M: f64 = 300.0;
/// The airspeed between the circle and the final, of that of the approach.
const SLOWED: f64 = 1.2;
/// So much higher than the decision height the glide path begins at least, m.
const OVER_DECISION_M: f64 = 30.0;

impl TookOff {
    /// It, if it is known.
    ///
    /// ```
    /// use fcc_guidance::route::TookOff;
    ///
    /// assert_eq!(TookOff::default().known(), None);
    /// let nowhere = TookOff { latitude_rad: f64::NAN, ..TookOff::default() };
    /// assert_eq!(nowhere.known(), None);
    /// let field = TookOff { latitude_rad: 0.82, longitude_rad: 0.14, ..TookOff::default() };
    /// assert_eq!(field.known(), Some(field));
    /// ```
    pub fn known(self) -> Option<Self> {
        let at = Position {
            latitude_rad: self.latitude_rad,
            longitude_rad: self.longitude_rad,
            altitude_m: self.elevation_m,
        };
        let is_number = self.course_rad.is_finite() && self.elevation_m.is_finite();
        (self != Self::default() && at.is_on_earth() && is_number).then_some(self)
    }

    /// A circle to the left that touches the extended centre line, to get down to its
    /// height, the begin of the final, slower, and the landing, which is aimed at where
    /// the aircraft stood: a flare leads beyond it.
    pub(super) fn landing(&self, height_m: f64, config: &RouteConfig) -> [Step; BACK] {
        let runway = &config.runway;
        let height_m = height_m.max(runway.decision_height_m + OVER_DECISION_M);
        let altitude_m = self.elevation_m + height_m;
        let final_m = height_m / tan(runway.glide_path_rad) + LEVEL_M;
        let radius_m = config.loiter_radius_m;
        let start = OverGround {
            latitude_rad: self.latitude_rad,
            longitude_rad: self.longitude_rad,
            ..OverGround::default()
        };
        let course = Vector2::new(cos(self.course_rad), sin(self.course_rad));
        let begin_m = course * -final_m;
        let touches_m = begin_m - course * STRAIGHT_M;
        let centre_m = touches_m - right_of(course) * radius_m;
        [
            Step::Loiter {
                at: Some(start.plane_at(centre_m)),
                altitude_m,
                radius_m,
                clockwise: false,
                until: Until::AtAltitude,
                leave_towards_next: true,
            },
            Step::Airspeed(SLOWED * runway.approach_mps),
            Step::Waypoint {
                at: start.plane_at(begin_m),
                altitude_m,
                within_m: f64::INFINITY,
            },
            Step::Land {
                at: start.plane(),
                elevation_m: self.elevation_m,
                abort_altitude_m: altitude_m,
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::cross;

    /// 150 m are lost on 3° in 2,862 m (150 / 0.0524078, the tangent of 3°).
    #[test]
    fn the_final_is_on_the_extended_centre_line_and_the_circle_left_of_it() {
        let course = Vector2::new(-0.6, 0.8);
        let took_off = TookOff {
            latitude_rad: 0.82,
            longitude_rad: 0.14,
            course_rad: libm::atan2(course.y, course.x),
            elevation_m: 430.0,
        };
        let steps = took_off.landing(150.0, &RouteConfig::default());
        let [
            Step::Loiter {
                at: Some(circle),
                altitude_m,
                radius_m,
                clockwise,
                ..
            },
            Step::Airspeed(slowed_mps),
            Step::Waypoint { at: begin, .. },
            Step::Land {
                at, elevation_m, ..
            },
        ] = steps
        else {
            panic!("{steps:?}");
        };
        assert_eq!((altitude_m, elevation_m), (580.0, 430.0));
        assert_eq!((radius_m, clockwise), (800.0, false));
        // 82 kt, of an approach at 68 kt.
        assert!((slowed_mps / 0.514_444 - 81.6).abs() < 0.1, "{slowed_mps}");
        let begin_m = at.origin_of_m(&begin);
        assert!((course.dot(&begin_m) + 3_162.0).abs() < 2.0, "{begin_m}");
        assert!(cross(course, begin_m).abs() < 2.0, "{begin_m}");
        let circle_m = at.origin_of_m(&circle);
        assert!((course.dot(&circle_m) + 4_162.0).abs() < 2.0, "{circle_m}");
        assert!((cross(course, circle_m) + 800.0).abs() < 2.0, "{circle_m}");
    }
}

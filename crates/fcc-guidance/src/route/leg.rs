//! Straight legs to a place or onto a circle around it, in its plane.

use libm::asin;
use nalgebra::Vector2;

use super::corner::turned;
use crate::path::{Path, length, right_of, unit};

/// A straight leg in the plane of the place that it leads to.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Leg {
    /// Where it ends, m.
    finish_m: Vector2<f64>,
    /// Of length 1.
    pub(super) course: Vector2<f64>,
    pub(super) length_m: f64,
}

/// The course from a place, m, onto a circle around the origin of its plane, which it
/// touches; of length 1. None from inside of the circle.
pub fn course_onto_circle(
    from_m: Vector2<f64>,
    radius_m: f64,
    clockwise: bool,
) -> Option<Vector2<f64>> {
    Leg::to_circle(from_m, Vector2::zeros(), radius_m, clockwise).map(|leg| leg.course)
}

impl Leg {
    /// To a place, from where it is begun; none if it is no way.
    pub(super) fn to_place(begin_m: Vector2<f64>, place_m: Vector2<f64>) -> Option<Self> {
        let way = place_m - begin_m;
        unit(way).map(|course| Self {
            finish_m: place_m,
            course,
            length_m: length(way),
        })
    }

    /// To where a circle is touched, in the direction in which it is flown; none from
    /// inside of it.
    pub(super) fn to_circle(
        begin_m: Vector2<f64>,
        centre_m: Vector2<f64>,
        radius_m: f64,
        clockwise: bool,
    ) -> Option<Self> {
        let way = centre_m - begin_m;
        let away_m = length(way);
        if away_m <= radius_m {
            return None;
        }
        let aside = asin(radius_m / away_m);
        let course = turned(unit(way)?, if clockwise { -aside } else { aside });
        let outwards = right_of(course) * if clockwise { -radius_m } else { radius_m };
        Self::to_place(begin_m, centre_m + outwards).map(|leg| Self { course, ..leg })
    }

    pub(super) const fn path(&self) -> Path {
        Path::Line {
            through_m: self.finish_m,
            course: self.course,
        }
    }

    /// How far it is to its end, m, along it; negative behind it.
    pub(super) fn left_m(&self, position_m: Vector2<f64>) -> f64 {
        self.course.dot(&(self.finish_m - position_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tangent of a circle: perpendicular to its radius, of length √(D² - R²),
    /// and the circle is flown on from there in the same direction.
    #[test]
    fn a_leg_onto_a_circle_touches_it() {
        let begin = Vector2::new(-3_000.0, 400.0);
        let centre = Vector2::new(200.0, -100.0);
        for clockwise in [true, false] {
            let leg = Leg::to_circle(begin, centre, 700.0, clockwise).unwrap();
            let distance2 = (centre - begin).norm_squared();
            assert!((leg.length_m - (distance2 - 700.0 * 700.0).sqrt()).abs() < 1e-6);
            let circle = Path::Circle {
                centre_m: centre,
                radius_m: 700.0,
                clockwise,
            };
            let nearest = circle.nearest(leg.finish_m);
            assert!(nearest.cross_track_m.abs() < 1e-6);
            assert!((nearest.course - leg.course).norm() < 1e-9);
        }
        assert!(Leg::to_circle(centre, centre, 700.0, true).is_none());
    }
}

//! Lines and circles.

use nalgebra::Vector2;

use super::{cross, length, right_of, unit};

/// A path in a [plane](super::LocalPlane). An arc is flown as the circle that it is
/// a part of.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Path {
    /// A straight line, without ends.
    Line {
        /// A point of it, m.
        through_m: Vector2<f64>,
        /// The way it is flown, of length 1.
        course: Vector2<f64>,
    },
    /// A circle.
    Circle {
        /// m.
        centre_m: Vector2<f64>,
        /// m, positive.
        radius_m: f64,
        /// The way around, from above.
        clockwise: bool,
    },
}

/// The point of a path that is nearest to an aircraft.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Nearest {
    /// m.
    pub point_m: Vector2<f64>,
    /// The way the path is flown there, of length 1.
    pub course: Vector2<f64>,
    /// Of the path there, 1/m, positive in a turn to the right.
    pub curvature_per_m: f64,
    /// How far the aircraft is to the right of the path, m.
    pub cross_track_m: f64,
}

impl Path {
    /// The line from one point to another; none if they are the same.
    pub fn line(from_m: Vector2<f64>, to_m: Vector2<f64>) -> Option<Self> {
        unit(to_m - from_m).map(|course| Self::Line {
            through_m: to_m,
            course,
        })
    }

    /// The nearest point. In the centre of a circle all points are: the one to the
    /// north is taken.
    ///
    /// ```
    /// use fcc_guidance::path::Path;
    /// use nalgebra::Vector2;
    ///
    /// // 100 m east of a clockwise circle of 500 m: the path goes south there, and
    /// // the aircraft is to the left.
    /// let path = Path::Circle { centre_m: Vector2::zeros(), radius_m: 500.0, clockwise: true };
    /// let nearest = path.nearest(Vector2::new(0.0, 600.0));
    /// assert_eq!(nearest.point_m, Vector2::new(0.0, 500.0));
    /// assert_eq!(nearest.course, Vector2::new(-1.0, 0.0));
    /// assert_eq!((nearest.cross_track_m, nearest.curvature_per_m), (-100.0, 0.002));
    /// ```
    pub fn nearest(&self, position_m: Vector2<f64>) -> Nearest {
        match *self {
            Self::Line { through_m, course } => {
                let from = position_m - through_m;
                Nearest {
                    point_m: through_m + course * course.dot(&from),
                    course,
                    curvature_per_m: 0.0,
                    cross_track_m: cross(course, from),
                }
            }
            Self::Circle {
                centre_m,
                radius_m,
                clockwise,
            } => {
                let from = position_m - centre_m;
                let outwards = unit(from).unwrap_or(Vector2::new(1.0, 0.0));
                let outside_m = length(from) - radius_m;
                let sign = if clockwise { 1.0 } else { -1.0 };
                Nearest {
                    point_m: centre_m + outwards * radius_m,
                    course: right_of(outwards) * sign,
                    curvature_per_m: sign / radius_m,
                    // Outside of a clockwise circle is to its left.
                    cross_track_m: -sign * outside_m,
                }
            }
        }
    }
}

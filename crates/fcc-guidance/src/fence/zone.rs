//! One zone of a fence.

use nalgebra::Vector2;

use crate::path::{LocalPlane, cross, length};

/// The outline of a zone, in its plane.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Shape<'a> {
    /// Around the origin.
    Circle {
        /// m, positive.
        radius_m: f64,
    },
    /// A polygon, whose last corner is joined to its first.
    Polygon {
        /// Its corners in order, m north and east of the origin.
        corners_m: &'a [Vector2<f64>],
    },
}

/// A zone to stay inside or outside of. Sides of polygons are straight in its plane,
/// which is good to 1 m up to 100 km from its origin ([`LocalPlane`]).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Zone<'a> {
    /// The plane of its outline.
    pub plane: LocalPlane,
    /// Its outline.
    pub shape: Shape<'a>,
    /// Stay inside; otherwise outside.
    pub inclusion: bool,
    /// Of a zone to stay inside of: those of one group count together.
    pub group: u16,
}

impl Zone<'_> {
    /// How far a place is inside of the outline, m; negative outside. It is at an offset,
    /// m north and east, from a latitude and longitude in rad.
    pub fn depth_m(&self, latitude_rad: f64, longitude_rad: f64, offset_m: Vector2<f64>) -> f64 {
        let at_m = self.plane.position_m(latitude_rad, longitude_rad)
            + self.plane.direction(latitude_rad, longitude_rad, offset_m);
        match self.shape {
            Shape::Circle { radius_m } => radius_m - length(at_m),
            Shape::Polygon { corners_m } => depth_in_polygon_m(corners_m, at_m),
        }
    }
}

/// The distance from the nearest side; negative outside, which is found by the number of
/// sides that a ray crosses (Shimrat 1962).
fn depth_in_polygon_m(corners_m: &[Vector2<f64>], at_m: Vector2<f64>) -> f64 {
    let Some(last) = corners_m.last() else {
        return f64::NEG_INFINITY;
    };
    let (mut from, mut nearest_m, mut is_inside) = (last - at_m, f64::INFINITY, false);
    for corner in corners_m {
        let to = corner - at_m;
        let side = to - from;
        let share = (-from.dot(&side) / side.dot(&side).max(1e-9)).clamp(0.0, 1.0);
        nearest_m = nearest_m.min(length(from + side * share));
        // The ray leads to the east; a corner on it belongs to one side only.
        if (from.x > 0.0) != (to.x > 0.0) && (cross(from, to) > 0.0) == (from.x > 0.0) {
            is_inside = !is_inside;
        }
        from = to;
    }
    if is_inside { nearest_m } else { -nearest_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 2 km with a notch from the north to its centre.
    const NOTCHED: [Vector2<f64>; 7] = [
        Vector2::new(-1_000.0, -1_000.0),
        Vector2::new(-1_000.0, 1_000.0),
        Vector2::new(1_000.0, 1_000.0),
        Vector2::new(1_000.0, 300.0),
        Vector2::new(0.0, 0.0),
        Vector2::new(1_000.0, -300.0),
        Vector2::new(1_000.0, -1_000.0),
    ];

    #[test]
    fn a_polygon_is_as_deep_as_its_nearest_side_is_far() {
        let depth = |north, east| depth_in_polygon_m(&NOTCHED, Vector2::new(north, east));
        assert_eq!(depth(-500.0, 0.0), 500.0);
        assert_eq!(depth(-1_200.0, 0.0), -200.0);
        // A corner is nearer than any side.
        assert_eq!(depth(1_300.0, 1_400.0), -500.0);
        // In the notch: 300/√(300² + 1000²) of 500 m from its sides.
        let aside = 500.0 * 300.0 / f64::hypot(300.0, 1_000.0);
        assert!((depth(500.0, 0.0) + aside).abs() < 1e-9);
        // On the height of a corner, on both sides of it.
        assert_eq!(depth(0.0, -900.0), 100.0);
        assert_eq!(depth(0.0, 900.0), 100.0);
        // The way around does not matter.
        let mut other_way = NOTCHED;
        other_way.reverse();
        assert_eq!(
            depth_in_polygon_m(&other_way, Vector2::new(-500.0, 0.0)),
            500.0
        );
    }

    /// 0.01° of latitude are 1,111.2 m at 47° (NGA's calculator: 111,170 m a degree), and
    /// of longitude 760.6 m (76,060 m), across the date line as elsewhere.
    #[test]
    fn a_circle_is_seen_across_the_date_line() {
        let at = |latitude: f64, longitude: f64| (latitude.to_radians(), longitude.to_radians());
        let (latitude, longitude) = at(47.0, 179.995);
        let zone = Zone {
            plane: LocalPlane::at(latitude, longitude),
            shape: Shape::Circle { radius_m: 1_000.0 },
            inclusion: true,
            group: 0,
        };
        let depth = |(latitude, longitude)| zone.depth_m(latitude, longitude, Vector2::zeros());
        assert!((depth(at(47.01, 179.995)) + 111.7).abs() < 1.0);
        assert!((depth(at(47.0, -179.995)) - 239.4).abs() < 0.5);
        let offset = Vector2::new(0.0, 700.0);
        let seen = zone.depth_m(latitude, longitude, offset);
        assert!((seen - 300.0).abs() < 1e-6);
    }
}

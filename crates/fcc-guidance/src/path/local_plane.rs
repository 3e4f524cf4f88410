//! Metres north and east of a place.

use libm::{atan2, cos, hypot, sin, sqrt};
use nalgebra::{Vector2, Vector3};

use fcc_core::flight::earth::{ECCENTRICITY_2, SEMI_MAJOR_AXIS_M, metres_per_radian};

/// A plane that touches the WGS-84 ellipsoid at its origin. Places around it are
/// in it by their direction and distance (azimuthal equidistant), so that a
/// straight line through the origin is the shortest way over the ground.
///
/// It is computed by Cartesian coordinates of the earth (NIMA TR8350.2, 2000,
/// equation 4-14), which have no date line and no poles. The bearing is that of
/// the normal section, the distance that of a sphere of the mean curvature at the
/// origin. Against geodesics both are good to 1 cm up to 20 km, to 1 m up to 100 km,
/// and to 0.3 % anywhere on the same half of the earth.
///
/// ```
/// use fcc_guidance::path::LocalPlane;
///
/// // A minute of latitude at 45° is 1,852.2 m; across the date line as well.
/// let plane = LocalPlane::at(45.0_f64.to_radians(), 179.999_f64.to_radians());
/// let north = plane.position_m((45.0_f64 + 1.0 / 60.0).to_radians(), 179.999_f64.to_radians());
/// assert!((north.x - 1_852.2).abs() < 0.1 && north.y.abs() < 0.01);
/// let east = plane.position_m(45.0_f64.to_radians(), -179.999_f64.to_radians());
/// assert!((east.y - 0.002 * 78_846.8).abs() < 0.01 && east.x.abs() < 0.01);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LocalPlane {
    /// Of the origin, m from the centre of the earth.
    origin_m: Vector3<f64>,
    north: Vector3<f64>,
    east: Vector3<f64>,
    /// Radius of the mean curvature at the origin, m.
    radius_m: f64,
}

impl LocalPlane {
    /// With its origin at a geodetic latitude and a longitude, rad. At a pole the
    /// longitude says which way north is.
    pub fn at(latitude_rad: f64, longitude_rad: f64) -> Self {
        let (north, east) = axes(latitude_rad, longitude_rad);
        let (meridian, _) = metres_per_radian(latitude_rad, 0.0);
        let prime_vertical = prime_vertical_m(sin(latitude_rad));
        Self {
            origin_m: on_ellipsoid_m(latitude_rad, longitude_rad),
            north,
            east,
            radius_m: sqrt(meridian * prime_vertical),
        }
    }

    /// A place in the plane, m north and east.
    pub fn position_m(&self, latitude_rad: f64, longitude_rad: f64) -> Vector2<f64> {
        self.project(on_ellipsoid_m(latitude_rad, longitude_rad))
    }

    /// The origin of another plane in this one, m north and east.
    pub fn origin_of_m(&self, other: &Self) -> Vector2<f64> {
        self.project(other.origin_m)
    }

    fn project(&self, place_m: Vector3<f64>) -> Vector2<f64> {
        let from_origin = place_m - self.origin_m;
        let chord = Vector2::new(from_origin.dot(&self.north), from_origin.dot(&self.east));
        let across = hypot(chord.x, chord.y);
        if across < 1e-6 {
            return chord;
        }
        let down = self.north.cross(&self.east);
        let angle = atan2(across, self.radius_m - from_origin.dot(&down));
        chord * (self.radius_m * angle / across)
    }

    /// A horizontal vector at a place, such as a velocity, in this plane: near the
    /// poles north is not the same way everywhere. It keeps its length.
    pub fn direction(
        &self,
        latitude_rad: f64,
        longitude_rad: f64,
        vector: Vector2<f64>,
    ) -> Vector2<f64> {
        let (north, east) = axes(latitude_rad, longitude_rad);
        self.turned(north * vector.x + east * vector.y, vector)
    }

    fn turned(&self, on_earth: Vector3<f64>, vector: Vector2<f64>) -> Vector2<f64> {
        let flat = Vector2::new(on_earth.dot(&self.north), on_earth.dot(&self.east));
        let (length, wanted) = (hypot(flat.x, flat.y), hypot(vector.x, vector.y));
        if length > 1e-9 {
            flat * (wanted / length)
        } else {
            vector
        }
    }
}

/// North and east at a place.
fn axes(latitude_rad: f64, longitude_rad: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (sin_latitude, cos_latitude) = (sin(latitude_rad), cos(latitude_rad));
    let (sin_longitude, cos_longitude) = (sin(longitude_rad), cos(longitude_rad));
    (
        Vector3::new(
            -sin_latitude * cos_longitude,
            -sin_latitude * sin_longitude,
            cos_latitude,
        ),
        Vector3::new(-sin_longitude, cos_longitude, 0.0),
    )
}

/// The radius of curvature in the prime vertical, m.
fn prime_vertical_m(sin_latitude: f64) -> f64 {
    SEMI_MAJOR_AXIS_M / sqrt(1.0 - ECCENTRICITY_2 * sin_latitude * sin_latitude)
}

/// A place on the ellipsoid, m from the centre of the earth.
fn on_ellipsoid_m(latitude_rad: f64, longitude_rad: f64) -> Vector3<f64> {
    let (sin_latitude, cos_latitude) = (sin(latitude_rad), cos(latitude_rad));
    let n = prime_vertical_m(sin_latitude);
    Vector3::new(
        n * cos_latitude * cos(longitude_rad),
        n * cos_latitude * sin(longitude_rad),
        n * (1.0 - ECCENTRICITY_2) * sin_latitude,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over the north pole, from 89.99° at 0° to 89.99° at 180°: 2 · 0.01° of
    /// latitude, 111,694 m each (NGA's calculator), straight north all the way.
    #[test]
    fn goes_straight_over_a_pole() {
        let plane = LocalPlane::at(89.99_f64.to_radians(), 0.0);
        let across = plane.position_m(89.99_f64.to_radians(), 180.0_f64.to_radians());
        assert!((across.x - 2.0 * 1_116.94).abs() < 0.05, "{across}");
        assert!(across.y.abs() < 1e-3, "{across}");
        // What flies north over the pole flies south on the other side.
        let south = Vector2::new(-50.0, 0.0);
        let in_plane = plane.direction(89.99_f64.to_radians(), 180.0_f64.to_radians(), south);
        assert!(
            (in_plane - Vector2::new(50.0, 0.0)).norm() < 1e-3,
            "{in_plane}"
        );
    }
}

//! Where the aircraft is and how it moves, for guidance over the ground.

use nalgebra::Vector2;

use crate::path::{LocalPlane, Motion, right_of, unit};
use fcc_core::flight::earth::metres_per_radian;

/// Where the aircraft is and how it moves. Vectors are (true north, east).
///
/// ```
/// use fcc_guidance::path::LocalPlane;
/// use fcc_guidance::route::OverGround;
/// use nalgebra::Vector2;
///
/// let here = OverGround { latitude_rad: 0.8, longitude_rad: 0.1, ..OverGround::default() };
/// let motion = here.motion_in(&LocalPlane::at(0.8, 0.1));
/// assert!(motion.position_m.norm() < 1e-6);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct OverGround {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Altitude above mean sea level by the altimeter setting, m.
    pub altitude_m: f64,
    /// How much higher that is than the satellite receiver's altitude, m, over some
    /// seconds; none where there is no receiver, or its altitude is found to be wrong.
    pub above_receiver_m: Option<f64>,
    /// By how much the altitude has stepped in this tick, m, where the aircraft has not.
    pub stepped_m: f64,
    /// Velocity over the ground, m/s.
    pub ground_velocity_mps: Vector2<f64>,
    /// Where the air moves to, m/s.
    pub wind_mps: Vector2<f64>,
    /// True airspeed, m/s.
    pub true_airspeed_mps: f64,
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// True heading, rad.
    pub heading_rad: f64,
    /// Right wing down, rad.
    pub roll_rad: f64,
    /// Upwards, m/s.
    pub climb_rate_mps: f64,
    /// What an accelerometer shows along the aircraft, m/s², forwards.
    pub forward_mps2: f64,
    /// The range finder's height above the ground, m; none where it gives none.
    pub height_m: Option<f64>,
    /// Whether a range finder has shown the ground, so that without one it is far.
    pub ranges: bool,
    /// Whether the wheels bear weight; none where it is not measured.
    pub on_wheels: Option<bool>,
}

impl OverGround {
    /// The plane around the aircraft.
    pub fn plane(&self) -> LocalPlane {
        LocalPlane::at(self.latitude_rad, self.longitude_rad)
    }

    /// Position and motion in a plane.
    pub fn motion_in(&self, plane: &LocalPlane) -> Motion {
        let north = plane.direction(
            self.latitude_rad,
            self.longitude_rad,
            Vector2::new(1.0, 0.0),
        );
        let turned = |v: Vector2<f64>| {
            Vector2::new(north.x * v.x - north.y * v.y, north.y * v.x + north.x * v.y)
        };
        Motion {
            position_m: plane.position_m(self.latitude_rad, self.longitude_rad),
            ground_velocity_mps: turned(self.ground_velocity_mps),
            wind_mps: turned(self.wind_mps),
        }
    }

    /// The plane around a place at an offset from the aircraft, m north and east.
    pub fn plane_at(&self, offset_m: Vector2<f64>) -> LocalPlane {
        let (per_latitude, per_longitude) = metres_per_radian(self.latitude_rad, 0.0);
        LocalPlane::at(
            self.latitude_rad + offset_m.x / per_latitude,
            self.longitude_rad + offset_m.y / per_longitude,
        )
    }

    /// The aircraft after a time, s, without a turn.
    #[must_use]
    pub fn straight_on(&self, after_s: f64) -> Self {
        let (per_latitude, per_longitude) = metres_per_radian(self.latitude_rad, 0.0);
        let by_m = self.ground_velocity_mps * after_s;
        Self {
            latitude_rad: self.latitude_rad + by_m.x / per_latitude,
            longitude_rad: self.longitude_rad + by_m.y / per_longitude,
            ..*self
        }
    }

    /// The place so far to the right of the aircraft, m, across its course.
    pub(super) fn beside(&self, right_m: f64) -> LocalPlane {
        let course = unit(self.ground_velocity_mps).unwrap_or(Vector2::new(1.0, 0.0));
        self.plane_at(right_of(course) * right_m)
    }

    /// Whether all is finite.
    pub fn is_finite(&self) -> bool {
        [
            self.latitude_rad,
            self.longitude_rad,
            self.altitude_m,
            self.ground_velocity_mps.x,
            self.ground_velocity_mps.y,
            self.wind_mps.x,
            self.wind_mps.y,
            self.true_airspeed_mps,
            self.airspeed_mps,
        ]
        .iter()
        .all(|value| value.is_finite())
    }
}

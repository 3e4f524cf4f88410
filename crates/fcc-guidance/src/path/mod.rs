//! Paths over the ground: lines, arcs and circles, and the bank that follows them
//! in wind.
//!
//! ```text
//! position ─► LocalPlane ─► Path::nearest ─► Npfg ─► BankCommand
//! ```
//!
//! | type | what |
//! |---|---|
//! | [`LocalPlane`] | metres north and east of a place, anywhere on WGS-84 |
//! | [`Path`] | a line or a circle in such a plane |
//! | [`Npfg`] | the law: from position, velocity and wind to a lateral acceleration |
//! | [`BankCommand`] | its bank, within limit and rate |
//! | [`turn`] | ground speed, smallest radius, fly-by and fly-over in wind |
//!
//! [`route`](super::route) puts them in order.
//!
//! Courses are of the ground track, headings of the nose: in wind they differ. Both
//! are in rad clockwise from true north, and vectors are (north, east).

mod bank;
mod local_plane;
mod npfg;
mod shape;
#[cfg(test)]
#[path = "tests/simulation.rs"]
pub(super) mod simulation;
pub mod turn;

pub use bank::BankCommand;
pub use local_plane::LocalPlane;
pub use npfg::{Npfg, NpfgConfig};
pub use shape::{Nearest, Path};

use libm::hypot;
use nalgebra::Vector2;

/// Where an aircraft is and how it moves, in a plane.
///
/// ```
/// use fcc_guidance::path::Motion;
/// use nalgebra::Vector2;
///
/// // 50 m/s over the ground to the north, in 10 m/s of wind from the north.
/// let motion = Motion {
///     position_m: Vector2::zeros(),
///     ground_velocity_mps: Vector2::new(50.0, 0.0),
///     wind_mps: Vector2::new(-10.0, 0.0),
/// };
/// assert_eq!(motion.air_velocity_mps(), Vector2::new(60.0, 0.0));
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Motion {
    /// North and east of the plane's origin, m.
    pub position_m: Vector2<f64>,
    /// Over the ground, m/s.
    pub ground_velocity_mps: Vector2<f64>,
    /// Where the air moves to, m/s.
    pub wind_mps: Vector2<f64>,
}

impl Motion {
    /// Through the air, m/s: the wind triangle.
    pub fn air_velocity_mps(&self) -> Vector2<f64> {
        self.ground_velocity_mps - self.wind_mps
    }

    /// Whether all is finite.
    pub fn is_finite(&self) -> bool {
        [self.position_m, self.ground_velocity_mps, self.wind_mps]
            .iter()
            .all(|v| v.x.is_finite() && v.y.is_finite())
    }
}

/// The length of a vector, by `libm`, as everything in a tick.
pub fn length(v: Vector2<f64>) -> f64 {
    hypot(v.x, v.y)
}

/// A vector of length 1, or none of a vector of almost none.
pub fn unit(v: Vector2<f64>) -> Option<Vector2<f64>> {
    let length = length(v);
    (length > 1e-9 && length.is_finite()).then(|| v / length)
}

/// The vertical part of a × b: positive if b is to the right of a.
pub fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The vector turned right by 90°.
pub fn right_of(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

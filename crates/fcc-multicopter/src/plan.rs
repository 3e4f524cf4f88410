//! The items of a plan, in metres from home.

use nalgebra::Vector3;

/// A place to fly to.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Waypoint {
    /// North, east, down of home, m.
    pub place_m: Vector3<f64>,
    /// Of the nose there and on the way, rad; none: where it flies to.
    pub heading_rad: Option<f64>,
    /// Whether it stops there; otherwise it passes inside of the corner.
    pub stops: bool,
}

/// An item of a plan.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Item {
    /// Rise to a height above home, m.
    TakeOff(f64),
    /// Fly to a place.
    Waypoint(Waypoint),
    /// Hold the place for so long, s.
    Hover(f64),
    /// Circle around a place to the right.
    Circle {
        /// How far to the right, m; to the left if negative.
        radius_m: f64,
        /// How often.
        turns: f64,
    },
    /// Fly home, and land there.
    Return,
    /// Land.
    Land,
}

//! Where a step leads, and how.

use nalgebra::Vector2;

use super::circle::Circle;
use super::leg::Leg;
use crate::path::LocalPlane;

/// Where a step leads.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Goal {
    pub(super) at: LocalPlane,
    pub(super) altitude_m: f64,
    pub(super) kind: GoalKind,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum GoalKind {
    /// Passed within this distance, m.
    Place(f64),
    Circle(Circle),
    /// Landed on; the altitude of a go-around, m.
    Landing(f64),
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Next {
    pub(super) place_m: Vector2<f64>,
    /// The leg from the goal to there.
    pub(super) leg: Option<Leg>,
}

/// From where the altitude changes along a leg.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Profile {
    pub(super) to_go_m: f64,
    pub(super) altitude_m: f64,
}

/// A speed, m/s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Speed {
    Indicated(f64),
    OverGround(f64),
}

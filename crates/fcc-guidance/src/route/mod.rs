//! Routes over the ground, in wind: the form of a flight plan that a tick reads, and
//! what flies it.
//!
//! ```text
//! Route, Whereabouts ─► Follower ─► lateral acceleration, altitude, airspeed
//! ```
//!
//! A [`Route`] is made before the flight, or [beside it](PreparedRoutes), in memory that
//! outlives the loop, and is not changed: a tick follows a reference to it. Its steps have the numbers of the plan's
//! items, so that what is recorded and told has, too.
//!
//! Courses and places refer to true north and WGS-84, altitudes to mean sea level.

mod back;
mod begin;
mod circle;
mod corner;
mod demand;
mod follower;
mod glide;
mod goal;
mod leg;
mod over_ground;
mod over_runway;
mod prepared;
mod runway;
mod sequence;
#[cfg(test)]
#[path = "tests/simulation.rs"]
mod simulation;
mod step;

pub use back::TookOff;
pub use follower::{Follower, Track};
pub use glide::{Glide, GlideConfig};
pub use leg::course_onto_circle;
pub use over_ground::OverGround;
pub use prepared::{PreparedRoutes, RouteSource};
pub use runway::ALTIMETER_OFF_M;
pub use runway::HELD_MPS;
pub use runway::{Runway, RunwayConfig, RunwayDemand, RunwayPhase, RunwayReason};
pub use step::{Destination, FOR_EVER, JUMPS, Route, Step, Until};

use crate::path::NpfgConfig;

/// The tangent of the bank that turns are planned with, as a share of that of the
/// largest: the rest is for getting onto the arc and back.
pub const PLANNED_SHARE: f64 = 0.8;

/// The way around a place that is returned to, from above.
pub const RETURNS_CLOCKWISE: bool = true;

/// From a commanded bank to the aircraft's, s.
pub const ROLL_LAG_S: f64 = 0.4;

/// The range of a Cessna 172 with 40 gallons at 75 % and 8,000 ft is 440 nautical miles
/// (172P's handbook, 1981): a leg is shorter, m.
pub const LONGEST_LEG_M: f64 = 815_000.0;

/// How routes are flown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RouteConfig {
    /// The law.
    pub law: NpfgConfig,
    /// Largest bank, rad, below π/2; the envelope may limit it further.
    pub bank_rad: f64,
    /// Largest rate of the commanded bank, rad/s.
    pub bank_rate_radps: f64,
    /// The radius of a circle for which none is given, m.
    pub loiter_radius_m: f64,
    /// Height above home for a return, m; an aircraft that is higher stays so high.
    pub return_height_m: f64,
    /// Take-off and landing.
    pub runway: RunwayConfig,
}

impl Default for RouteConfig {
    /// For 100 kt: a circle that 30° of bank allow in 20 kt of wind, and more.
    fn default() -> Self {
        Self {
            law: NpfgConfig::default(),
            bank_rad: core::f64::consts::FRAC_PI_6,
            bank_rate_radps: 0.261_799, // 15 °/s
            loiter_radius_m: 800.0,
            return_height_m: 150.0,
            runway: RunwayConfig::default(),
        }
    }
}

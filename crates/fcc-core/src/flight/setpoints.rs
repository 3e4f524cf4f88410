//! What the autopilot aims for.

use super::guidance::Progress;

/// What the autopilot aims for: guidance's set points, and those that the
/// outer loops hand to the inner ones.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Setpoints {
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Magnetic heading, rad, 0..2π.
    pub heading_rad: f64,
    /// Barometric altitude, m.
    pub altitude_m: f64,
    /// Bank that the heading loop asks for, rad, right wing down.
    pub roll_rad: f64,
    /// Climb rate that the altitude loop asks for, m/s, up.
    pub climb_rate_mps: f64,
    /// Pitch that the climb-rate loop asks for, rad, nose up.
    pub pitch_rad: f64,
    /// The mode that guidance flies, and how far it has come; its captured
    /// heading is 0..2π.
    pub guidance: Progress,
}

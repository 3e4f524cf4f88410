//! In what a plan is flown.

/// What flies the plan, and in what wind.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conditions {
    /// True airspeed where the plan gives none, m/s.
    pub airspeed_mps: f64,
    /// The lowest and the highest indicated airspeed that is flown, m/s.
    pub slowest_mps: f64,
    /// See `slowest_mps`.
    pub fastest_mps: f64,
    /// The strongest wind, from any direction, m/s.
    pub wind_mps: f64,
    /// The largest bank of a turn, rad, below π/2.
    pub bank_rad: f64,
    /// The fastest climb, m/s.
    pub climb_mps: f64,
    /// The fastest descent, m/s.
    pub descent_mps: f64,
    /// The radius of a loiter whose item has none, m.
    pub loiter_radius_m: f64,
    /// A landing's last leg is straight for so long at least, m.
    pub final_m: f64,
    /// How far inside of the fence the aircraft turns away from it at least, m; none if
    /// it does not.
    pub fence_margin_m: Option<f64>,
}

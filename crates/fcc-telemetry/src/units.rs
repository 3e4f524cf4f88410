//! What people read in: feet, knots and gravities.

/// Feet in a metre.
pub const M_FT: f64 = 1.0 / 0.304_8;

/// Knots in a metre per second.
pub const MPS_KT: f64 = 3_600.0 / 1_852.0;

/// Standard gravity, m/s².
pub const G_MPS2: f64 = 9.806_65;

/// A unit as people read it, and how many of it one of a record's unit is: SI,
/// with angles in degrees.
pub fn for_people(unit: &'static str) -> (&'static str, f64) {
    const RAD_DEG: f64 = 180.0 / std::f64::consts::PI;
    match unit {
        "rad" => ("°", RAD_DEG),
        "rad/s" => ("°/s", RAD_DEG),
        "rad/s²" => ("°/s²", RAD_DEG),
        unit => (unit, 1.0),
    }
}

/// The same for people who fly: feet and knots.
pub fn for_pilots(unit: &'static str) -> (&'static str, f64) {
    match unit {
        "m" => ("ft", M_FT),
        "m/s" => ("kt", MPS_KT),
        unit => for_people(unit),
    }
}

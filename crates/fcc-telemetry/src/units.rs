//! What people read in: feet, knots and gravities.

/// Feet in a metre.
pub const M_FT: f64 = 1.0 / 0.304_8;

/// Knots in a metre per second.
pub const MPS_KT: f64 = 3_600.0 / 1_852.0;

/// Standard gravity, m/s².
pub const G_MPS2: f64 = 9.806_65;

//! Units for users: feet, knots and g.

/// Feet per metre.
pub const M_FT: f64 = 1.0 / 0.304_8;

/// Knots per metre per second.
pub const MPS_KT: f64 = 3_600.0 / 1_852.0;

/// Standard gravity, m/s².
pub const G_MPS2: f64 = 9.806_65;

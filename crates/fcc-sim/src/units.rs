//! Units used in aviation's sources, in SI.
//!
//! Internally everything is SI. Published tables are not, and a number
//! converted by hand can no longer be compared with its source, so constants of
//! the aircraft are written as in the source, times one of these.

/// One international foot, m.
pub const FOOT_M: f64 = 0.3048;
/// One knot, m/s.
pub const KNOT_MPS: f64 = 1852.0 / 3600.0;
/// One avoirdupois pound, kg.
pub const POUND_KG: f64 = 0.453_592_37;
/// One pound-force, N.
pub const POUND_FORCE_N: f64 = POUND_KG * STANDARD_GRAVITY_MPS2;
/// One slug square foot, kg·m².
pub const SLUG_FT2_KGM2: f64 = POUND_FORCE_N * FOOT_M;
/// One foot-pound of torque, N·m.
pub const FOOT_POUND_NM: f64 = POUND_FORCE_N * FOOT_M;
/// One degree, rad.
pub const DEGREE_RAD: f64 = core::f64::consts::PI / 180.0;
/// Standard gravity, m/s² (ISO 80000-3).
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

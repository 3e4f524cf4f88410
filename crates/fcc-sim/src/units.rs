//! Units used in aviation's sources, in SI.
//!
//! Internally everything is SI. Published tables are not, and a number
//! converted by hand can no longer be compared with its source, so constants of
//! the aircraft are written as in the source, times one of these.

pub use fcc_core::units::{FOOT_M, GRAVITY_MPS2 as STANDARD_GRAVITY_MPS2, KNOT_MPS};

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

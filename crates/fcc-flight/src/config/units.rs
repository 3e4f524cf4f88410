//! The units of the configuration file, in SI.

/// One knot in m/s: 1,852 m an hour.
pub const KNOT_MPS: f64 = 1_852.0 / 3_600.0;
/// One foot in m.
pub const FOOT_M: f64 = 0.304_8;
/// One hectopascal in Pa.
pub const HECTOPASCAL_PA: f64 = 100.0;
/// One conventional inch of mercury in Pa (NIST SP 811, appendix B.8).
pub const INHG_PA: f64 = 3_386.389;
/// One foot a minute in m/s.
pub(super) const FOOT_PER_MINUTE_MPS: f64 = FOOT_M / 60.0;

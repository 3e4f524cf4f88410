//! Units that people use, in SI.

/// One international foot in m (1959), exact.
///
/// ```
/// // The tropopause of ISO 2533, 11 000 m, is at 36 089 ft.
/// assert_eq!((11_000.0 / fcc_core::units::FOOT_M).round(), 36_089.0);
/// ```
pub const FOOT_M: f64 = 0.304_8;

/// One foot per minute in m/s.
pub const FOOT_PER_MINUTE_MPS: f64 = FOOT_M / 60.0;

/// One international knot in m/s: 1852 m an hour (BIPM, The International
/// System of Units, 8th ed. 2006, table 8), exact.
///
/// ```
/// assert!((fcc_core::units::KNOT_MPS * 3_600.0 - 1_852.0).abs() < 1e-9);
/// ```
pub const KNOT_MPS: f64 = 1_852.0 / 3_600.0;

/// Standard gravity in m/s² (3rd CGPM, 1901), exact.
///
/// ```
/// assert_eq!(fcc_core::units::GRAVITY_MPS2, 9.806_65);
/// ```
pub const GRAVITY_MPS2: f64 = 9.806_65;

/// One hectopascal in Pa.
///
/// ```
/// // ISO 2533: 101 325 Pa at sea level.
/// assert_eq!(1_013.25 * fcc_core::units::HECTOPASCAL_PA, 101_325.0);
/// ```
pub const HECTOPASCAL_PA: f64 = 100.0;

/// One conventional inch of mercury in Pa (NIST Special Publication 811, 2008,
/// appendix B.8).
///
/// ```
/// // The standard pressure is 29.921 26 inHg.
/// assert!((101_325.0 / fcc_core::units::INHG_PA - 29.921_26).abs() < 1e-5);
/// ```
pub const INHG_PA: f64 = 3_386.389;

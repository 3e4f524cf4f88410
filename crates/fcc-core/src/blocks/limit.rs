//! Limits that neither panic nor hide NaN.

/// The value, or the limit that it exceeds.
///
/// Unlike [`f64::clamp`] it cannot panic; unlike a chain of `max` and `min` it
/// passes NaN through, so that an invalid value is detected at the outputs
/// instead of being replaced by a limit. If `min` exceeds `max`, `max` applies.
///
/// ```
/// use fcc_core::blocks::limit;
/// assert_eq!(limit(1.2, -1.0, 1.0), 1.0);
/// assert!(limit(f64::NAN, -1.0, 1.0).is_nan());
/// ```
pub fn limit(value: f64, min: f64, max: f64) -> f64 {
    if value > max {
        max
    } else if value < min {
        if min > max { max } else { min }
    } else {
        value
    }
}

/// The value, limited to `-most..=most`.
///
/// ```
/// assert_eq!(fcc_core::blocks::limit_abs(-1.2, 1.0), -1.0);
/// ```
pub fn limit_abs(value: f64, most: f64) -> f64 {
    limit(value, -most, most)
}

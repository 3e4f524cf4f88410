//! The ranges of values.

use core::ops::RangeInclusive;

use super::{Field, Schema, Sink, Value};

/// The two ends of a range; for [`schema!`](crate::schema).
pub const fn bounds(range: &RangeInclusive<f64>) -> (f64, f64) {
    (*range.start(), *range.end())
}

/// Whether every number is finite and within its declared range.
///
/// ```
/// use fcc_core::framework::schema::in_range;
///
/// assert!(in_range(&1e9));
/// assert!(!in_range(&f64::NAN));
/// ```
pub fn in_range<T: Schema>(values: &T) -> bool {
    struct Check(bool);
    impl Sink for Check {
        fn value(&mut self, field: &'static Field, value: Value) {
            if let Value::Number(number) = value {
                let (low, high) = field.range.unwrap_or((f64::MIN, f64::MAX));
                self.0 &= (low..=high).contains(&number);
            }
        }
    }
    let mut check = Check(true);
    values.visit(&mut check);
    check.0
}

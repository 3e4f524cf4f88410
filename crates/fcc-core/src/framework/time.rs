//! An instant on the loop's monotonic clock.

use core::ops::{Add, Sub};
use core::time::Duration;

/// Rounding of a sum of steps, s.
pub const ROUNDING_S: f64 = 1e-6;

/// An instant in nanoseconds on the loop's monotonic clock, or [`Time::NEVER`].
///
/// The origin of the clock is arbitrary; only differences have a meaning.
/// Wall-clock time is not used in the loop.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::Time;
///
/// let t = Time::from_nanos(1_000) + Duration::from_nanos(500);
/// assert_eq!(t.since(Time::from_nanos(1_000)), Duration::from_nanos(500));
/// assert_eq!(t.since(Time::NEVER), Duration::MAX);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[repr(transparent)]
pub struct Time(i64);

impl Time {
    /// Before every instant: the time of something that has not happened.
    pub const NEVER: Self = Self(i64::MIN);

    /// The instant `nanos` nanoseconds after the clock's origin.
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// Nanoseconds since the clock's origin; [`i64::MIN`] for [`Time::NEVER`].
    pub const fn as_nanos(self) -> i64 {
        self.0
    }

    /// Whether this is [`Time::NEVER`].
    pub const fn is_never(self) -> bool {
        self.0 == i64::MIN
    }

    /// The time since `earlier`: zero if it lies in the future,
    /// [`Duration::MAX`] if it is [`Time::NEVER`].
    pub const fn since(self, earlier: Self) -> Duration {
        if earlier.is_never() {
            return Duration::MAX;
        }
        let nanos = self.0.saturating_sub(earlier.0);
        if nanos <= 0 {
            Duration::ZERO
        } else {
            Duration::from_nanos(nanos.unsigned_abs())
        }
    }
}

impl Time {
    /// Later by a span, but not later than `latest`, and never earlier than
    /// this; [`Time::NEVER`] stays [`Time::NEVER`].
    ///
    /// ```
    /// use core::time::Duration;
    /// use fcc_core::framework::Time;
    ///
    /// let (taken, latest) = (Time::from_nanos(5), Time::from_nanos(9));
    /// assert_eq!(taken.postponed(Duration::from_nanos(2), latest), Time::from_nanos(7));
    /// assert_eq!(taken.postponed(Duration::from_nanos(8), latest), latest);
    /// ```
    #[must_use]
    pub fn postponed(self, by: Duration, latest: Self) -> Self {
        (self + by).min(latest).max(self)
    }
}

impl Default for Time {
    /// [`Time::NEVER`].
    fn default() -> Self {
        Self::NEVER
    }
}

impl Add<Duration> for Time {
    type Output = Self;

    /// Saturates; [`Time::NEVER`] stays [`Time::NEVER`].
    fn add(self, span: Duration) -> Self {
        if self.is_never() {
            return self;
        }
        let nanos = i64::try_from(span.as_nanos()).unwrap_or(i64::MAX);
        Self(self.0.saturating_add(nanos))
    }
}

/// The first instant: the one before it is [`Time::NEVER`].
const FIRST: i64 = -i64::MAX;

impl Sub<Duration> for Time {
    type Output = Self;

    /// Saturates; [`Time::NEVER`] stays [`Time::NEVER`], and no other instant
    /// becomes it.
    fn sub(self, span: Duration) -> Self {
        if self.is_never() {
            return self;
        }
        let nanos = i64::try_from(span.as_nanos()).unwrap_or(i64::MAX);
        Self(self.0.saturating_sub(nanos).max(FIRST))
    }
}

impl Sub for Time {
    type Output = i64;

    /// Signed difference in nanoseconds; saturates.
    fn sub(self, other: Self) -> i64 {
        self.0.saturating_sub(other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_is_older_than_any_age() {
        assert_eq!(Time::from_nanos(0).since(Time::NEVER), Duration::MAX);
        assert_eq!(Time::NEVER.since(Time::NEVER), Duration::MAX);
        assert!((Time::NEVER + Duration::from_secs(1)).is_never());
        assert!((Time::NEVER - Duration::from_secs(1)).is_never());
    }

    #[test]
    fn the_future_has_age_zero() {
        assert_eq!(
            Time::from_nanos(5).since(Time::from_nanos(9)),
            Duration::ZERO
        );
    }

    #[test]
    fn sums_saturate() {
        assert_eq!(
            Time::from_nanos(i64::MAX) + Duration::MAX,
            Time::from_nanos(i64::MAX)
        );
        let early = Time::from_nanos(i64::MIN + 5) - Duration::from_secs(1);
        assert!(!early.is_never());
        let ms = Duration::from_millis(1);
        assert_eq!(Time::from_nanos(1_000_000) - ms, Time::from_nanos(0));
    }
}

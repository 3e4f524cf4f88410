//! A measured value and when it was taken.

use core::time::Duration;

use super::Time;

/// A value and the time it was taken; [`Time::NEVER`] where none has come yet.
///
/// Plain `repr(C)` data, so that the same struct goes through the loop, shared
/// memory and a recording. Whether a reading is fresh is a question asked with
/// the tick's time, never a flag that someone must remember to clear.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::{Reading, Time};
///
/// let pressure = Reading::new(101_325.0, Time::from_nanos(0));
/// let now = Time::from_nanos(300_000_000);
/// assert!(!pressure.is_fresh(now, Duration::from_millis(250)));
/// assert_eq!(pressure.fresh(now, Duration::from_millis(300)), Some(101_325.0));
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Reading<T> {
    /// The value; meaningless while `taken` is [`Time::NEVER`].
    pub value: T,
    /// When the value was taken, on the loop's clock.
    pub taken: Time,
    /// Which sensor it came from, by its place in the loop, the first being 0.
    /// The loop sets it where there are several; sensors leave it.
    pub source: u8,
}

impl<T> Reading<T> {
    /// A value taken at a time.
    pub const fn new(value: T, taken: Time) -> Self {
        Self {
            value,
            taken,
            source: 0,
        }
    }

    /// Whether nothing has been read yet.
    pub const fn is_never(&self) -> bool {
        self.taken.is_never()
    }

    /// How old the value is at `now`: [`Duration::MAX`] if it never came.
    pub const fn age(&self, now: Time) -> Duration {
        now.since(self.taken)
    }

    /// Whether the value is at most `max_age` old at `now`.
    pub fn is_fresh(&self, now: Time, max_age: Duration) -> bool {
        !self.is_never() && self.age(now) <= max_age
    }
}

impl<T: Copy> Reading<T> {
    /// The value, if it is at most `max_age` old at `now`.
    pub fn fresh(&self, now: Time, max_age: Duration) -> Option<T> {
        self.is_fresh(now, max_age).then_some(self.value)
    }
}

//! A contact that bounces.

use core::time::Duration;

use fcc_core::framework::Time;

/// Follows a contact: its position is the one that it has had, in each sample, for
/// long enough. Until the first such time there is none.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::Time;
/// use fcc_linux::gpio::Debounce;
///
/// let mut switch = Debounce::new(Duration::from_millis(20));
/// let mut at = |ms: i64, is_on| switch.take(Time::from_nanos(ms * 1_000_000), is_on);
/// assert_eq!(at(0, false), None);
/// assert_eq!(at(20, false), Some(false));
/// // It bounces once, and stays.
/// assert_eq!([at(30, true), at(40, false), at(50, true)], [Some(false); 3]);
/// assert_eq!(at(60, true), Some(false));
/// assert_eq!(at(70, true), Some(true));
/// ```
#[derive(Clone, Debug)]
pub struct Debounce {
    settles_in: Duration,
    /// The position of the latest sample, and since when all had it.
    latest: Option<(bool, Time)>,
    position: Option<bool>,
}

impl Debounce {
    /// A contact that rests within this time.
    pub const fn new(settles_in: Duration) -> Self {
        Self {
            settles_in,
            latest: None,
            position: None,
        }
    }

    /// Takes a sample, and gives the position.
    pub fn take(&mut self, now: Time, is_on: bool) -> Option<bool> {
        let since = match self.latest {
            Some((was_on, since)) if was_on == is_on => since,
            _ => now,
        };
        self.latest = Some((is_on, since));
        if now.since(since) >= self.settles_in {
            self.position = Some(is_on);
        }
        self.position
    }
}

//! Which timer: the choice that configuration and command line offer.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::{EarlyWake, Nanosleep, PosixTimer, Timer, TimerError, TimerFd};

/// The timers that wait in the kernel.
///
/// ```
/// use fcc_timer::TimerKind;
///
/// let kind: TimerKind = "posix".parse()?;
/// assert_eq!(kind, TimerKind::Posix);
/// assert_eq!(kind.to_string(), "posix");
/// # Ok::<(), fcc_timer::UnknownTimer>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum TimerKind {
    /// [`TimerFd`].
    #[default]
    Timerfd,
    /// [`PosixTimer`].
    Posix,
    /// [`Nanosleep`].
    Nanosleep,
}

impl TimerKind {
    /// Every kind, in the order they are shown in.
    pub const ALL: [Self; 3] = [Self::Timerfd, Self::Posix, Self::Nanosleep];

    /// Its name in configuration and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Timerfd => TimerFd::NAME,
            Self::Posix => PosixTimer::NAME,
            Self::Nanosleep => Nanosleep::NAME,
        }
    }

    /// Makes a timer of this kind, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour, or the operating
    /// system refuses.
    pub fn build(self, period: Duration) -> Result<Box<dyn Timer>, TimerError> {
        Ok(match self {
            Self::Timerfd => Box::new(TimerFd::new(period)?),
            Self::Posix => Box::new(PosixTimer::new(period)?),
            Self::Nanosleep => Box::new(Nanosleep::new(period)?),
        })
    }

    /// Makes a timer of this kind that wakes early and spins until its deadlines.
    ///
    /// # Errors
    /// As [`build`](Self::build), and when a value of `early` is out of range.
    pub fn build_early(
        self,
        period: Duration,
        early: &EarlyWake,
    ) -> Result<Box<dyn Timer>, TimerError> {
        Ok(match self {
            Self::Timerfd => Box::new(TimerFd::new(period)?.waking_early(early)?),
            Self::Posix => Box::new(PosixTimer::new(period)?.waking_early(early)?),
            Self::Nanosleep => Box::new(Nanosleep::new(period)?.waking_early(early)?),
        })
    }
}

impl fmt::Display for TimerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for TimerKind {
    type Err = UnknownTimer;

    fn from_str(name: &str) -> Result<Self, UnknownTimer> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownTimer(name.to_owned()))
    }
}

/// A name that no timer has.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[error("there is no timer `{0}`: choose timerfd, posix or nanosleep")]
pub struct UnknownTimer(String);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back_as_its_kind() {
        for (name, kind) in [
            ("timerfd", TimerKind::Timerfd),
            ("posix", TimerKind::Posix),
            ("nanosleep", TimerKind::Nanosleep),
        ] {
            assert_eq!(name.parse(), Ok(kind));
            assert_eq!(kind.to_string(), name);
            assert_eq!(kind.build(Duration::from_millis(25)).unwrap().name(), name);
        }
    }

    #[test]
    fn an_unknown_name_is_rejected_with_the_choices() {
        let message = "hpet".parse::<TimerKind>().unwrap_err().to_string();
        for kind in TimerKind::ALL {
            assert!(message.contains(kind.name()), "{message}");
        }
        assert!("Timerfd".parse::<TimerKind>().is_err());
        assert!("".parse::<TimerKind>().is_err());
    }
}

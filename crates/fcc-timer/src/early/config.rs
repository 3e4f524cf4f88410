//! How a timer shall wake early: what configuration says.

use std::time::Duration;

use crate::TimerError;

/// No margin is longer, so that windows of lateness have a useful resolution.
const LONGEST_MARGIN: Duration = Duration::from_millis(10);
/// Half of each period at most: an alarm has to come after the deadline before.
const LARGEST_CPU_CAP: f64 = 0.5;
const QUANTILES: std::ops::RangeInclusive<f64> = 0.5..=0.9999;

/// How much before its deadlines a timer may ask to be woken.
///
/// The margin follows the lateness with which the kernel really wakes the
/// thread: it is the quantile of the last 2048 wake-ups plus the guard, and
/// where the caller warms_up ([`crate::Timer::wait_or_warm_up`]) twice the
/// time that this takes, within `min` and `max`, and never more than `cpu_cap` periods. It starts at the
/// most it may be, and stays there until the quantile can be known.
///
/// A quantile, because a margin that follows the latest of all wake-ups would
/// be blown up by each outlier: with 0.998, four of 2048 change nothing, and a
/// fifth does at the next review (every 32 ticks). So the margin rises within a
/// second when the machine becomes busy, is blind to what happens once in a
/// while, and falls when 2048 ticks have passed since. Wake-ups later than any
/// margin allowed are not counted, for no margin would have helped; unless
/// they are half of all, when the longest margin helps most.
///
/// ```
/// use fcc_timer::{EarlyWake, TimerKind};
/// use std::time::Duration;
///
/// let period = Duration::from_millis(5);
/// let mut timer = TimerKind::Timerfd.build_early(period, &EarlyWake::default())?;
/// timer.start()?;
/// let expiry = timer.wait()?;
/// assert_eq!(expiry.early_wake_ns, 250_000);
/// assert!(expiry.lateness_ns() >= 0);
/// # Ok::<(), fcc_timer::TimerError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct EarlyWake {
    /// The shortest margin. 20 µs by default.
    pub min: Duration,
    /// The longest margin, 10 ms at most. 250 µs by default: 1 % of a period
    /// at 40 Hz.
    pub max: Duration,
    /// Which share of the wake-ups shall be before the deadline, 0.5..=0.9999.
    /// 0.998 by default.
    pub quantile: f64,
    /// Added to what was measured. 20 µs by default.
    pub guard: Duration,
    /// The share of a core that may be spent on spinning, 0..=0.5: no margin
    /// is longer than this many periods, whatever `min` says. 0.25 by default,
    /// which shortens margins of 250 µs above 1 kHz only.
    pub cpu_cap: f64,
}

impl Default for EarlyWake {
    fn default() -> Self {
        Self {
            min: Duration::from_micros(20),
            max: Duration::from_micros(250),
            quantile: 0.998,
            guard: Duration::from_micros(20),
            cpu_cap: 0.25,
        }
    }
}

impl EarlyWake {
    pub(super) fn check(&self) -> Result<(), TimerError> {
        let problem = if self.max > LONGEST_MARGIN {
            "max: choose 10 ms or less"
        } else if self.min > self.max {
            "min: choose no more than max"
        } else if !QUANTILES.contains(&self.quantile) {
            "quantile: choose 0.5 to 0.9999"
        } else if self.guard > LONGEST_MARGIN {
            "guard: choose 10 ms or less"
        } else if !(0.0..=LARGEST_CPU_CAP).contains(&self.cpu_cap) {
            "cpu_cap: choose 0 to 0.5"
        } else {
            return Ok(());
        };
        Err(TimerError::EarlyWake(problem))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_no_sense_is_refused_with_the_range() {
        let config = EarlyWake::default();
        for (bad, name) in [
            (
                EarlyWake {
                    max: Duration::from_millis(11),
                    ..config
                },
                "max",
            ),
            (
                EarlyWake {
                    min: Duration::from_micros(251),
                    ..config
                },
                "min",
            ),
            (
                EarlyWake {
                    quantile: 1.0,
                    ..config
                },
                "quantile",
            ),
            (
                EarlyWake {
                    quantile: f64::NAN,
                    ..config
                },
                "quantile",
            ),
            (
                EarlyWake {
                    guard: Duration::MAX,
                    ..config
                },
                "guard",
            ),
            (
                EarlyWake {
                    cpu_cap: 0.51,
                    ..config
                },
                "cpu_cap",
            ),
            (
                EarlyWake {
                    cpu_cap: f64::NAN,
                    ..config
                },
                "cpu_cap",
            ),
        ] {
            let message = bad.check().unwrap_err().to_string();
            assert!(message.contains(&format!("{name}: choose ")), "{message}");
        }
        assert!(config.check().is_ok());
    }
}

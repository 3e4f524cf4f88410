//! The configuration of early wake.

use std::time::Duration;

use crate::TimerError;

/// No margin is longer, so that windows of lateness have a useful resolution.
const LONGEST_MARGIN: Duration = Duration::from_millis(10);
/// Half of each period at most: an alarm has to come after the deadline before.
const LARGEST_CPU_CAP: f64 = 0.5;
const QUANTILES: std::ops::RangeInclusive<f64> = 0.5..=0.9999;

/// How long before its deadlines a timer may have itself woken.
///
/// The margin is calculated from the measured lateness of the kernel's wake-ups:
/// the quantile of the last 2048 of them plus the guard, plus 1.25 times the
/// duration of a warm-up if the caller does one
/// ([`crate::Timer::wait_or_warm_up`]), within `min` and `max`, and never more than `cpu_cap` periods. It starts at
/// its maximum, and stays there until the quantile is known.
///
/// A quantile, because each outlier would increase a margin based on the latest
/// of all wake-ups: with 0.998, four late ones in 2048 change nothing, and a
/// fifth does at the next review (every 32 ticks). So the margin increases
/// within a second when the machine becomes busy, ignores rare delays, and
/// decreases after 2048 ticks. Wake-ups later than any permitted margin are not
/// counted, because no margin would cover them; if they are at least half of
/// all, the longest margin is used.
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
    /// The share of wake-ups to complete before the deadline, 0.5..=0.9999.
    /// 0.998 by default.
    pub quantile: f64,
    /// Added to the measured quantile. 20 µs by default.
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
    fn values_out_of_range_are_rejected_with_the_range() {
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

//! A timer that never waits, for lockstep and tests.

use std::time::Duration;

use crate::deadlines::{Deadlines, Period};
use crate::{Expiry, Relief, Timer, TimerError, Wake};

/// A timer whose clock advances only in a wait, to the next deadline. The clock
/// starts at 0.
///
/// A loop on it runs as fast as its work allows, and is reproducible. Delays can
/// be simulated: a tick that takes long ([`advance`](Self::advance)) and a thread
/// that wakes late ([`late_at`](Self::late_at)). Either misses deadlines if it
/// is long enough, by the same rule as for the other timers.
///
/// ```
/// use fcc_timer::{ManualTimer, Timer};
/// use std::time::Duration;
///
/// let ms = Duration::from_millis;
/// let mut timer = ManualTimer::new(ms(25))?.late_at(2, ms(60));
/// timer.start()?;
/// assert_eq!(timer.wait()?.woke_ns, 25_000_000);
/// let late = timer.wait()?;
/// assert_eq!(late.woke_ns, 110_000_000);
/// assert_eq!((late.number, late.missed), (4, 2));
/// # Ok::<(), fcc_timer::TimerError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ManualTimer {
    period: Period,
    now_ns: i64,
    deadlines: Option<Deadlines>,
    late: Vec<(u64, Duration)>,
    warms_up: bool,
    warmed_up: bool,
    relief: Relief,
}

impl ManualTimer {
    /// Makes a timer, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        Ok(Self {
            period: Period::new(period)?,
            now_ns: 0,
            deadlines: None,
            late: Vec::new(),
            warms_up: false,
            warmed_up: false,
            relief: Relief::None,
        })
    }

    /// Makes the wait for deadline `number` end `by` after it. Later than a
    /// period, and the deadlines in between are missed.
    #[must_use]
    pub fn late_at(mut self, number: u64, by: Duration) -> Self {
        self.late.push((number, by));
        self
    }

    /// Returns a warm-up before each deadline, like a timer that wakes early.
    #[must_use]
    pub const fn with_warm_up(mut self) -> Self {
        self.warms_up = true;
        self
    }

    /// Advances the clock, as a tick's work does.
    pub fn advance(&mut self, by: Duration) {
        self.now_ns = self.now_ns.saturating_add(by.as_nanos() as i64);
    }
}

impl Timer for ManualTimer {
    fn start(&mut self) -> Result<(), TimerError> {
        self.deadlines = Some(Deadlines::new(self.now_ns, self.period));
        self.warmed_up = false;
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let deadlines = self.deadlines.as_mut().ok_or(TimerError::NotStarted)?;
        self.warmed_up = false;
        let used_ns = deadlines.used_ns(self.now_ns);
        let waited_for = deadlines.next();
        let due_ns = deadlines.awaited_ns(self.now_ns, self.relief);
        self.now_ns = self.now_ns.max(due_ns);
        for (_, by) in self.late.iter().filter(|(number, _)| *number == waited_for) {
            self.now_ns = self.now_ns.saturating_add(by.as_nanos() as i64);
        }
        Ok(Expiry {
            used_ns,
            ..deadlines.woken(self.now_ns)
        })
    }

    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        if self.warms_up && !self.warmed_up {
            self.warmed_up = true;
            return self.clone().wait().map(Wake::WarmUp);
        }
        self.wait().map(Wake::Deadline)
    }

    fn relieve(&mut self, relief: Relief) -> Result<(), TimerError> {
        self.relief = relief;
        Ok(())
    }

    fn period(&self) -> Duration {
        self.period.duration()
    }

    fn now_ns(&self) -> i64 {
        self.now_ns
    }

    fn name(&self) -> &'static str {
        "manual"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn ms(count: u64) -> Duration {
        Duration::from_millis(count)
    }

    fn next(timer: &mut ManualTimer) -> (u64, u64, i64, i64) {
        let expiry = timer.wait().unwrap();
        (
            expiry.number,
            expiry.missed,
            expiry.scheduled_ns / MS,
            expiry.woke_ns / MS,
        )
    }

    #[test]
    fn the_clock_is_the_deadline() {
        let mut timer = ManualTimer::new(ms(25)).unwrap();
        timer.start().unwrap();
        assert_eq!(timer.now_ns(), 0);
        assert_eq!(next(&mut timer), (1, 0, 25, 25));
        assert_eq!(timer.now_ns(), 25 * MS);
        assert_eq!(next(&mut timer), (2, 0, 50, 50));
    }

    #[test]
    fn a_late_wake_up_is_late_once() {
        let mut timer = ManualTimer::new(ms(25)).unwrap().late_at(2, ms(7));
        timer.start().unwrap();
        assert_eq!(next(&mut timer), (1, 0, 25, 25));
        assert_eq!(next(&mut timer), (2, 0, 50, 57));
        assert_eq!(next(&mut timer), (3, 0, 75, 75));
    }

    #[test]
    fn a_tick_of_just_over_a_period_misses_nothing() {
        let mut timer = ManualTimer::new(ms(10)).unwrap();
        timer.start().unwrap();
        assert_eq!(next(&mut timer), (1, 0, 10, 10));
        timer.advance(ms(11));
        assert_eq!(next(&mut timer), (2, 0, 20, 21));
        assert_eq!(next(&mut timer), (3, 0, 30, 30));
    }

    #[test]
    fn a_tick_of_three_and_a_half_periods_misses_two_deadlines() {
        let mut timer = ManualTimer::new(ms(10)).unwrap();
        timer.start().unwrap();
        assert_eq!(next(&mut timer), (1, 0, 10, 10));
        timer.advance(ms(35));
        assert_eq!(next(&mut timer), (4, 2, 40, 45));
        assert_eq!(next(&mut timer), (5, 0, 50, 50));
    }

    #[test]
    fn a_relieved_timer_skips_what_has_passed_and_keeps_its_phase() {
        let mut timer = ManualTimer::new(ms(10)).unwrap();
        timer.start().unwrap();
        timer.relieve(Relief::Skip).unwrap();
        assert_eq!(next(&mut timer), (1, 0, 10, 10));
        timer.advance(ms(12));
        assert_eq!(next(&mut timer), (3, 1, 30, 30));
        timer.advance(ms(3));
        assert_eq!(next(&mut timer), (4, 0, 40, 40));
        timer.relieve(Relief::None).unwrap();
        timer.advance(ms(12));
        assert_eq!(next(&mut timer), (5, 0, 50, 52));
    }
}

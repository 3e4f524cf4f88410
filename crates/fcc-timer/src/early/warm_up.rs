//! How long a warm-up takes, and whether there is time for one.
//!
//! After 25 ms of sleep a thread finds cold caches: its first instructions take
//! several times as long as they would directly after the previous tick. Part
//! of the margin is used to load them: the caller runs the code of the tick
//! without effect, then the spin continues.

/// Assumed duration before one has been measured, ns.
const FIRST_GUESS_NS: i64 = 50_000;
/// The longest duration decreases by this part with each shorter one: one that
/// was interrupted counts for about ten ticks.
const DECAY: i64 = 8;
/// The same with each tick that had no time for one, so that it is tried again
/// later.
const DECAY_UNTRIED: i64 = 64;
/// Ticks without one after one that took longer than the time left, and so made
/// its tick late; twice as many each further time in a row.
const FIRST_SUSPENSION: u32 = 128;
const LONGEST_SUSPENSION: u32 = 65_536;

/// This part of the longest recent duration is reserved in addition. With the
/// whole duration most ticks of one run of two on a busy machine appeared to have
/// no time for a warm-up.
const RESERVE: i64 = 4;

/// How long warm-ups took.
#[derive(Clone, Copy, Debug)]
pub(super) struct WarmUp {
    longest_ns: i64,
    /// Ticks for which none is attempted.
    suspended_ticks: u32,
    next_suspension: u32,
}

impl WarmUp {
    pub(super) const fn new() -> Self {
        Self {
            longest_ns: FIRST_GUESS_NS,
            suspended_ticks: 0,
            next_suspension: FIRST_SUSPENSION,
        }
    }

    /// Time reserved for one, ns: the longest recent one and a quarter. 0
    /// while suspended.
    pub(super) const fn allowance_ns(self) -> i64 {
        if self.suspended_ticks > 0 {
            0
        } else {
            self.longest_ns + self.longest_ns / RESERVE
        }
    }

    /// Whether there is time for one. If not, the time reserved decreases.
    pub(super) const fn fits(&mut self, left_ns: i64) -> bool {
        if self.suspended_ticks > 0 {
            self.suspended_ticks -= 1;
            return false;
        }
        let fits = left_ns >= self.allowance_ns();
        if !fits {
            self.longest_ns -= self.longest_ns / DECAY_UNTRIED;
        }
        fits
    }

    /// Records that one took `ns` when `left_ns` were left.
    pub(super) fn took(&mut self, ns: i64, left_ns: i64) {
        let decayed_ns = self.longest_ns - self.longest_ns / DECAY;
        // A longer time is an interruption, not the warm-up's duration.
        self.longest_ns = decayed_ns.max(ns.min(left_ns));
        if ns > left_ns {
            self.suspended_ticks = self.next_suspension;
            self.next_suspension = (2 * self.next_suspension).min(LONGEST_SUSPENSION);
        } else {
            self.next_suspension = FIRST_SUSPENSION;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT_NS: i64 = 200_000;

    #[test]
    fn the_longest_counts_at_once_and_decreases() {
        let mut warm_up = WarmUp::new();
        for _ in 0..40 {
            warm_up.took(8_000, LEFT_NS);
        }
        assert_eq!(warm_up.allowance_ns(), 10_000);
        warm_up.took(80_000, LEFT_NS);
        assert_eq!(warm_up.allowance_ns(), 100_000);
        warm_up.took(8_000, LEFT_NS);
        assert_eq!(warm_up.allowance_ns(), 87_500);
    }

    #[test]
    fn a_warm_up_without_time_is_tried_again() {
        let mut warm_up = WarmUp::new();
        warm_up.took(150_000, LEFT_NS);
        let mut skipped = 0;
        while !warm_up.fits(150_000) {
            skipped += 1;
        }
        // 187.5 µs decrease to 150: ln(1.25) / -ln(1 - 1 / 64).
        assert_eq!(skipped, 15);
    }

    #[test]
    fn a_warm_up_that_never_fits_makes_ten_ticks_of_a_hundred_thousand_late() {
        let mut warm_up = WarmUp::new();
        let mut late = 0;
        for _ in 0..100_000 {
            if warm_up.fits(LEFT_NS) {
                late += 1;
                warm_up.took(300_000, LEFT_NS);
            }
        }
        // After 128 ticks, 256, 512, ...: nine suspensions are 65,000.
        assert_eq!(late, 10);
    }

    #[test]
    fn one_long_interruption_suspends_it_for_a_few_seconds() {
        let mut warm_up = WarmUp::new();
        warm_up.took(520_000_000, LEFT_NS);
        assert_eq!(warm_up.allowance_ns(), 0);
        let mut without = 0;
        while !warm_up.fits(LEFT_NS) {
            without += 1;
        }
        assert!((128..128 + 64).contains(&without), "{without}");
        warm_up.took(8_000, LEFT_NS);
        warm_up.took(520_000_000, LEFT_NS);
        assert!((0..128).all(|_| !warm_up.fits(LEFT_NS)));
    }
}

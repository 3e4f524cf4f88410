//! How long a rehearsal takes, and whether there is time for one.
//!
//! A thread that slept for 25 ms finds cold caches: what it runs first takes
//! several times as long as it would if it had just run. The time that is
//! spun away is there to warm them: the caller runs what the tick will run,
//! without effect, and then the spin goes on.

/// What one is taken to last before any has been measured, ns.
const FIRST_GUESS_NS: i64 = 50_000;
/// Of what the longest one took, this part is forgotten with each that takes
/// less: one that was interrupted counts for some ten ticks.
const FORGOTTEN: i64 = 8;
/// The same with each tick that had no time for one, so that it is tried again.
const FORGOTTEN_UNTRIED: i64 = 64;
/// Ticks without one after one that took longer than there was time, and so
/// made its tick late; twice as many each time that happens again in a row.
const FIRST_REST: u32 = 128;
const LONGEST_REST: u32 = 65_536;

/// How long rehearsals took.
#[derive(Clone, Copy, Debug)]
pub(super) struct WarmUp {
    longest_ns: i64,
    /// Ticks for which none is tried.
    resting: u32,
    next_rest: u32,
}

impl WarmUp {
    pub(super) const fn new() -> Self {
        Self {
            longest_ns: FIRST_GUESS_NS,
            resting: 0,
            next_rest: FIRST_REST,
        }
    }

    /// How much time one is given, ns: twice the longest of late, so that an
    /// interrupt in it does not reach the deadline. None while it rests.
    pub(super) const fn allowance_ns(self) -> i64 {
        if self.resting > 0 {
            0
        } else {
            2 * self.longest_ns
        }
    }

    /// Whether there is time for one. If not, the next time is nearer.
    pub(super) const fn fits(&mut self, left_ns: i64) -> bool {
        if self.resting > 0 {
            self.resting -= 1;
            return false;
        }
        let fits = left_ns >= self.allowance_ns();
        if !fits {
            self.longest_ns -= self.longest_ns / FORGOTTEN_UNTRIED;
        }
        fits
    }

    /// Counts one that took so long, where so much time was left.
    pub(super) fn took(&mut self, ns: i64, left_ns: i64) {
        let faded_ns = self.longest_ns - self.longest_ns / FORGOTTEN;
        // A machine that stood still meanwhile says nothing of its length.
        self.longest_ns = faded_ns.max(ns.min(left_ns));
        if ns > left_ns {
            self.resting = self.next_rest;
            self.next_rest = (2 * self.next_rest).min(LONGEST_REST);
        } else {
            self.next_rest = FIRST_REST;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT_NS: i64 = 200_000;

    #[test]
    fn the_longest_counts_at_once_and_fades() {
        let mut warm_up = WarmUp::new();
        for _ in 0..40 {
            warm_up.took(8_000, LEFT_NS);
        }
        assert_eq!(warm_up.allowance_ns(), 16_000);
        warm_up.took(80_000, LEFT_NS);
        assert_eq!(warm_up.allowance_ns(), 160_000);
        warm_up.took(8_000, LEFT_NS);
        assert_eq!(warm_up.allowance_ns(), 140_000);
    }

    #[test]
    fn one_that_found_no_time_is_tried_again() {
        let mut warm_up = WarmUp::new();
        warm_up.took(150_000, LEFT_NS);
        let mut skipped = 0;
        while !warm_up.fits(150_000) {
            skipped += 1;
        }
        // 300 µs fade to 150: ln(300 / 150) / -ln(1 - 1 / 64).
        assert_eq!(skipped, 45);
    }

    #[test]
    fn one_that_never_fits_makes_ten_ticks_of_a_hundred_thousand_late() {
        let mut warm_up = WarmUp::new();
        let mut late = 0;
        for _ in 0..100_000 {
            if warm_up.fits(LEFT_NS) {
                late += 1;
                warm_up.took(300_000, LEFT_NS);
            }
        }
        // After 128 ticks, 256, 512, ...: nine rests are 65,000.
        assert_eq!(late, 10);
    }

    #[test]
    fn a_machine_that_stood_still_once_costs_a_few_seconds_of_rehearsals() {
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

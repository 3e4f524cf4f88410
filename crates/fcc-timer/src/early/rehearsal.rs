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

/// How long rehearsals took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rehearsal {
    longest_ns: i64,
}

impl Rehearsal {
    pub(super) const fn new() -> Self {
        Self {
            longest_ns: FIRST_GUESS_NS,
        }
    }

    /// How much time one is given, ns: twice the longest of late, so that an
    /// interrupt in it does not reach the deadline.
    pub(super) const fn allowance_ns(self) -> i64 {
        2 * self.longest_ns
    }

    /// Whether there is time for one. If not, the next time is nearer.
    pub(super) const fn fits(&mut self, left_ns: i64) -> bool {
        let fits = left_ns >= self.allowance_ns();
        if !fits {
            self.longest_ns -= self.longest_ns / FORGOTTEN_UNTRIED;
        }
        fits
    }

    /// Counts one that took so long.
    pub(super) fn took(&mut self, ns: i64) {
        let faded_ns = self.longest_ns - self.longest_ns / FORGOTTEN;
        self.longest_ns = faded_ns.max(ns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_counts_at_once_and_fades() {
        let mut rehearsal = Rehearsal::new();
        for _ in 0..40 {
            rehearsal.took(8_000);
        }
        assert_eq!(rehearsal.allowance_ns(), 16_000);
        rehearsal.took(80_000);
        assert_eq!(rehearsal.allowance_ns(), 160_000);
        rehearsal.took(8_000);
        assert_eq!(rehearsal.allowance_ns(), 140_000);
    }

    #[test]
    fn one_that_takes_too_long_is_tried_again_but_seldom() {
        let mut rehearsal = Rehearsal::new();
        rehearsal.took(400_000);
        let mut skipped = 0;
        while !rehearsal.fits(150_000) {
            skipped += 1;
        }
        // 800 µs fade to 150: ln(800 / 150) / -ln(1 - 1 / 64).
        assert_eq!(skipped, 107);
    }
}

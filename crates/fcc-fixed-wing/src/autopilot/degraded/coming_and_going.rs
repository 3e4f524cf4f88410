//! Faults that come and go: quantities in one failsafe, and failsafes that follow each other.

use fcc_navigation::{Quantities, Quantity};

/// A quantity that comes and goes is used again when it has been good for this
/// time without interruption, s.
const STEADY_S: f64 = 1.0;

/// The quantities that come and go. One that is lost again in the same failsafe
/// is left out, and flown without: a loop that changes several times a second
/// between old readings and what replaces them oscillates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Intermittent {
    /// Lost at present; lost before, and good since.
    lost: Quantities,
    returned: Quantities,
    pub(super) left_out: Quantities,
    /// For how long each has been good, s.
    good_s: [f64; Quantity::COUNT],
}

impl Intermittent {
    pub(super) fn step(&mut self, old: Quantities, dt_s: f64) {
        self.returned |= self.lost & !old;
        self.left_out |= old & self.returned;
        self.lost = old;
        for (good_s, quantity) in self.good_s.iter_mut().zip(Quantity::ALL) {
            *good_s = if old.contains(quantity) {
                0.0
            } else {
                *good_s + dt_s
            };
            self.left_out = self.left_out.keeping(quantity, *good_s < STEADY_S);
        }
    }

    /// What is left out while these are lost: what is flown without attitude and
    /// body rates is worse than what comes and goes.
    pub(super) fn left_out_with(&self, lost: Quantities) -> Quantities {
        const LAST: Quantities = Quantities::of(&[Quantity::Attitude, Quantity::BodyRates]);
        if (self.left_out | lost).contains_all(LAST) {
            self.left_out & !LAST
        } else {
            self.left_out
        }
    }
}

/// Failsafes that follow each other within this time, s, are those of one fault that
/// comes and goes.
const REPEATED_WITHIN_S: f64 = 60.0;
/// The time after which all counts as good again doubles from this one of them on, so
/// many times at most.
const DOUBLES_FROM: u32 = 3;
const MOST_DOUBLINGS: u32 = 4;
/// The time for which nothing sound could be held is forgotten so many times slower than
/// it passed.
pub(super) const FORGOTTEN_SLOWER: f64 = 10.0;

/// The failsafes of a fault that comes and goes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repeated {
    failsafes: u32,
    /// Since the last one ended, s.
    ended_s: f64,
}

impl Repeated {
    /// A failsafe begins.
    pub(super) fn begin(&mut self) {
        self.failsafes = self.failsafes.saturating_add(1);
        self.ended_s = 0.0;
    }

    /// Follows a flight that is not in failsafe.
    pub(super) fn flown_on(&mut self, dt_s: f64) {
        self.ended_s += dt_s;
        if self.ended_s > REPEATED_WITHIN_S {
            *self = Self::default();
        }
    }

    /// By what the time is longer after which all counts as good again.
    pub(super) fn factor(self) -> u32 {
        let doublings = (self.failsafes + 1).saturating_sub(DOUBLES_FROM);
        1 << doublings.min(MOST_DOUBLINGS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `docs/faults.md`: the time doubles with the third failsafe, up to 16 times, of
    /// those that follow each other within 60 s.
    #[test]
    fn failsafes_that_follow_each_other_last_longer() {
        let mut repeated = Repeated::default();
        let mut factors = [0; 8];
        for factor in &mut factors {
            repeated.begin();
            *factor = repeated.factor();
            repeated.flown_on(30.0);
        }
        assert_eq!(factors, [1, 1, 2, 4, 8, 16, 16, 16]);
        repeated.flown_on(30.1);
        repeated.begin();
        assert_eq!(repeated.factor(), 1);
    }
}

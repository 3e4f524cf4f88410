//! How long a quantity is unchanged, and by how much it must have changed.

use fcc_core::framework::Time;

/// The least number of unchanged readings: a sensor with few readings per
/// second repeats some of them.
const FEWEST_REPEATS: u32 = 10;
/// The time constant of the leak for the limits of the detector, s: gyroscopes off by 0.5
/// °/s, or a climb by 1.5 m/s, never reach them. A limit that is greater by the
/// resolution of a sensor has a leak that is slower to match.
const LEAK_S: f64 = 10.0;

/// One quantity and how long it has been unchanged.
#[derive(Clone, Copy, Debug)]
pub(super) struct StuckDetector<const N: usize> {
    values: [f64; N],
    taken: Time,
    repeats: u32,
    for_s: f64,
    pub(super) is_frozen: bool,
}

impl<const N: usize> StuckDetector<N> {
    pub(super) const fn new(values: [f64; N], taken: Time) -> Self {
        Self {
            values,
            taken,
            repeats: 0,
            for_s: 0.0,
            is_frozen: false,
        }
    }

    /// Whether the value differs from the previous one by more than
    /// `tolerance`; `dt_s` of the plant's time have passed.
    pub(super) fn has_changed(
        &mut self,
        values: [f64; N],
        tolerance: f64,
        taken: Time,
        dt_s: f64,
    ) -> bool {
        let differs = |(is, was): (&f64, &f64)| (is - was).abs() > tolerance;
        if taken.is_never() || values.iter().zip(&self.values).any(differs) {
            *self = Self::new(values, taken);
            return true;
        }
        if taken > self.taken {
            self.taken = taken;
            self.repeats = self.repeats.saturating_add(1);
        }
        self.for_s += dt_s;
        false
    }

    /// Updates the result, given whether it must have changed. Once frozen it
    /// stays frozen until it changes.
    pub(super) fn update(&mut self, must_have_changed: bool, after_s: f64) {
        let lasts = self.for_s >= after_s && self.repeats >= FEWEST_REPEATS;
        self.is_frozen |= lasts && must_have_changed;
    }
}

/// An integrator with a leak.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeakyIntegrator(f64);

impl LeakyIntegrator {
    pub(super) const ZERO: Self = Self(0.0);

    /// Adds an amount of a quantity that must exceed `limit` and the resolution.
    pub(super) fn add(&mut self, amount: f64, limit: f64, resolution: f64, dt_s: f64) {
        let leak_s = LEAK_S * (1.0 + resolution / limit);
        self.0 += amount - self.0 * (dt_s / leak_s).min(1.0);
    }

    pub(super) fn exceeds(self, limit: f64, resolution: f64) -> bool {
        self.0.abs() > limit + resolution
    }
}

//! Rates by the magnetic field in the place of gyroscopes that are doubted.

use core::time::Duration;

use super::super::Observation;
use super::RawNavigation;
use fcc_core::framework::Time;

/// By how much longer than the delay there is no attitude after gyroscopes began to be
/// doubted: it is found by the magnetic field.
const SETTLES: Duration = Duration::from_millis(100);

impl RawNavigation {
    /// Takes how the field turns for rates while the gyroscopes are doubted.
    pub(super) fn turn_by_field(&mut self, taken: Time, field: [f64; 3]) {
        let is_doubted = self.doubts_gyroscopes();
        if is_doubted == self.by_field_since.is_never() {
            self.by_field_since = if is_doubted { taken } else { Time::NEVER };
            self.filter.turn_by_field(is_doubted);
        }
        let rates = self.field_rates.step(taken, field, &self.solution);
        if let Some(rates) = rates.filter(|_| is_doubted) {
            self.take(taken, Observation::Rates(rates));
        }
    }

    /// Whether an attitude at a time is one by the field, and not of the moment in
    /// which it is found.
    pub(super) fn settled_by_field(&self, at: Time) -> bool {
        at.since(self.by_field_since) > self.config.delay + SETTLES
    }
}

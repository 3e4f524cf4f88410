//! The plant's time that passes in a tick.

use core::time::Duration;

use crate::flight::{Measurements, PlantState};
use crate::framework::{Tick, Time};

/// The longest single step of the plant's time, s: after a gap the loops
/// continue from the present state, not from an extrapolation.
const MAX_STEP_S: f64 = 0.2;

/// Tracks a simulated plant's clock; a real plant's clock is that of the loop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlantClock {
    last_s: Option<f64>,
    stalled_since: Time,
    is_stalled: bool,
    step_s: f64,
}

impl PlantClock {
    /// Reads the plant's time at a tick. A clock that has been stopped for
    /// longer than `limit`, on a plant that is not paused, is ignored from then
    /// on.
    pub(super) fn step(&mut self, tick: &Tick, measurements: &Measurements, limit: Duration) {
        let tick_s = tick.dt_s.min(MAX_STEP_S);
        let plant = measurements.plant;
        if plant.is_never() {
            self.step_s = tick_s;
            return;
        }
        let state = plant.value.state;
        let last_s = self.last_s.replace(plant.value.time_s);
        let passed_s = last_s.map_or(0.0, |last_s| plant.value.time_s - last_s);
        // Only the difference of times is used: a wrong state must not freeze
        // the loops while the aircraft keeps flying.
        self.step_s = if state == PlantState::Jumped || passed_s <= 0.0 {
            0.0
        } else {
            passed_s.min(MAX_STEP_S)
        };
        if state != PlantState::Stalled || self.step_s > 0.0 {
            self.stalled_since = Time::NEVER;
        } else if self.stalled_since.is_never() {
            self.stalled_since = tick.woke;
        }
        self.is_stalled =
            !self.stalled_since.is_never() && tick.woke.since(self.stalled_since) > limit;
        if self.is_stalled {
            self.step_s = tick_s;
        }
    }

    /// Seconds of the plant since the previous tick; 0 if its time did not
    /// advance.
    pub(super) const fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Whether the plant's clock is ignored because it has stopped.
    pub(super) const fn is_stalled(&self) -> bool {
        self.is_stalled
    }
}

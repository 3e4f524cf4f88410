//! How much of the plant's time a tick is worth.

use core::time::Duration;

use crate::flight::{Measurements, PlantState};
use crate::framework::{Tick, Time};

/// No single step of the plant's time is longer than this, s: after a gap, the
/// loops go on from what is, not from an extrapolation.
const MAX_STEP_S: f64 = 0.2;

/// Follows a simulated plant's clock; a real plant's is the loop's own.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlantClock {
    last_s: Option<f64>,
    stalled_since: Time,
    is_stalled: bool,
    step_s: f64,
}

impl PlantClock {
    /// Takes the plant's time at a tick. A clock that stands still for longer
    /// than `patience`, on a plant that does not say paused, is not believed
    /// any more.
    pub(super) fn step(&mut self, tick: &Tick, measurements: &Measurements, patience: Duration) {
        let tick_s = tick.dt_s.min(MAX_STEP_S);
        let plant = measurements.plant;
        if plant.is_never() {
            self.step_s = tick_s;
            return;
        }
        let state = plant.value.state;
        let last_s = self.last_s.replace(plant.value.time_s);
        let passed_s = last_s.map_or(0.0, |last_s| plant.value.time_s - last_s);
        // The difference alone says how much: a state that is wrong must not
        // freeze the loops while the aircraft flies on.
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
            !self.stalled_since.is_never() && tick.woke.since(self.stalled_since) > patience;
        if self.is_stalled {
            self.step_s = tick_s;
        }
    }

    /// Seconds of the plant since the tick before; 0 where none passed.
    pub(super) const fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Whether the plant's clock is not believed any more.
    pub(super) const fn is_stalled(&self) -> bool {
        self.is_stalled
    }
}

//! Tells from the inertial sensors whether they stand still.

use nalgebra::Vector3;

use fcc_core::blocks::smoothing_factor;
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// What is averaged, s.
const AVERAGE_S: f64 = 0.5;
/// Standing still for this long is believed, s.
const STILL_S: f64 = 1.5;
/// Beyond these deviations from the average it moves: a hand that holds still
/// does more (rad/s, 2 °/s; m/s²).
const RATE_RADPS: f64 = 0.035;
const FORCE_MPS2: f64 = 0.5;
/// A steady acceleration is not rest: no calibrated accelerometer shows a gravity
/// that differs by this, m/s².
const GRAVITY_MPS2_OFF: f64 = 0.3;
/// No gyroscope has such a bias: it turns (rad/s, 5 °/s).
const LARGEST_BIAS_RADPS: f64 = 0.087;

/// Averages of the inertial sensors, and when they last moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    pub(super) rates: Vector3<f64>,
    force: Vector3<f64>,
    moved: Time,
}

impl Rest {
    pub(super) fn new() -> Self {
        Self {
            rates: Vector3::zeros(),
            force: Vector3::zeros(),
            moved: Time::NEVER,
        }
    }

    /// Takes a sample, as it came. True if it stands still.
    pub(super) fn step(
        &mut self,
        now: Time,
        rates: Vector3<f64>,
        force: Vector3<f64>,
        dt_s: f64,
    ) -> bool {
        if self.moved.is_never() {
            (self.rates, self.force, self.moved) = (rates, force, now);
        }
        let share = smoothing_factor(dt_s, AVERAGE_S);
        self.rates += (rates - self.rates) * share;
        self.force += (force - self.force) * share;
        let is_turning =
            (rates - self.rates).norm() > RATE_RADPS || self.rates.amax() > LARGEST_BIAS_RADPS;
        let is_accelerated = libm::fabs(self.force.norm() - GRAVITY_MPS2) > GRAVITY_MPS2_OFF;
        if is_turning || is_accelerated || (force - self.force).norm() > FORCE_MPS2 {
            self.moved = now;
        }
        self.still_s(now) >= STILL_S
    }

    /// For how long it has stood still, s.
    pub(super) fn still_s(&self, now: Time) -> f64 {
        now.since(self.moved).as_secs_f64()
    }
}

//! Combines two sensors of one quantity: one accurate over short times, one
//! over long times.

use super::low_pass::smoothing_factor;

/// First-order complementary filter: integrates a rate, and is corrected
/// towards an absolute measurement with a time constant. Above `1/τ` rad/s it
/// follows the rate, below it the measurement.
///
/// ```
/// use fcc_core::blocks::Complementary;
/// let mut roll = Complementary::new(0.5);
/// roll.reset(0.0);
/// roll.predict(0.2, 0.025); // a gyroscope: 0.2 rad/s for 25 ms
/// roll.correct(0.0, 0.025); // an accelerometer: level
/// assert!(roll.value() > 0.0 && roll.value() < 0.005);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Complementary {
    tau_s: f64,
    value: f64,
}

impl Complementary {
    /// A filter of time constant `tau_s` (s), at 0.
    pub const fn new(tau_s: f64) -> Self {
        Self { tau_s, value: 0.0 }
    }

    /// Sets the value.
    pub const fn reset(&mut self, value: f64) {
        self.value = value;
    }

    /// Integrates a rate (units per second) for `dt_s` seconds.
    pub fn predict(&mut self, rate: f64, dt_s: f64) {
        self.value += rate * dt_s;
    }

    /// Corrects towards a measurement; `dt_s` is the time since the previous
    /// one.
    pub fn correct(&mut self, measurement: f64, dt_s: f64) {
        self.correct_by(measurement - self.value, dt_s);
    }

    /// Corrects by an error computed by the caller, such as the shorter
    /// difference of two angles.
    pub fn correct_by(&mut self, error: f64, dt_s: f64) {
        self.value += smoothing_factor(dt_s, self.tau_s) * error;
    }

    /// The value.
    pub const fn value(&self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a rate of bias b the error settles at b·τ: from ẋ = b + (m - x)/τ.
    #[test]
    fn a_biased_rate_settles_at_bias_times_time_constant() {
        let mut filter = Complementary::new(0.5);
        for _ in 0..100_000 {
            filter.predict(0.01, 1e-4);
            filter.correct(0.0, 1e-4);
        }
        assert!((filter.value() - 0.005).abs() < 2e-6, "{}", filter.value());
    }
}

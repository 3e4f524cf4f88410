//! Limits the rate of change of a signal.

use super::limit_abs;

/// Limits the rate of change of a signal.
///
/// ```
/// use fcc_core::blocks::RateLimit;
///
/// // A throttle that takes 2 s from idle to full.
/// let mut throttle = RateLimit::new(0.5);
/// throttle.reset(0.0);
/// assert!((throttle.step(1.0, 1.0) - 0.5).abs() < 1e-12);
/// assert!((throttle.step(1.0, 1.0) - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RateLimit {
    rate_per_s: f64,
    output: Option<f64>,
}

impl RateLimit {
    /// A limiter of `rate_per_s` (units per second, positive) that begins at
    /// its first input.
    pub const fn new(rate_per_s: f64) -> Self {
        Self {
            rate_per_s,
            output: None,
        }
    }

    /// Changes the largest rate of change, per second.
    pub const fn set_rate(&mut self, rate_per_s: f64) {
        self.rate_per_s = rate_per_s;
    }

    /// Sets the output.
    pub const fn reset(&mut self, output: f64) {
        self.output = Some(output);
    }

    /// Moves towards `input` for `dt_s` seconds; returns the output.
    pub fn step(&mut self, input: f64, dt_s: f64) -> f64 {
        let output = match self.output {
            None => input,
            Some(output) => {
                let most = self.rate_per_s * dt_s.max(0.0);
                output + limit_abs(input - output, most)
            }
        };
        self.output = Some(output);
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_at_the_rate_and_then_follows() {
        let mut limit = RateLimit::new(2.0);
        limit.reset(0.0);
        assert!((limit.step(1.0, 0.25) - 0.5).abs() < 1e-15);
        assert!((limit.step(1.0, 0.25) - 1.0).abs() < 1e-15);
        assert!((limit.step(-9.0, 0.5)).abs() < 1e-15);
        assert!((limit.step(0.1, 0.5) - 0.1).abs() < 1e-15);
    }
}

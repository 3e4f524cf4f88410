//! First-order high pass.

use super::LowPass;

/// First-order high pass: the input minus its low-passed value.
///
/// The filter of the thesis (`lp = 0.8 lp + 0.2 x`, `y = x - lp` at 40 Hz) is
/// the time constant 0.112 s.
///
/// ```
/// use fcc_core::blocks::HighPass;
///
/// let mut filter = HighPass::new(0.112);
/// filter.reset(0.0);
/// // The first sample of a step, of which the thesis' filter passes 0.8.
/// assert!((filter.step(1.0, 0.025) - 0.8).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct HighPass {
    low: LowPass,
}

impl HighPass {
    /// A filter of time constant `tau_s` (s) whose output begins at 0.
    pub const fn new(tau_s: f64) -> Self {
        Self {
            low: LowPass::new(tau_s),
        }
    }

    /// Sets the constant part of the input.
    pub const fn reset(&mut self, constant: f64) {
        self.low.reset(constant);
    }

    /// Processes an input held for `dt_s` seconds; returns the output.
    pub fn step(&mut self, input: f64, dt_s: f64) -> f64 {
        input - self.low.step(input, dt_s)
    }

    /// The same with a [`smoothing_factor`](super::smoothing_factor) that several
    /// filters of one time constant share.
    pub fn step_by(&mut self, input: f64, factor: f64) -> f64 {
        input - self.low.step_by(input, factor)
    }
}

#[cfg(test)]
mod tests {
    use super::super::time_constant;
    use super::*;

    /// The thesis' own function (section 5.6) on `float`, its state kept by
    /// the caller; returns the new state and the output.
    fn thesis_high_pass(input: f32, mut output: f32) -> (f32, f32) {
        const ALPHA: f32 = 0.8;
        output = ALPHA * output + ((1.0 - ALPHA) * input);
        (output, input - output)
    }

    #[test]
    fn the_thesis_filter_is_a_special_case_sample_for_sample() {
        let dt_s = 0.025;
        let mut ours = HighPass::new(time_constant(1.0 - 0.8, dt_s));
        ours.reset(0.0);
        let mut state = 0.0_f32;
        for n in 0..4_000_u16 {
            let input = (f32::from(n) * 0.05).sin() * 3.0 + 9.81;
            let (next, thesis) = thesis_high_pass(input, state);
            state = next;
            let output = ours.step(f64::from(input), dt_s);
            assert!(
                (output - f64::from(thesis)).abs() < 8e-6,
                "sample {n}: {output} against {thesis}"
            );
        }
    }

    #[test]
    fn a_constant_decays() {
        let mut filter = HighPass::new(0.1);
        filter.reset(0.0);
        let first = filter.step(1.0, 0.1);
        // After one time constant, 1/e is left.
        assert!((first - 0.367_879_441).abs() < 1e-9);
        for _ in 0..300 {
            filter.step(1.0, 0.1);
        }
        assert!(filter.step(1.0, 0.1).abs() < 1e-12);
    }
}

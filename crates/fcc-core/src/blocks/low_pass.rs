//! First-order low pass.

use libm::{expm1, log1p};

/// The share of the way that a first-order lag of time constant `tau_s` moves
/// towards its input in `dt_s` seconds, 0..=1: `1 - exp(-dt/τ)`, exact for an
/// input held during the step. A time constant of zero passes the input
/// through.
///
/// ```
/// // A first-order lag has covered 63.2 % of the way after its time constant.
/// let share = fcc_core::blocks::smoothing_factor(0.5, 0.5);
/// assert!((share - 0.632).abs() < 1e-3);
/// ```
pub fn smoothing_factor(dt_s: f64, tau_s: f64) -> f64 {
    if dt_s <= 0.0 {
        0.0
    } else if tau_s <= 0.0 {
        1.0
    } else {
        -expm1(-dt_s / tau_s)
    }
}

/// The time constant in s of a filter known by its factor per sample,
/// `0 < alpha < 1`, and the time between samples: the inverse of
/// [`smoothing_factor`].
///
/// ```
/// // The low pass of the thesis: 0.15 per sample at 40 Hz.
/// let tau_s = fcc_core::blocks::time_constant(0.15, 0.025);
/// assert!((tau_s - 0.154).abs() < 1e-3);
/// ```
pub fn time_constant(alpha: f64, dt_s: f64) -> f64 {
    -dt_s / log1p(-alpha)
}

/// First-order low pass: `y += α (x - y)`, α from a time constant.
///
/// The filter of the thesis (α = 0.15 at 40 Hz) is the time constant 0.154 s.
///
/// ```
/// use fcc_core::blocks::LowPass;
/// let mut filter = LowPass::new(0.5);
/// filter.reset(1.0);
/// let after_one_time_constant = filter.step(0.0, 0.5);
/// assert!((after_one_time_constant - (-1.0_f64).exp()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    tau_s: f64,
    output: Option<f64>,
}

impl LowPass {
    /// A filter of time constant `tau_s` (s, 0 for none) that begins at its
    /// first input.
    pub const fn new(tau_s: f64) -> Self {
        Self {
            tau_s,
            output: None,
        }
    }

    /// Sets the output.
    pub const fn reset(&mut self, output: f64) {
        self.output = Some(output);
    }

    /// Processes an input held for `dt_s` seconds; returns the output.
    pub fn step(&mut self, input: f64, dt_s: f64) -> f64 {
        self.step_by(input, smoothing_factor(dt_s, self.tau_s))
    }

    /// The same with a [`smoothing_factor`] that several filters of one time
    /// constant share.
    pub fn step_by(&mut self, input: f64, factor: f64) -> f64 {
        let output = match self.output {
            None => input,
            Some(output) => output + factor * (input - output),
        };
        self.output = Some(output);
        output
    }

    /// The output, 0 before any input.
    pub fn output(&self) -> f64 {
        self.output.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thesis' own function (section 5.6), which works on `float`.
    fn thesis_low_pass(input: f32, mut output: f32) -> f32 {
        const ALPHA: f32 = 0.15;
        output += ALPHA * (input - output);
        output
    }

    #[test]
    fn the_thesis_filter_is_a_special_case_sample_for_sample() {
        let dt_s = 0.025;
        let mut ours = LowPass::new(time_constant(0.15, dt_s));
        ours.reset(0.0);
        let mut thesis = 0.0_f32;
        let mut state = 12_345_u32;
        for n in 0..4_000 {
            // A step, then noise from a linear congruential generator.
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (state >> 8) as f32 / 16_777_216.0 - 0.5;
            let input = if n < 100 { 9.81 } else { 9.81 + noise };
            thesis = thesis_low_pass(input, thesis);
            let output = ours.step(f64::from(input), dt_s);
            // f32 has 24 bits: 9.81 is accurate to about 1e-6.
            assert!(
                (output - f64::from(thesis)).abs() < 4e-6,
                "sample {n}: {output} against {thesis}"
            );
        }
    }

    #[test]
    fn time_constant_of_the_thesis() {
        // -0.025 / ln(0.85), by hand.
        assert!((time_constant(0.15, 0.025) - 0.153_828).abs() < 1e-6);
    }

    #[test]
    fn two_half_steps_are_one_step() {
        let (mut one, mut two) = (LowPass::new(0.3), LowPass::new(0.3));
        one.reset(0.0);
        two.reset(0.0);
        one.step(1.0, 0.1);
        two.step(1.0, 0.05);
        two.step(1.0, 0.05);
        assert!((one.output() - two.output()).abs() < 1e-15);
    }

    #[test]
    fn a_step_of_no_duration_changes_nothing() {
        let mut filter = LowPass::new(0.3);
        filter.reset(2.0);
        assert_eq!(filter.step(100.0, 0.0), 2.0);
    }
}

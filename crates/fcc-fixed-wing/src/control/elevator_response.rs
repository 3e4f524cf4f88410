//! The latency between the elevator command and its effect, from the flight itself.

mod regression;

use regression::{Motion, Sums};

use fcc_core::blocks::{HighPass, LowPass, smoothing_factor};

/// The number of delays compared, one sample each.
const DELAYS: usize = 12;
/// Samples are at least this far apart, s.
const LEAST_PERIOD_S: f64 = 0.02;
/// After a longer gap the memory begins anew, s.
const LONGEST_PERIOD_S: f64 = 0.3;
/// Slower changes are left out, s: they are trim.
const SLOW_S: f64 = 2.0;
/// Faster ones are smoothed, s: the difference of two noisy rates is mostly noise.
const FAST_S: f64 = 0.05;
/// The time over which is averaged, s.
const MEMORY_S: f64 = 10.0;
/// Samples between two comparisons.
const COMPARED_EVERY: u32 = 20;
/// Samples before the first comparison.
const FIRST_AFTER: u32 = 120;
/// Samples in which the filters settle: they do not count.
const SETTLES_FOR: u32 = 40;
/// A smaller mean square of the pitch acceleration, (rad/s²)², says nothing.
const LEAST_MOTION: f64 = 4e-4;
/// Nor does a smaller mean square of the elevator (1 % of its travel): the loops move it by
/// the noise of the rates, which is in the acceleration, too, and seems to follow it late. By
/// raw sensors in calm air it is 4e-5 at most, in light gusts 1e-3; a latency that matters
/// makes the loops move it more.
const LEAST_MOVED: f64 = 1e-4;
/// The part of the acceleration that the elevator must explain.
const LEAST_EXPLAINED: f64 = 0.2;
/// Another delay is believed if it leaves less than this part of what the
/// present one leaves unexplained.
const BETTER: f64 = 0.94;
/// The part of a change that is adopted at each comparison.
const ADOPTED: f64 = 0.25;

/// The part of a signal between trim and noise. Of a linear model every signal may
/// pass the same filter (Ljung 1999, section 7.4).
#[derive(Clone, Copy, Debug)]
struct BandPass {
    fast: LowPass,
    slow: HighPass,
}

impl BandPass {
    const fn new() -> Self {
        Self {
            fast: LowPass::new(FAST_S),
            slow: HighPass::new(SLOW_S),
        }
    }

    fn step(&mut self, input: f64, factors: &BandFactors) -> f64 {
        let smoothed = self.fast.step_by(input, factors.fast);
        self.slow.step_by(smoothed, factors.slow)
    }
}

/// The smoothing factors of every [`BandPass`] in a step.
#[derive(Clone, Copy, Debug)]
struct BandFactors {
    fast: f64,
    slow: f64,
}

impl BandFactors {
    fn over(period_s: f64) -> Self {
        Self {
            fast: smoothing_factor(period_s, FAST_S),
            slow: smoothing_factor(period_s, SLOW_S),
        }
    }
}

/// Measures the latency between the elevator command and its effect: of some
/// delays the one whose elevator explains the pitch acceleration best.
///
/// A model is q̇ = a q + b n + c δ, the short period (Etkin and Reid 1996, section
/// 6.3) with the load n for the angle of attack: it is proportional to it in gusts,
/// too. It is fitted by least squares with exponential forgetting (Åström and
/// Wittenmark 1995, section 2.2). A servo's lag appears as delay. Flight in which
/// the elevator has no visible effect, calm or in turbulence, changes nothing. A
/// delay is eleven samples at most.
///
/// ```
/// use fcc_fixed_wing::control::ElevatorResponse;
///
/// // Until something has been measured, the latency is the assumed one.
/// let response = ElevatorResponse::new(0.025);
/// assert_eq!(response.latency_s(), 0.025);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ElevatorResponse {
    assumed_s: f64,
    latency_s: f64,
    /// The delay in samples that is believed.
    believed: f64,
    /// Since the last sample, s.
    elapsed_s: f64,
    /// Mean time between samples, s.
    period_s: f64,
    samples: u32,
    before: (f64, f64),
    rate: BandPass,
    load: BandPass,
    acceleration: BandPass,
    motion: Motion,
    command: BandPass,
    /// The last commands between trim and noise, the latest first.
    recent: [f64; DELAYS + 1],
    sums: [Sums; DELAYS],
}

impl ElevatorResponse {
    /// Nothing measured yet: `assumed_s` is the latency until then, s.
    pub fn new(assumed_s: f64) -> Self {
        Self {
            assumed_s,
            latency_s: assumed_s,
            believed: 0.0,
            elapsed_s: 0.0,
            period_s: LEAST_PERIOD_S,
            samples: 0,
            before: (0.0, 0.0),
            rate: BandPass::new(),
            load: BandPass::new(),
            acceleration: BandPass::new(),
            motion: Motion::default(),
            command: BandPass::new(),
            recent: [0.0; DELAYS + 1],
            sums: [Sums::default(); DELAYS],
        }
    }

    /// Forgets what was measured.
    pub fn reset(&mut self) {
        *self = Self::new(self.assumed_s);
    }

    /// The time from a command to its effect, s.
    pub const fn latency_s(&self) -> f64 {
        self.latency_s
    }

    /// One step with the elevator command of the previous step, and the pitch rate
    /// (rad/s) and the load (m/s² or g) that were measured.
    pub fn step(&mut self, elevator: f64, rate: f64, load: f64, dt_s: f64) {
        self.elapsed_s += dt_s;
        if self.elapsed_s < LEAST_PERIOD_S - 1e-6 || rate.to_bits() == self.before.0.to_bits() {
            return;
        }
        let period_s = core::mem::take(&mut self.elapsed_s);
        let (rate_before, load_before) = core::mem::replace(&mut self.before, (rate, load));
        if self.samples == 0 || period_s > LONGEST_PERIOD_S {
            *self = Self {
                latency_s: self.latency_s,
                believed: self.believed,
                period_s,
                samples: 1,
                before: (rate, load),
                ..Self::new(self.assumed_s)
            };
            return;
        }
        self.samples = self.samples.saturating_add(1);
        self.period_s += 0.1 * (period_s - self.period_s);
        let acceleration = (rate - rate_before) / period_s;
        let factors = BandFactors::over(period_s);
        let acceleration = self.acceleration.step(acceleration, &factors);
        // The rate's noise is in the difference, too: with the later one it would
        // seem to explain it.
        let rate = self.rate.step(rate_before, &factors);
        let load = self.load.step(0.5 * (load_before + load), &factors);
        let moved = [rate, load, acceleration];
        self.remember(elevator, moved, &factors, period_s);
        if self.samples >= FIRST_AFTER && self.samples.is_multiple_of(COMPARED_EVERY) {
            self.compare();
        }
    }

    fn remember(&mut self, elevator: f64, moved: [f64; 3], factors: &BandFactors, period_s: f64) {
        let new = if self.samples > SETTLES_FOR {
            period_s / MEMORY_S
        } else {
            0.0
        };
        self.motion.add(moved, new);
        self.recent.rotate_right(1);
        if let Some(first) = self.recent.first_mut() {
            *first = self.command.step(elevator, factors);
        }
        // The latest cannot have acted yet; and noise of the rate is in
        // both, so that it would seem to.
        let late = self.recent.iter().skip(1);
        for (sums, position) in self.sums.iter_mut().zip(late) {
            sums.add(*position, moved, new);
        }
    }

    /// Compares the delays, and follows the one that is believed.
    fn compare(&mut self) {
        let explained = self.motion.explains();
        let mut present = explained.left;
        let (mut left, mut best) = (explained.left, 0.0);
        let mut delay = 0.0;
        for sums in &self.sums {
            delay += 1.0;
            let left_with = explained.left_with(sums);
            if left_with < left {
                (left, best) = (left_with, delay);
            }
            if delay == self.believed {
                present = left_with;
            }
        }
        let moves = self
            .sums
            .first()
            .is_some_and(|sums| sums.mean_square() > LEAST_MOVED);
        let is_seen = moves
            && explained.left > LEAST_MOTION
            && explained.left - left > LEAST_EXPLAINED * explained.left;
        // The longest delay may stand for any longer one.
        if is_seen && left < BETTER * present && best < DELAYS as f64 {
            self.believed = best;
        }
        if self.believed > 0.0 {
            self.latency_s += ADOPTED * (self.believed * self.period_s - self.latency_s);
        }
    }
}

//! The latency and the play between the elevator command and its effect, from
//! the flight itself.

mod regression;

use regression::{Motion, Sums};

use fcc_core::blocks::{HighPass, LowPass, smoothing_factor};

/// The number of delays compared, one sample each.
const DELAYS: usize = 12;
/// The widths of play compared, in the elevator's units of -1 to 1.
const PLAYS: [f64; 4] = [0.0, 0.06, 0.09, 0.12];
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
/// Another model is believed if it leaves less than this part of what the
/// present one leaves unexplained.
const BETTER: f64 = 0.94;
/// One with play, if it is better than the best one without, and the elevator explains at
/// least this part of all.
const PLAY_EXPLAINS: f64 = 0.25;
/// And does so for as long, s: one manoeuvre may be explained by chance.
const PLAY_AFTER_S: f64 = 1.0;
/// A delay of more samples than this is not believed while a model with play leaves
/// less than this part of what it does.
const LONG_DELAY: f64 = 6.0;
const PLAY_MAY_BE: f64 = 1.05;
/// Play is no longer believed if a model without it leaves less than this part.
const NO_PLAY_IS_BETTER: f64 = 0.9;
/// And does so for as long, s: a gust moves the aircraft without the elevator,
/// but play does not go away in flight. Twice the memory.
const NO_PLAY_AFTER_S: f64 = 2.0 * MEMORY_S;
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

/// A surface that moves only after its command has crossed the play.
#[derive(Clone, Copy, Debug)]
struct PlayedCommand {
    half_width: f64,
    /// Where the surface may be, the least and the most: the play is crossed after
    /// the command has moved by its width.
    within: (f64, f64),
    band: BandPass,
    /// The last positions between trim and noise, the latest first.
    recent: [f64; DELAYS + 1],
    sums: [Sums; DELAYS],
}

/// Measures the latency and the play between the elevator command and its
/// effect: of a small bank of models, each with a delay and a width of play,
/// the one whose elevator explains the pitch acceleration best.
///
/// A model is q̇ = a q + b n + c δ, the short period (Etkin and Reid 1996, section
/// 6.3) with the load n for the angle of attack: it is proportional to it in gusts,
/// too. It is fitted by least squares with exponential forgetting (Åström and
/// Wittenmark 1995, section 2.2). A servo's lag appears as delay. Flight in which
/// the elevator has no visible effect, calm or in turbulence, changes nothing. A
/// play is 0.12 at most, a delay eleven samples.
///
/// ```
/// use fcc_fixed_wing::control::ElevatorResponse;
///
/// // Until something has been measured, the latency is the assumed one.
/// let response = ElevatorResponse::new(0.025);
/// assert_eq!((response.latency_s(), response.play()), (0.025, 0.0));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ElevatorResponse {
    assumed_s: f64,
    latency_s: f64,
    play: f64,
    /// The width of play and the delay in samples of the model that is believed.
    believed: (f64, f64),
    /// For how long a model without play has been better than the believed one with it, s.
    without_play_s: f64,
    /// For how long a model with play has been better than one without, s.
    with_play_s: f64,
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
    plays: [PlayedCommand; PLAYS.len()],
}

impl ElevatorResponse {
    /// Nothing measured yet: `assumed_s` is the latency until then, s.
    pub fn new(assumed_s: f64) -> Self {
        Self {
            assumed_s,
            latency_s: assumed_s,
            play: 0.0,
            believed: (0.0, 0.0),
            without_play_s: 0.0,
            with_play_s: 0.0,
            elapsed_s: 0.0,
            period_s: LEAST_PERIOD_S,
            samples: 0,
            before: (0.0, 0.0),
            rate: BandPass::new(),
            load: BandPass::new(),
            acceleration: BandPass::new(),
            motion: Motion::default(),
            plays: PLAYS.map(|width| PlayedCommand {
                half_width: 0.5 * width,
                within: (0.0, 0.0),
                band: BandPass::new(),
                recent: [0.0; DELAYS + 1],
                sums: [Sums::default(); DELAYS],
            }),
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

    /// The width of the play, in the elevator's units.
    pub const fn play(&self) -> f64 {
        self.play
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
                play: self.play,
                believed: self.believed,
                period_s,
                samples: 1,
                before: (rate, load),
                ..Self::new(self.assumed_s)
            };
            for play in &mut self.plays {
                play.within = (elevator - play.half_width, elevator + play.half_width);
            }
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
        for play in &mut self.plays {
            let (least, most) = (elevator - play.half_width, elevator + play.half_width);
            let inside = |position: f64| position.max(least).min(most);
            play.within = (inside(play.within.0), inside(play.within.1));
            let latest = play
                .band
                .step(0.5 * (play.within.0 + play.within.1), factors);
            play.recent.rotate_right(1);
            if let Some(first) = play.recent.first_mut() {
                *first = latest;
            }
            // The latest cannot have acted yet; and noise of the rate is in
            // both, so that it would seem to.
            let late = play.recent.iter().skip(1);
            for (sums, position) in play.sums.iter_mut().zip(late) {
                sums.add(*position, moved, new);
            }
        }
    }

    /// Compares the models, and follows the one that is believed.
    fn compare(&mut self) {
        let explained = self.motion.explains();
        let (believed_width, believed_delay) = self.believed;
        let mut present = explained.left;
        let nothing = (explained.left, 0.0, 0.0);
        let (mut with_play, mut without) = (nothing, nothing);
        for (play, width) in self.plays.iter().zip(PLAYS) {
            let best = if width > 0.0 {
                &mut with_play
            } else {
                &mut without
            };
            let mut delay = 0.0;
            for sums in &play.sums {
                delay += 1.0;
                let left = explained.left_with(sums);
                if left < best.0 {
                    *best = (left, width, delay);
                }
                if width == believed_width && delay == believed_delay {
                    present = left;
                }
            }
        }
        let has_play = with_play.0 < BETTER * without.0
            && with_play.0 < (1.0 - PLAY_EXPLAINS) * explained.left;
        let between_s = f64::from(COMPARED_EVERY) * self.period_s;
        self.with_play_s = if has_play {
            self.with_play_s + between_s
        } else {
            0.0
        };
        self.without_play_s = if without.0 < NO_PLAY_IS_BETTER * present {
            self.without_play_s + between_s
        } else {
            0.0
        };
        let had_play = believed_width > 0.0 && self.without_play_s < NO_PLAY_AFTER_S;
        let (left, width, delay) = if self.with_play_s >= PLAY_AFTER_S || had_play {
            with_play
        } else {
            without
        };
        let command = self.plays.first().and_then(|play| play.sums.first());
        let moves = command.is_some_and(|sums| sums.mean_square() > LEAST_MOVED);
        let is_seen = moves
            && explained.left > LEAST_MOTION
            && explained.left - left > LEAST_EXPLAINED * explained.left;
        // A play that is seldom crossed looks like a long delay.
        let may_be_play = width == 0.0
            && delay > LONG_DELAY
            && with_play.2 < delay
            && with_play.0 < PLAY_MAY_BE * left;
        // The longest delay may stand for any longer one.
        if is_seen && left < BETTER * present && delay < DELAYS as f64 && !may_be_play {
            self.believed = (width, delay);
        }
        let (width, delay) = self.believed;
        if delay > 0.0 {
            self.latency_s += ADOPTED * (delay * self.period_s - self.latency_s);
            self.play += ADOPTED * (width - self.play);
        }
    }
}

//! A monitor of oscillations, and the gain it takes out of the loops.

use fcc_core::blocks::{HighPass, smoothing_factor};
use fcc_core::flight::Surfaces;
use fcc_navigation::Estimate;

/// The half-periods of 5 and 0.3 Hz, s.
const SHORTEST_S: f64 = 0.1;
const LONGEST_S: f64 = 1.67;
/// Slower changes are left out, s.
const SLOW_S: f64 = 0.5;
/// The least amplitude of the body rate, rad/s (4 °/s).
const LEAST_RADPS: f64 = 0.07;
/// The least mean deflection of the surface, of 1.
const LEAST_DEFLECTION: f64 = 0.02;
/// The half-periods, and the amplitudes, of consecutive half-cycles differ by
/// less than this part.
const ALIKE: f64 = 0.3;
/// Of consecutive half-cycles that are alike, so many are an oscillation.
const OSCILLATES_AFTER: u32 = 6;
/// A half-cycle that is longer than this, s (0.8 Hz), is not the latency's:
/// less gain would make it larger, since the loops also have a least gain.
const TOO_SLOW_S: f64 = 0.625;
/// The part of the gain that stays at each further half-cycle.
const KEPT: f64 = 0.85;
/// The least part of the loops' bandwidth: with less, the outer loops are no longer
/// slower than the inner ones.
pub const LEAST_PACE: f64 = 0.35;
/// Gain is given back after this time without an oscillation, s.
const QUIET_S: f64 = 5.0;
/// How fast it is given back, 1/s.
const GIVEN_BACK_PER_S: f64 = 0.02;

/// The half-cycles of one axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    rate: HighPass,
    command: HighPass,
    is_positive: bool,
    lasted_s: f64,
    peak: f64,
    /// The integral of the deflection, and of its product with the rate.
    deflection: f64,
    opposition: f64,
    before: (f64, f64),
    alike: u32,
}

impl Axis {
    const fn new() -> Self {
        Self {
            rate: HighPass::new(SLOW_S),
            command: HighPass::new(SLOW_S),
            is_positive: false,
            lasted_s: 0.0,
            peak: 0.0,
            deflection: 0.0,
            opposition: 0.0,
            before: (0.0, 0.0),
            alike: 0,
        }
    }

    /// The half-period, s, of a half-cycle that ends an oscillation's row.
    fn step(&mut self, rate_radps: f64, command: f64, dt_s: f64) -> Option<f64> {
        let factor = smoothing_factor(dt_s, SLOW_S);
        let rate = self.rate.step_by(rate_radps, factor);
        let command = self.command.step_by(command, factor);
        self.lasted_s += dt_s;
        if self.lasted_s > LONGEST_S {
            self.alike = 0;
        }
        if (rate > 0.0) == self.is_positive || self.lasted_s < SHORTEST_S {
            self.peak = self.peak.max(rate.abs());
            self.deflection += command.abs() * dt_s;
            self.opposition -= command * rate * dt_s;
            return None;
        }
        let (lasted_s, peak) = (self.lasted_s, self.peak);
        let (lasted_before_s, peak_before) = core::mem::replace(&mut self.before, (lasted_s, peak));
        let is_alike = lasted_s <= LONGEST_S
            && peak >= LEAST_RADPS
            && self.deflection >= LEAST_DEFLECTION * lasted_s
            && self.opposition > 0.0
            && (lasted_s - lasted_before_s).abs() <= ALIKE * lasted_before_s
            && peak >= (1.0 - ALIKE) * peak_before;
        self.alike = if is_alike { self.alike + 1 } else { 0 };
        self.is_positive = !self.is_positive;
        (self.lasted_s, self.peak) = (0.0, 0.0);
        (self.deflection, self.opposition) = (0.0, 0.0);
        (self.alike >= OSCILLATES_AFTER).then_some(lasted_s)
    }
}

/// Sees an oscillation of pitch or roll, and takes gain out of the loops.
///
/// An oscillation is a row of half-cycles of a body rate of at least 4 °/s,
/// between 0.3 and 5 Hz, alike in length, not decaying, in which the surface
/// moves against the rate. Each further half-cycle of more than 0.8 Hz takes
/// 15 % of the bandwidth; it is given back by 2 % per second after 5 s without.
///
/// ```
/// use fcc_fixed_wing::control::OscillationMonitor;
///
/// let monitor = OscillationMonitor::new();
/// assert!(!monitor.is_oscillating());
/// assert_eq!(monitor.pace(), 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OscillationMonitor {
    pitch: Axis,
    roll: Axis,
    pace: f64,
    /// Since the last half-cycle of an oscillation, s.
    quiet_s: f64,
}

impl Default for OscillationMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl OscillationMonitor {
    /// Nothing oscillates.
    pub const fn new() -> Self {
        Self {
            pitch: Axis::new(),
            roll: Axis::new(),
            pace: 1.0,
            quiet_s: QUIET_S,
        }
    }

    /// One step with the outputs of the previous step.
    pub fn step(&mut self, sent: &Surfaces, estimate: &Estimate, dt_s: f64) {
        let rates = estimate.body_rates;
        self.quiet_s += dt_s;
        if self.quiet_s > QUIET_S {
            self.pace = (self.pace + GIVEN_BACK_PER_S * dt_s).min(1.0);
        }
        let pitch = self.pitch.step(rates.pitch_radps, sent.elevator, dt_s);
        let roll = self.roll.step(rates.roll_radps, sent.aileron, dt_s);
        for half_s in [pitch, roll].into_iter().flatten() {
            self.quiet_s = 0.0;
            if half_s <= TOO_SLOW_S {
                self.pace = (KEPT * self.pace).max(LEAST_PACE);
            }
        }
    }

    /// Whether something oscillates, or did in the last five seconds.
    pub fn is_oscillating(&self) -> bool {
        self.quiet_s < QUIET_S
    }

    /// The part of the loops' bandwidth that is left, 0.35..=1.
    pub const fn pace(&self) -> f64 {
        self.pace
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::flight::BodyRates;

    /// A sine of the pitch rate, °/s, with the elevator against it.
    fn after(seconds: u32, frequency_hz: f64, amplitude_degps: f64) -> OscillationMonitor {
        let mut monitor = OscillationMonitor::new();
        for tick in 0..seconds * 40 {
            let angle = core::f64::consts::TAU * frequency_hz * f64::from(tick) * 0.025;
            let pitch_radps = amplitude_degps.to_radians() * libm::sin(angle);
            let estimate = Estimate {
                body_rates: BodyRates {
                    pitch_radps,
                    ..BodyRates::default()
                },
                ..Estimate::default()
            };
            let sent = Surfaces {
                elevator: -pitch_radps,
                ..Surfaces::default()
            };
            monitor.step(&sent, &estimate, 0.025);
        }
        monitor
    }

    #[test]
    fn a_fast_oscillation_takes_gain_and_a_slow_one_is_reported_only() {
        let fast = after(6, 1.5, 12.0);
        assert!(fast.is_oscillating());
        assert!(fast.pace() < 0.5);
        let slow = after(12, 0.5, 12.0);
        assert!(slow.is_oscillating());
        assert_eq!(slow.pace(), 1.0);
    }

    #[test]
    fn small_motion_is_no_oscillation() {
        assert!(!after(20, 1.5, 3.0).is_oscillating());
    }
}

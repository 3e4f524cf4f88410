//! Elevator trim: takes over what the elevator holds steadily.

use fcc_core::blocks::{LowPass, limit, limit_abs};

/// The time constant of the elevator's mean, s: longer than the short period,
/// so that turbulence does not move the trim.
const MEAN_TAU_S: f64 = 1.0;
/// The trim begins to move when the elevator's mean was beyond the first for
/// [`AFTER_S`], and stops when it is within the second.
const HELD: (f64, f64) = (0.05, 0.01);
const AFTER_S: f64 = 3.0;
/// In steady flight the elevator's mean decays with this time constant, s, at
/// most as fast as this, 1/s: an electric trim takes some 40 s from stop to
/// stop, and the pitch loops follow it without a bump.
const TAU_S: f64 = 3.0;
const RATE_PER_S: f64 = 0.05;
/// The same before a release.
const QUICK_TAU_S: f64 = 1.5;
const QUICK_RATE_PER_S: f64 = 0.12;
/// The time constant of the elevator's mean before a release, s.
const QUICK_MEAN_TAU_S: f64 = 0.3;

/// The command is at most this and one second of its rate from the measured
/// trim: a trim that stands still or runs away does not move far when it is free
/// again.
const REACH: f64 = 0.05;
const REACH_S: f64 = 1.0;
/// A trim that is farther than the first from its command, and has not come
/// nearer by the second for so long, does not follow.
const AWAY: f64 = 0.04;
const NEARER: f64 = 0.02;
const FOR_S: f64 = 3.0;

/// How the trim may move.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Trimming {
    /// It stays.
    Held,
    /// Steady flight: it follows what the elevator holds for some seconds.
    Steady,
    /// Before a release: it follows at once.
    Quick,
}

/// Moves the elevator's trim until the elevator is neutral: hands off, the
/// aircraft then keeps its airspeed. The elevator is given back through the
/// loops, whatever the trim's effect is.
///
/// ```
/// use fcc_fixed_wing::control::{ElevatorTrim, Trimming};
///
/// let mut trim = ElevatorTrim::new(Some(0.1));
/// // The elevator and the trim together hold 0.3.
/// for _ in 0..40 * 20 {
///     let elevator = 0.3 - trim.position().unwrap_or(0.0);
///     trim.step(elevator, trim.position(), Trimming::Steady, 0.025);
/// }
/// assert!((trim.position().unwrap_or(0.0) - 0.3).abs() < 0.02);
/// // One that is stuck is not commanded far away, and is reported.
/// for _ in 0..40 * 10 {
///     trim.step(-0.2, Some(0.4), Trimming::Steady, 0.025);
/// }
/// assert!(trim.does_not_follow());
/// assert!((trim.position().unwrap_or(0.0) - 0.35).abs() < 1e-9);
/// // An aircraft without a trim, or whose trim is not measured, keeps it.
/// let mut none = ElevatorTrim::new(None);
/// none.step(0.3, None, Trimming::Quick, 0.025);
/// assert_eq!(none.position(), None);
/// ```
#[derive(Clone, Debug)]
pub struct ElevatorTrim {
    position: Option<f64>,
    mean: LowPass,
    held_s: f64,
    /// Where the measured trim was when it last came nearer to the command, or
    /// farthest from it since, and for how long it has not come nearer, s.
    from: f64,
    away_s: f64,
}

impl ElevatorTrim {
    /// At a position, -1..=1; none if there is no trim or it is not measured.
    pub const fn new(position: Option<f64>) -> Self {
        Self {
            position,
            mean: LowPass::new(MEAN_TAU_S),
            held_s: 0.0,
            from: 0.0,
            away_s: 0.0,
        }
    }

    /// Takes over a measured position; one without a trim stays without.
    pub const fn take_over(&mut self, position: Option<f64>) {
        if self.position.is_some() && position.is_some() {
            self.position = position;
        }
    }

    /// The position to be commanded, -1..=1.
    pub const fn position(&self) -> Option<f64> {
        self.position
    }

    /// What the elevator holds in the mean, -1..=1.
    pub fn held(&self) -> f64 {
        self.mean.output()
    }

    /// Whether the measured trim does not move when it is commanded to, or moves
    /// by itself.
    pub fn does_not_follow(&self) -> bool {
        self.away_s >= FOR_S
    }

    /// One step with the elevator, -1..=1, that was commanded last, and with the
    /// measured trim: while it is not measured, or does not follow, the trim is
    /// not moved farther.
    pub fn step(&mut self, elevator: f64, measured: Option<f64>, trimming: Trimming, dt_s: f64) {
        let is_quick = trimming == Trimming::Quick;
        let faster = if is_quick {
            MEAN_TAU_S / QUICK_MEAN_TAU_S
        } else {
            1.0
        };
        let mean = self.mean.step(elevator, faster * dt_s);
        let rate_per_s = self.rate_per_s(mean, trimming, dt_s);
        let (Some(measured), Some(position)) = (measured, self.position) else {
            self.away_s = 0.0;
            return;
        };
        self.compare(measured, position, dt_s);
        let is_farther = rate_per_s * (position - measured) > 0.0;
        let rate_per_s = if self.does_not_follow() && is_farther {
            0.0
        } else {
            rate_per_s
        };
        let reach = REACH + rate_per_s.abs() * REACH_S;
        let near = limit(
            position + rate_per_s * dt_s,
            measured - reach,
            measured + reach,
        );
        self.position = Some(limit(near, -1.0, 1.0));
    }

    /// The rate that the mean of the elevator asks for, 1/s.
    fn rate_per_s(&mut self, mean: f64, trimming: Trimming, dt_s: f64) -> f64 {
        let (begins, ends) = HELD;
        match trimming {
            Trimming::Held => {
                self.held_s = 0.0;
                0.0
            }
            Trimming::Steady => {
                if mean.abs() < ends {
                    self.held_s = 0.0;
                } else if mean.abs() > begins || self.held_s > AFTER_S {
                    self.held_s += dt_s;
                }
                if self.held_s <= AFTER_S {
                    return 0.0;
                }
                limit_abs(mean / TAU_S, RATE_PER_S)
            }
            Trimming::Quick => limit_abs(mean / QUICK_TAU_S, QUICK_RATE_PER_S),
        }
    }

    /// Compares the measured trim with its command.
    fn compare(&mut self, measured: f64, command: f64, dt_s: f64) {
        let away = command - measured;
        let nearer = (measured - self.from) * away.signum();
        if away.abs() < AWAY || nearer > NEARER {
            self.from = measured;
            self.away_s = 0.0;
        } else {
            if nearer < 0.0 {
                self.from = measured;
            }
            self.away_s += dt_s;
        }
    }
}

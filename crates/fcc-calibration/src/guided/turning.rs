//! A gyroscope, left alone and then turned between positions at rest.

use core::time::Duration;

use nalgebra::Matrix3;

use super::gyroscope::AtRest;
use super::path::{LONGEST_STEP_S, Path, Turns};
use super::readings::Arrived;
use super::rest::{Halves, Rest};
use super::{Collect, Found, Next, Quality, Refusal, Values, between, difference, norm, unit};
use crate::turning::{Normal, Turn, UNKNOWNS, fit_turns};
use crate::{Axes, AxesCalibration, Rotation};
use fcc_core::units::GRAVITY_MPS2;

/// For how long it lies still between turns.
const LENGTH: Duration = Duration::from_secs(2);
/// From the first half of it to the second, m/s²: a tilt of 0.3°.
pub(super) const MOVED_MPS2: f64 = 0.05;
/// A bias that changes by more meanwhile is a slow turn, rad/s: 0.5°/s.
const DRIFTED_RADPS: f64 = 8.7e-3;
/// By how much the strength may differ from gravity: of a calibrated sensor at
/// rest a tenth of it.
pub(super) const STRENGTH_SHARE: f64 = 0.03;
/// A smaller turn is no turn, rad: 17°.
const LEAST_TURN_RAD: f64 = 0.3;
/// The standard deviation of each unknown that is enough, of that of an angle
/// between two directions of gravity, rad: with 0.3° it is 0.3 %.
const ENOUGH: f64 = 0.5;
/// The same before anything is known: far more than enough.
const UNKNOWN: f64 = 10.0;
/// The largest error of scale and misalignment that is accepted: 0.5 %.
const LARGEST_SIGMA: f64 = 0.005;
/// The share of the bias in all that is to be done.
const BIAS_SHARE: f64 = 0.2;
/// A suggested turn that leaves more than this share of the variance does not help.
const HELPS: f64 = 0.8;
/// About an axis that is farther from the vertical, by its cosine: 45°.
const HORIZONTAL: f64 = 0.7;
/// Steps of a suggested half turn.
const SUGGESTED: usize = 32;

/// Collects the turns of a gyroscope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    /// From what the accelerometer gives to the gyroscope's axes.
    accelerometer: AxesCalibration,
    alone: AtRest,
    /// Where up was in the last position at rest, and what the gyroscope gave.
    position: Option<Position>,
    force: Halves<3>,
    rates: Halves<3>,
    /// Whether the present rest has been long enough.
    is_settled: bool,
    path: Path,
    turns: Turns,
    /// What the turns tell, and what is known without them.
    information: Normal,
    known: [f64; 3],
    suggested: Next,
    interruptions: u32,
    /// Whether readings were missing in a turn.
    had_gap: bool,
}

#[derive(Clone, Copy, Debug)]
struct Position {
    up: [f64; 3],
    bias_radps: [f64; 3],
}

impl Turning {
    pub(super) fn new(accelerometer: &Axes, turn: &Rotation) -> Self {
        let to_gyroscope = turn.back().after(&accelerometer.turn());
        Self {
            accelerometer: AxesCalibration::turned(accelerometer, &to_gyroscope),
            alone: AtRest::new(),
            position: None,
            force: Halves::new(LENGTH),
            rates: Halves::new(LENGTH),
            is_settled: false,
            path: Path::default(),
            turns: Turns::new(),
            information: Normal::from_diagonal_element(1.0 / (UNKNOWN * UNKNOWN)),
            known: [0.0; 3],
            suggested: Next::LeaveAlone,
            interruptions: 0,
            had_gap: false,
        }
    }

    /// How much of what is needed is known of turns about each axis.
    pub(super) const fn known(&self) -> [f64; 3] {
        self.known
    }

    fn is_known(&self) -> bool {
        self.known == [1.0; 3] || self.turns.is_full()
    }

    /// A position at rest was held long enough.
    fn settle(&mut self, position: Position) {
        let before = self.position.replace(position);
        let path = core::mem::take(&mut self.path);
        let Some(before) = before else { return };
        let is_turn = path.turned_rad() >= LEAST_TURN_RAD
            || between(before.up, position.up) >= LEAST_TURN_RAD;
        if !is_turn {
            return;
        }
        self.had_gap |= path.has_gap();
        // What it gives at rest changes evenly.
        let drift = difference(position.bias_radps, before.bias_radps).map(|by| 0.5 * by);
        if let Some(turn) = self.turns.keep(before.up, position.up, &path, drift) {
            let (more, _, _) = turn.equations(&Matrix3::identity());
            self.information += more;
            self.known = known(&self.information);
        }
        self.suggested = suggestion(&self.information, position.up);
    }

    fn begin_rest(&mut self) {
        self.force.clear();
        self.rates.clear();
    }

    fn is_interrupted(&mut self) {
        self.interruptions += u32::from(self.force.has_begun() && !self.is_settled);
        self.is_settled = false;
        self.begin_rest();
    }
}

impl Collect for Turning {
    fn take(&mut self, arrived: &Arrived, rest: &Rest) {
        let arrived = Arrived {
            force: arrived.force.map(|force| self.accelerometer.applied(force)),
            ..*arrived
        };
        if !self.alone.is_complete() {
            self.alone.take(&arrived, rest);
            if let Some((force, bias_radps)) = self.alone.means() {
                let up = unit(force);
                self.settle(Position { up, bias_radps });
                self.suggested = suggestion(&self.information, up);
                self.is_settled = true;
            }
            return;
        }
        if let (Some(rates), Some(position)) = (arrived.rates, self.position) {
            self.path.take(rates, position.bias_radps, arrived.rates_at);
        }
        if !rest.is_given() {
            self.is_interrupted();
            return;
        }
        if let Some(force) = arrived.force {
            self.force.take(force, arrived.at);
        }
        if let Some(rates) = arrived.rates {
            self.rates.take(rates, arrived.at);
        }
        if !(self.force.is_full() && self.rates.is_full()) {
            return;
        }
        let (force, bias_radps) = (self.force.mean(), self.rates.mean());
        let first = self.alone.means().map_or(bias_radps, |(_, bias)| bias);
        let is_gravity = (norm(force) / GRAVITY_MPS2 - 1.0).abs() <= STRENGTH_SHARE;
        if self.force.change() > MOVED_MPS2
            || norm(difference(bias_radps, first)) > DRIFTED_RADPS
            || !is_gravity
        {
            self.is_interrupted();
            return;
        }
        self.is_settled = true;
        self.begin_rest();
        self.settle(Position {
            up: unit(force),
            bias_radps,
        });
    }

    fn progress(&self) -> f64 {
        if self.is_complete() {
            return 1.0;
        }
        let known = self.known.into_iter().sum::<f64>() / 3.0;
        BIAS_SHARE * self.alone.progress() + (1.0 - BIAS_SHARE) * known
    }

    fn is_complete(&self) -> bool {
        self.alone.is_complete() && (self.alone.finish().is_err() || self.is_known())
    }

    fn next(&self) -> Next {
        match (self.is_complete(), self.force.has_begun(), self.is_settled) {
            (true, ..) => Next::Done,
            _ if !self.alone.is_complete() => Next::LeaveAlone,
            (_, true, false) => Next::LeaveAlone,
            _ => self.suggested,
        }
    }

    fn finish(&self) -> Result<Found, Refusal> {
        let bias = self.alone.finish()?;
        let Values::GyroscopeBias { bias_radps } = bias.values else {
            return Err(Refusal::Silent);
        };
        if !self.is_known() {
            let axes = self.known.into_iter().filter(|known| *known >= 1.0);
            return Err(if self.had_gap {
                Refusal::Gaps {
                    most_s: LONGEST_STEP_S,
                }
            } else {
                Refusal::ended(self.interruptions, axes.count(), 3)
            });
        }
        let fit = fit_turns(&self.turns.each()).ok_or(Refusal::NotTurned)?;
        Ok(Found {
            values: Values::Gyroscope {
                axes: Axes {
                    bias: bias_radps,
                    ..fit.axes
                },
                residual_rad: fit.residual_rad,
                bias_sigma_radps: bias.sigma,
            },
            quality: Quality::within(fit.sigma, LARGEST_SIGMA)?,
            sigma: fit.sigma,
        })
    }
}

/// How much of what is needed is known of turns about each axis.
fn known(information: &Normal) -> [f64; 3] {
    let mut known = [0.0; 3];
    let variances = variances(information);
    for (axis, of_axis) in known.iter_mut().zip(variances.as_chunks::<3>().0) {
        let shares = of_axis.map(|variance| (ENOUGH * ENOUGH / variance).min(1.0));
        *axis = shares.into_iter().sum::<f64>() / 3.0;
    }
    known
}

/// The variances of the unknowns, over that of an angle.
fn variances(information: &Normal) -> [f64; UNKNOWNS] {
    let none = [UNKNOWN * UNKNOWN; UNKNOWNS];
    let inverse = information.try_inverse();
    inverse.map_or(none, |inverse| inverse.diagonal().into())
}

/// The turn from here, about an axis that is about horizontal, that tells most of
/// what is known least; a quarter turn, if none tells anything of it from here.
fn suggestion(information: &Normal, up: [f64; 3]) -> Next {
    let known = variances(information);
    let (worst, variance) = known
        .into_iter()
        .enumerate()
        .fold(
            (0, 0.0),
            |best, (at, other)| {
                if other > best.1 { (at, other) } else { best }
            },
        );
    let mut best = (variance, Next::LeaveAlone);
    let mut most_horizontal = (1.0, 0);
    for ((axis, part), half) in (0..).zip(up).flat_map(|at| [(at, true), (at, false)]) {
        if part.abs() > HORIZONTAL {
            continue;
        }
        if part.abs() < most_horizontal.0 {
            most_horizontal = (part.abs(), axis);
        }
        let angle = core::f64::consts::PI / SUGGESTED as f64;
        let step = [0_u8, 1, 2].map(|of| if of == axis { angle } else { 0.0 });
        let steps = [step; SUGGESTED];
        let (quarter, _) = steps.split_at(SUGGESTED / 2);
        let turn = Turn {
            before: up,
            after: up,
            steps: if half { &steps } else { quarter },
        };
        let (more, _, _) = turn.equations(&Matrix3::identity());
        let after = variances(&(information + more));
        let left = after.into_iter().nth(worst).unwrap_or(variance);
        if left < best.0 {
            best = (left, Next::TurnOver { axis, half });
        }
    }
    if best.0 < HELPS * variance {
        return best.1;
    }
    Next::TurnOver {
        axis: most_horizontal.1,
        half: false,
    }
}

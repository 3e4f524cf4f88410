//! Which axes explain a receiver's velocities best: the filter runs with each.

use fcc_core::flight::inertial::{KalmanConfig, KalmanNavigation, Observation, ObservationKind};
use fcc_core::framework::Time;
use nalgebra::{Matrix3, Vector3};

use super::sources::{Event, Sources};
use super::{Method, Run};

/// A flight begins with this velocity, m/s, and is tried for so long, s, at first and if need
/// be.
const FLYING_MPS: f64 = 5.0;
const FIRST_S: f64 = 90.0;
const TRIED_S: f64 = 300.0;
/// Innovations are compared in pieces of this length, s, of which so many have to be there.
const PIECE_S: f64 = 10.0;
const LEAST_PIECES: usize = 6;
/// A difference of one piece says something beyond this, twice a log-likelihood.
const DIFFERENT: f64 = 1.0;
/// A square in standard deviations counts as this at most, beyond which it is refused.
const REFUSED: f64 = 25.0;
/// Of the pieces that differ so many have to speak for the same.
const MOST: f64 = 2.0 / 3.0;

/// Which sensor has other axes, and the body's from those that were given.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Axes {
    pub(super) sensor: &'static str,
    pub(super) matrix: Matrix3<f64>,
}

/// A flight whose receiver shows velocities.
pub(super) struct Flight<'a> {
    events: &'a [Event],
    steps: &'a [Time],
    first: usize,
    config: KalmanConfig,
}

impl<'a> Flight<'a> {
    pub(super) fn of(sources: &'a Sources, config: KalmanConfig) -> Option<Self> {
        let begin = sources
            .events
            .iter()
            .find_map(|event| match event.observation {
                Observation::Velocity(velocity) if Vector3::from(velocity).norm() > FLYING_MPS => {
                    Some(event.arrived)
                }
                _ => None,
            })?;
        let after = |time_s: f64| Time::from_nanos(begin.as_nanos() + (time_s * 1e9) as i64);
        let (first, end) = (after(FIRST_S), after(TRIED_S));
        let from = |time: Time| sources.events.partition_point(|event| event.arrived < time);
        let step = |time: Time| sources.steps.partition_point(|step| *step < time);
        Some(Self {
            events: sources.events.get(from(begin)..from(end))?,
            steps: sources.steps.get(step(begin)..step(end))?,
            first: step(first) - step(begin),
            config,
        })
    }

    /// Those of other axes that velocities speak for, the best first, each with its trial. Most
    /// are out of question soon.
    pub(super) fn better(&self, others: impl Iterator<Item = Axes>) -> Vec<(Axes, Trial)> {
        let soon = self.first(None);
        let possible: Vec<Axes> = others
            .filter(|axes| !soon.is_better_than(&self.first(Some(*axes))))
            .collect();
        if possible.is_empty() {
            return Vec::new();
        }
        let given = self.tried(None);
        let mut better: Vec<(Axes, Trial)> = possible
            .into_iter()
            .map(|axes| (axes, self.tried(Some(axes))))
            .filter(|(_, trial)| trial.is_better_than(&given))
            .collect();
        better.sort_by(|(_, one), (_, other)| one.total().total_cmp(&other.total()));
        better
    }

    fn first(&self, axes: Option<Axes>) -> Trial {
        self.of_steps(self.steps.get(..self.first).unwrap_or_default(), axes)
    }

    pub(super) fn tried(&self, axes: Option<Axes>) -> Trial {
        self.of_steps(self.steps, axes)
    }

    /// How much the velocities contradict the inertial unit with these axes, in pieces: squares
    /// in standard deviations and the logarithms of these. Without a magnetometer, which may be
    /// turned itself.
    fn of_steps(&self, steps: &[Time], axes: Option<Axes>) -> Trial {
        let events = self.events.iter().filter_map(|event| {
            let observation = match event.observation {
                Observation::MagneticField(_) => return None,
                Observation::Rates(row) => Observation::Rates(turned(row, "gyroscope", axes)),
                Observation::SpecificForce(row) => {
                    Observation::SpecificForce(turned(row, "accelerometer", axes))
                }
                other => other,
            };
            Some(Event {
                observation,
                ..*event
            })
        });
        let events: Vec<Event> = events.collect();
        let navigation = KalmanNavigation::new(self.config);
        let mut run = Run::new(Method::Kalman(Box::new(navigation)));
        run.steps(&events, steps);
        let begin_ns = steps.first().map_or(0, |step| step.as_nanos());
        let mut pieces: Vec<f64> = Vec::new();
        for one in &run.innovations {
            if one.kind != ObservationKind::Velocity {
                continue;
            }
            let since_s = (one.time.as_nanos() - begin_ns) as f64 * 1e-9;
            let at = (since_s / PIECE_S) as usize;
            if pieces.len() <= at {
                pieces.resize(at + 1, 0.0);
            }
            let each = one.difference.iter().zip(one.sigma);
            let cost: f64 = each
                .map(|(apart, sigma)| (apart / sigma).powi(2).min(REFUSED) + 2.0 * sigma.ln())
                .sum();
            if let Some(piece) = pieces.get_mut(at) {
                *piece += cost;
            }
        }
        Trial(pieces)
    }
}

fn turned(row: [f64; 3], sensor: &str, axes: Option<Axes>) -> [f64; 3] {
    match axes {
        Some(axes) if axes.sensor == sensor => (axes.matrix * Vector3::from(row)).into(),
        _ => row,
    }
}

pub(super) struct Trial(Vec<f64>);

impl Trial {
    fn total(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Whether these velocities speak for this, and not for the other: in most of the pieces.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        let apart = || {
            self.0
                .iter()
                .zip(&other.0)
                .map(|(this, other)| other - this)
        };
        let (better, worse) = (
            apart().filter(|apart| *apart > DIFFERENT).count(),
            apart().filter(|apart| *apart < -DIFFERENT).count(),
        );
        let differ = better + worse;
        differ >= LEAST_PIECES
            && better as f64 > MOST * differ as f64
            && self.total() < other.total()
    }
}

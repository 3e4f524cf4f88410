//! Gyroscopes and accelerometers as one series of readings, whatever their rates
//! and times are.

use nalgebra::Vector3;

use super::filter::GAP_S;
use super::history::{History, Sample};
use super::motion::Raw;
use crate::inertial::Observation;
use fcc_core::framework::Time;

/// The latest samples of the inertial sensors. A reading belongs to each sample
/// of the gyroscopes, and the specific force between two samples is
/// interpolated; without gyroscopes to each of the accelerometers; without both
/// to any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    rates: (Time, Vector3<f64>),
    force: (Time, Vector3<f64>),
    last: Raw,
    at: Time,
}

/// From one reading to the next, with the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) reading: Raw,
    pub(super) now: Time,
    pub(super) dt_s: f64,
}

const UNKNOWN: Raw = Raw {
    rates: None,
    force: None,
};

impl Inputs {
    pub(super) fn new() -> Self {
        Self {
            rates: (Time::NEVER, Vector3::zeros()),
            force: (Time::NEVER, Vector3::zeros()),
            last: UNKNOWN,
            at: Time::NEVER,
        }
    }

    /// Takes a sample; the step that it ends, if it does. The samples after it
    /// are those of `later` behind the first `skip`.
    pub(super) fn take(&mut self, sample: &Sample, later: &History, skip: usize) -> Option<Step> {
        let now = sample.taken;
        let reading = match sample.observation {
            Observation::Rates(rates) => {
                self.rates = (now, Vector3::from(rates));
                Raw {
                    rates: Some(self.rates.1),
                    force: self.force_at(now, later, skip),
                }
            }
            Observation::SpecificForce(force) => {
                self.force = (now, Vector3::from(force));
                if is_recent(self.rates.0, now) {
                    return None;
                }
                Raw {
                    rates: None,
                    force: Some(self.force.1),
                }
            }
            _ if is_recent(self.rates.0, now) || is_recent(self.force.0, now) => return None,
            _ => UNKNOWN,
        };
        self.begin(now, reading)
    }

    fn begin(&mut self, now: Time, reading: Raw) -> Option<Step> {
        let dt_s = now.since(self.at).as_secs_f64();
        let is_first = self.at.is_never();
        if !is_first && dt_s <= 0.0 {
            return None;
        }
        self.at = now;
        self.last = if dt_s > GAP_S { UNKNOWN } else { reading };
        (!is_first).then_some(Step {
            reading: self.last,
            now,
            dt_s,
        })
    }

    /// The latest reading, for `dt_s` more to `now`.
    pub(super) fn held(&self, now: Time) -> Option<Step> {
        let dt_s = now.since(self.at).as_secs_f64();
        (!self.at.is_never() && dt_s > 0.0 && dt_s <= GAP_S).then_some(Step {
            reading: self.last,
            now,
            dt_s,
        })
    }

    fn force_at(&self, now: Time, later: &History, skip: usize) -> Option<Vector3<f64>> {
        let (before, force) = self.force;
        let has_before = is_recent(before, now);
        if has_before && before == now {
            return Some(force);
        }
        let next = later
            .after(skip)
            .find_map(|sample| match sample.observation {
                Observation::SpecificForce(next) => Some((sample.taken, Vector3::from(next))),
                _ => None,
            });
        match next {
            Some((after, next)) if is_recent(now, after) => {
                if !has_before {
                    return Some(next);
                }
                let span_s = after.since(before).as_secs_f64();
                let share = now.since(before).as_secs_f64() / span_s.max(1e-9);
                Some(force + (next - force) * share.min(1.0))
            }
            _ => has_before.then_some(force),
        }
    }
}

fn is_recent(then: Time, now: Time) -> bool {
    !then.is_never() && now.since(then).as_secs_f64() <= GAP_S
}

//! The turns of a gyroscope: what it gives, integrated in short steps.

use super::{difference, norm};
use crate::turning::Turn;
use fcc_core::framework::Time;

/// A step ends when it has turned by so much, rad: within it the order of
/// rotations counts less than the gyroscope's noise.
const STEP_RAD: f64 = 0.15;
/// Steps of one turn: a whole one, and a quarter.
const MOST_STEPS: usize = 60;
/// Turns that are kept, and their steps: 27 of each, a half turn has 22.
const MOST_TURNS: usize = 24;
const ALL_STEPS: usize = 640;
/// Readings that are farther apart leave out a part of the turn, s.
pub(super) const LONGEST_STEP_S: f64 = 0.1;

/// A short rotation, and how long it took.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    angle_rad: [f64; 3],
    length_s: f64,
}

/// The rotation since the last rest, without the bias of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    last: Option<(Time, [f64; 3])>,
    steps: [Step; MOST_STEPS],
    /// The one that is being filled.
    at: usize,
    has_gap: bool,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            last: None,
            steps: [Step::default(); MOST_STEPS],
            at: 0,
            has_gap: false,
        }
    }
}

impl Path {
    /// Integrates: between two readings the rate is linear. The rotation vector is
    /// that of Bortz (1971) to the second order.
    pub(super) fn take(&mut self, rates: [f64; 3], bias_radps: [f64; 3], at: Time) {
        let now = difference(rates, bias_radps);
        let Some((since, before)) = self.last.replace((at, now)) else {
            return;
        };
        let length_s = at.since(since).as_secs_f64();
        self.has_gap |= length_s > LONGEST_STEP_S;
        let coning = cross(before, now);
        let mut turned = [0.0; 3];
        for (part, ((one, other), cone)) in turned
            .iter_mut()
            .zip(before.into_iter().zip(now).zip(coning))
        {
            *part = length_s * (0.5 * (one + other) + length_s / 12.0 * cone);
        }
        if self
            .steps
            .get(self.at)
            .is_some_and(|step| norm(step.angle_rad) >= STEP_RAD)
        {
            self.at += 1;
        }
        let Some(step) = self.steps.get_mut(self.at) else {
            return;
        };
        let order = cross(step.angle_rad, turned);
        for (part, (turned, order)) in step.angle_rad.iter_mut().zip(turned.into_iter().zip(order))
        {
            *part += turned + 0.5 * order;
        }
        step.length_s += length_s;
    }

    fn steps(&self) -> &[Step] {
        self.steps.get(..=self.at).unwrap_or(&self.steps)
    }

    /// How far it turned, there and back.
    pub(super) fn turned_rad(&self) -> f64 {
        self.steps().iter().map(|step| norm(step.angle_rad)).sum()
    }

    /// Whether readings were missing.
    pub(super) const fn has_gap(&self) -> bool {
        self.has_gap
    }

    /// Whether it turned for longer than is kept.
    const fn is_cut(&self) -> bool {
        self.at >= MOST_STEPS
    }
}

/// The turns between positions at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns {
    steps: [[f64; 3]; ALL_STEPS],
    kept: [Kept; MOST_TURNS],
    count: usize,
    is_full: bool,
}

/// A turn, and which of the steps are its own.
#[derive(Clone, Copy, Debug, Default)]
struct Kept {
    before: [f64; 3],
    after: [f64; 3],
    begin: usize,
    end: usize,
}

impl Turns {
    pub(super) fn new() -> Self {
        Self {
            steps: [[0.0; 3]; ALL_STEPS],
            kept: [Kept::default(); MOST_TURNS],
            count: 0,
            is_full: false,
        }
    }

    /// Keeps a turn between two directions up, and gives it; `drift_radps` is by
    /// how much the bias was another one. None without all of its readings, or
    /// room.
    pub(super) fn keep(
        &mut self,
        before: [f64; 3],
        after: [f64; 3],
        path: &Path,
        drift_radps: [f64; 3],
    ) -> Option<Turn<'_>> {
        if path.has_gap || path.is_cut() {
            return None;
        }
        let begin = self.each().fold(0, |sum, turn| sum + turn.steps.len());
        let kept = Kept {
            before,
            after,
            begin,
            end: begin + path.steps().len(),
        };
        let places = (
            self.kept.get_mut(self.count),
            self.steps.get_mut(begin..kept.end),
        );
        let (Some(place), Some(steps)) = places else {
            self.is_full = true;
            return None;
        };
        *place = kept;
        for (into, step) in steps.iter_mut().zip(path.steps()) {
            *into = difference(step.angle_rad, drift_radps.map(|by| by * step.length_s));
        }
        self.count += 1;
        Some(self.turn(&kept))
    }

    /// Whether there was no room for the last.
    pub(super) const fn is_full(&self) -> bool {
        self.is_full
    }

    pub(super) fn each(&self) -> impl Iterator<Item = Turn<'_>> + Clone {
        let kept = self.kept.iter().take(self.count);
        kept.map(|kept| self.turn(kept))
    }

    fn turn(&self, kept: &Kept) -> Turn<'_> {
        Turn {
            before: kept.before,
            after: kept.after,
            steps: self.steps.get(kept.begin..kept.end).unwrap_or_default(),
        }
    }
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

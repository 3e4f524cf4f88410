//! Sums of specific force of the latest seconds.

use nalgebra::{UnitQuaternion, Vector3};

use crate::inertial::kalman::signed_s;
use fcc_core::framework::Time;

/// How many are kept, and how far apart they are, s.
const SUMS: usize = 64;
const APART_S: f64 = 0.1;

/// The sums of specific force in the axes that the body had once.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    pub(super) turned: UnitQuaternion<f64>,
    pub(super) sum: Vector3<f64>,
    pub(super) now: Time,
    kept: [(Time, Vector3<f64>); SUMS],
    next: usize,
}

impl Sums {
    pub(super) fn new() -> Self {
        Self {
            turned: UnitQuaternion::identity(),
            sum: Vector3::zeros(),
            now: Time::NEVER,
            kept: [(Time::NEVER, Vector3::zeros()); SUMS],
            next: 0,
        }
    }

    /// Moves on by `dt_s`, in each half of which the body turns by `half`.
    pub(super) fn advance(
        &mut self,
        now: Time,
        half: UnitQuaternion<f64>,
        force: Vector3<f64>,
        dt_s: f64,
    ) {
        let midway = self.turned * half;
        self.turned = midway * half;
        self.turned.renormalize_fast();
        self.sum += midway * force * dt_s;
        self.now = now;
        let last = self.kept[(self.next + SUMS - 1) % SUMS].0;
        if last.is_never() || signed_s(now, last) >= APART_S {
            self.kept[self.next] = (now, self.sum);
            self.next = (self.next + 1) % SUMS;
        }
    }

    /// The sum at a time of the latest seconds.
    pub(super) fn at(&self, then: Time) -> Option<Vector3<f64>> {
        let mut after = (self.now, self.sum);
        // Between two samples it is that of the first.
        if then >= self.now {
            return (signed_s(then, self.now) < APART_S).then_some(self.sum);
        }
        for before in 1..=SUMS {
            let kept = self.kept[(self.next + SUMS - before) % SUMS];
            if kept.0.is_never() {
                return None;
            }
            if kept.0 <= then {
                let share = signed_s(then, kept.0) / signed_s(after.0, kept.0).max(1e-9);
                return Some(kept.1 + (after.1 - kept.1) * share);
            }
            after = kept;
        }
        None
    }
}

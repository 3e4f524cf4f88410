//! Recovery from an upset, between the outer loops.

use super::{Autopilot, flags};
use crate::flight::control::{Change, Recovery, RecoveryInputs};
use crate::flight::navigation::Estimate;
use crate::flight::{Setpoints, Surfaces};
use crate::framework::Time;

/// The surfaces follow the outputs if they differ by no more than this.
const FOLLOWS: f64 = 0.15;

/// Beyond this bank or pitch the autopilot does not engage, unless configured,
/// rad.
const UPSET_RAD: f64 = 1.047;

/// Whether bank or pitch is beyond 60°.
pub(super) fn is_far_from_level(estimate: &Estimate) -> bool {
    estimate.roll_rad.abs() > UPSET_RAD || estimate.pitch_rad.abs() > UPSET_RAD
}

impl Autopilot {
    /// Whether it may engage in an upset, to recover the aircraft from it.
    pub(super) const fn may_engage_in_upset(&self) -> bool {
        self.config.permitted.contains(flags::UPSET)
    }

    /// Begins to watch for upsets, with the trims of the present flight unless it
    /// is one.
    pub(super) fn begin_watching_for_upsets(&mut self) {
        let trims = if is_far_from_level(self.navigation.estimate()) {
            Surfaces::default()
        } else {
            self.trims()
        };
        self.recovery = Recovery::trimmed(&trims, self.schedule());
    }

    /// The outputs while the aircraft is upset; none otherwise. When it no longer
    /// is, the loops take over from them.
    pub(super) fn recover_from_upset(&mut self, now: Time) -> Option<Surfaces> {
        let estimate = *self.navigation.estimate();
        let inputs = RecoveryInputs {
            envelope: &self.config.envelope,
            schedule: self.schedule(),
            heading: &self.heading,
            altitude: &self.altitude,
            followed: self.is_followed(now),
            dt_s: self.clock.step_s(),
        };
        let trims = self.trims();
        match self
            .recovery
            .observe(&self.last, &trims, &estimate, &inputs)
        {
            Change::Ends => {
                let last = self.last;
                self.navigation.count_heading_near(self.targets.heading_rad);
                self.take_over(&last);
                return None;
            }
            Change::Begins | Change::None if !self.recovery.is_active() => return None,
            Change::Begins | Change::None => {}
        }
        self.setpoints = Setpoints {
            roll_rad: 0.0,
            climb_rate_mps: 0.0,
            pitch_rad: 0.0,
            ..self.setpoints
        };
        Some(self.recovery.step(&estimate, &inputs))
    }

    /// Whether it recovers from an upset: in failsafe it does not.
    pub(super) const fn is_recovering(&self) -> bool {
        self.recovery.is_active() && !self.degraded.is_failsafe
    }

    /// Whether the surfaces stand where they were last commanded to, if the plant
    /// measures them.
    fn is_followed(&self, now: Time) -> bool {
        let stand = self.accepted.surfaces.fresh(now, self.config.max_age);
        stand.is_none_or(|stand| {
            let near = |a: f64, b: f64| (a - b).abs() < FOLLOWS;
            near(stand.elevator, self.last.elevator)
        })
    }
}

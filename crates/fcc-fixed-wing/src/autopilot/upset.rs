//! Recovery from an upset, between the outer loops.

use libm::sin;

use super::Autopilot;
use crate::Setpoints;
use crate::control::{Change, Envelope, Recovery, RecoveryInputs};
use fcc_core::flight::Surfaces;
use fcc_core::framework::Time;
use fcc_navigation::{Estimate, Quantities, Quantity};

/// The surfaces follow the outputs if they differ by no more than this.
const FOLLOWS: f64 = 0.15;

/// Beyond this bank or pitch the autopilot does not engage, unless configured,
/// rad.
const UPSET_RAD: f64 = 1.047;

/// ... and with this yaw rate, rad/s (40 °/s): that of a spin, four times that of
/// any turn at 60° of bank.
const UPSET_RADPS: f64 = 0.698;

/// The largest bank and pitch of a steady flight, rad (45°, 25°), and its largest body rate,
/// rad/s (15 °/s): 1.5 times that of a turn with 45° of bank at 60 kt.
const STEADY_BANK_RAD: f64 = 0.785;
const STEADY_PITCH_RAD: f64 = 0.436;
const STEADY_RADPS: f64 = 0.262;

/// Whether the controls' present positions are the trims of a flight.
fn is_steady(estimate: &Estimate) -> bool {
    let rates = estimate.body_rates;
    estimate.roll_rad.abs() < STEADY_BANK_RAD
        && estimate.pitch_rad.abs() < STEADY_PITCH_RAD
        && [rates.roll_radps, rates.pitch_radps, rates.yaw_radps]
            .iter()
            .all(|rate| rate.abs() < STEADY_RADPS)
}

/// Whether bank or pitch is beyond 60°, or it yaws as in a spin.
pub(super) fn is_far_from_level(estimate: &Estimate) -> bool {
    estimate.roll_rad.abs() > UPSET_RAD
        || estimate.pitch_rad.abs() > UPSET_RAD
        || estimate.body_rates.yaw_radps.abs() > UPSET_RADPS
}

impl Autopilot {
    /// Whether it may engage in an upset, to recover the aircraft from it.
    pub(super) const fn may_engage_in_upset(&self) -> bool {
        self.config.permits_upset
    }

    /// Begins to watch for upsets, with the trims of the present flight unless it
    /// is one, or turns as in one: those are of the controls' present positions.
    pub(super) fn begin_watching_for_upsets(&mut self) {
        let trims = if is_steady(self.estimator.estimate()) {
            self.loops.trims()
        } else {
            Surfaces::default()
        };
        self.loops.recovery = Recovery::trimmed(&trims, self.schedule());
    }

    /// The outputs while the aircraft is upset; none otherwise. When it no longer
    /// is, the loops take over from them.
    pub(super) fn recover_from_upset(
        &mut self,
        now: Time,
        estimate: &Estimate,
    ) -> Option<Surfaces> {
        let dt_s = self.intake.clock.step_s();
        let estimate = &self.loops.recovery.with_gained_airspeed(estimate, dt_s);
        let flown = self.envelope();
        let envelope = Envelope {
            stall_airspeed_mps: flown.stall_airspeed_mps,
            min_airspeed_mps: flown.min_airspeed_mps,
            ..self.config.envelope
        };
        let inputs = RecoveryInputs {
            envelope: &envelope,
            schedule: self.loops.schedule_at(&self.config, estimate.airspeed_mps),
            heading: &self.loops.heading,
            altitude: &self.loops.altitude,
            followed: self.is_followed(now),
            dt_s,
        };
        let trims = self.loops.trims();
        // What is above the configured stalling speed is for the outer loops to regain.
        let seen = RecoveryInputs {
            envelope: &self.config.envelope,
            ..inputs
        };
        let change = self
            .loops
            .recovery
            .observe(&self.loops.last, &trims, estimate, &seen);
        match change {
            Change::Ends => {
                let last = self.loops.last;
                self.estimator
                    .navigation
                    .count_heading_near(self.guidance.targets.heading_rad);
                self.take_over(&last);
                self.loops
                    .heading
                    .lead_from(self.guidance.setpoints.roll_rad);
                return None;
            }
            Change::Begins | Change::None if !self.loops.recovery.is_active() => return None,
            Change::Begins | Change::None => {}
        }
        let outputs = self.loops.recovery.step(estimate, &inputs);
        if change == Change::Begins {
            self.loops
                .heading
                .lead_from(self.guidance.setpoints.roll_rad);
        }
        self.guidance.setpoints = Setpoints {
            roll_rad: self.loops.heading.led(0.0, dt_s),
            climb_rate_mps: 0.0,
            pitch_rad: 0.0,
            ..self.guidance.setpoints
        };
        Some(outputs)
    }

    /// The same in a failsafe, with what takes the place of the lost quantities.
    /// Accelerations are needed, and attitude or body rates, of which one takes the
    /// place of the other; without altitude the path is taken to be along the pitch.
    /// With the throttle `idle` or as it needs it.
    pub(super) fn recover_degraded(
        &mut self,
        now: Time,
        lost: Quantities,
        estimate: &Estimate,
        idle: bool,
    ) -> Option<Surfaces> {
        let no_motion = lost.contains(Quantity::Attitude) && lost.contains(Quantity::BodyRates);
        if no_motion || lost.contains(Quantity::SpecificForce) {
            self.loops.recovery.end();
            return None;
        }
        let mut estimate = *estimate;
        if lost.contains(Quantity::Altitude) {
            estimate.climb_rate_mps = estimate.true_airspeed_mps * sin(estimate.pitch_rad);
        }
        let recovering = self.recover_from_upset(now, &estimate)?;
        let throttle = if idle { 0.0 } else { recovering.throttle };
        Some(Surfaces {
            throttle,
            ..recovering
        })
    }

    /// Whether the surfaces stand where they were last commanded to, if the plant
    /// measures them.
    fn is_followed(&self, now: Time) -> bool {
        let stand = self
            .intake
            .accepted
            .surfaces
            .fresh(now, self.config.max_age);
        // Where they do not reach the aircraft, the last ones are the measured ones.
        !self.supervisor.following.is_lost()
            && stand.is_none_or(|stand| (stand.elevator - self.loops.last.elevator).abs() < FOLLOWS)
    }
}

//! Elevator trim in flight, and the last seconds before a release that is ours
//! to time: wings level, no climb, the airspeed held, the elevator trimmed. A
//! failsafe that ends is level already, and is trimmed in its last seconds.

use core::time::Duration;

use super::degraded::{Vertical, held_without};
use super::upset::is_far_from_level;
use super::{Autopilot, FailsafeEnd, flags};
use crate::Setpoints;
use crate::control::Trimming;
use fcc_core::blocks::LowPass;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Flags, Time};
use fcc_navigation::{Estimate, Quantities};

/// In flight the trim moves within this bank, rad, pitch rate, rad/s, and
/// difference from the commanded airspeed, m/s.
const STEADY: (f64, f64, f64) = (0.1, 0.05, 2.6);
/// It is trimmed when bank, rad, climb rate, m/s, acceleration, m/s², in the mean
/// of [`SETTLED_S`], and the elevator were within these for so long.
const SETTLED: (f64, f64, f64, f64) = (0.04, 0.5, 0.15, 0.01);
const SETTLED_S: f64 = 1.0;
/// The throttle that is left is the mean of this time, s: without the noise of
/// the airspeed.
const THROTTLE_MEAN_S: f64 = 2.0;
/// For so long before the release the throttle stands still, s.
const THROTTLE_STANDS_S: f64 = 0.2;

/// A release that is being prepared.
#[derive(Clone, Debug)]
pub(super) struct Release {
    /// It belongs to the end of a failsafe, and ends with it; one that was
    /// commanded does not.
    in_failsafe: bool,
    /// The airspeed that is held, m/s.
    airspeed_mps: f64,
    throttle: LowPass,
    acceleration: LowPass,
    /// Since it began, and for how long the aircraft has been trimmed, s.
    lasted_s: f64,
    settled_s: f64,
}

impl Release {
    /// Whether it belongs to the end of a failsafe.
    pub(super) fn is_of_failsafe(&mut self) -> bool {
        self.in_failsafe
    }

    /// Whether the aircraft is trimmed, or the time for it is over.
    pub(super) fn is_trimmed(&self, within: Duration) -> bool {
        self.settled_s >= SETTLED_S || self.lasted_s >= within.as_secs_f64()
    }
}

impl Autopilot {
    /// Begins to level and to trim, at the end of a failsafe or by a command;
    /// whether that is possible.
    pub(super) fn begin_to_release(
        &mut self,
        in_failsafe: bool,
        now: Time,
        measured: &Measurements,
    ) -> bool {
        let estimate = self.estimator.estimate();
        let unsafe_now = self.unsafe_to_fly(now, measured);
        let is_flyable = !unsafe_now.intersects(flags::NOT_SENSED)
            && held_without(self.lost(now)).vertical != Vertical::Trim
            && !is_far_from_level(estimate)
            && !self.loops.recovery.is_active()
            && !self.intake.is_silent(&self.config, now)
            && !self.intake.withholds(&self.config, now);
        if !is_flyable || self.config.level_and_trim.is_zero() {
            return false;
        }
        self.supervisor.release = Some(Release {
            in_failsafe,
            airspeed_mps: self.config.envelope.allowed_airspeed(estimate.airspeed_mps),
            throttle: LowPass::new(THROTTLE_MEAN_S),
            acceleration: LowPass::new(SETTLED_S),
            lasted_s: 0.0,
            settled_s: 0.0,
        });
        true
    }

    /// Trims in the last seconds of a failsafe, when nothing is held any longer:
    /// not in its first tick, before what can be held is known.
    pub(super) fn prepare_end_of_failsafe(&mut self, now: Time, measured: &Measurements) {
        if !self.supervisor.degraded.is_failsafe {
            return;
        }
        if self.supervisor.degraded.is_sound() {
            self.supervisor.release.take_if(Release::is_of_failsafe);
        } else if self.supervisor.release.is_none()
            && self.config.failsafe.end == FailsafeEnd::Release
        {
            self.begin_to_release(true, now, measured);
        }
    }

    /// Wings level, no climb, and the airspeed of its beginning, if a release is
    /// being prepared.
    pub(super) fn fly_to_release(&mut self, estimate: &Estimate, dt_s: f64) -> Option<Surfaces> {
        let airspeed_mps = self.supervisor.release.as_ref()?.airspeed_mps;
        let (schedule, envelope) = (self.schedule(), self.envelope());
        let lateral = self.loops.heading.hold_bank(0.0, estimate, schedule, dt_s);
        let altitude = &mut self.loops.altitude;
        let vertical = altitude.hold_climb_rate(0.0, estimate, &envelope, schedule, dt_s);
        let mut demand = self.throttle_demand(vertical.climb_rate_mps);
        demand.airspeed_mps = self.envelope().least_target_mps(estimate).max(airspeed_mps);
        let throttle = self.loops.airspeed.step(&demand, estimate, dt_s);
        self.guidance.setpoints = Setpoints {
            airspeed_mps: demand.airspeed_mps,
            roll_rad: lateral.roll_rad,
            climb_rate_mps: vertical.climb_rate_mps,
            pitch_rad: vertical.pitch_rad,
            ..self.guidance.setpoints
        };
        Some(Surfaces {
            throttle,
            elevator: self.loops.actuation.elevator(vertical.elevator),
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        })
    }

    /// The outputs with the trim, after one step of it: quick before a release,
    /// slow in steady flight, none where the climb rate is not held.
    pub(super) fn with_trim(&mut self, now: Time, outputs: Surfaces, lost: Quantities) -> Surfaces {
        let (estimate, dt_s) = (*self.estimator.estimate(), self.intake.clock.step_s());
        let is_known = held_without(lost).vertical == Vertical::Level;
        let trimming = if !is_known || self.loops.recovery.is_active() {
            Trimming::Held
        } else if self.supervisor.release.is_some() {
            Trimming::Quick
        } else if self.is_steady(&estimate) {
            Trimming::Steady
        } else {
            Trimming::Held
        };
        let controls = self
            .intake
            .accepted
            .surfaces
            .fresh(now, self.config.max_age);
        let measured = controls.and_then(|controls| controls.elevator_trim);
        self.loops
            .trim
            .step(outputs.elevator, measured, trimming, dt_s);
        let mut outputs = Surfaces {
            elevator_trim: self.loops.trim.position(),
            ..outputs
        };
        let (held, is_trimmable) = (self.loops.trim.held(), self.loops.trim.position().is_some());
        let limit_s = self.config.level_and_trim.as_secs_f64();
        if let Some(release) = &mut self.supervisor.release {
            let (bank, climb, acceleration, elevator) = SETTLED;
            let mean_mps2 = release.acceleration.step(estimate.acceleration_mps2, dt_s);
            let is_settled = estimate.roll_rad.abs() < bank
                && estimate.climb_rate_mps.abs() < climb
                && mean_mps2.abs() < acceleration
                && (held.abs() < elevator || !is_trimmable);
            release.settled_s = if is_settled {
                release.settled_s + dt_s
            } else {
                0.0
            };
            release.lasted_s += dt_s;
            let mean = release.throttle.step(outputs.throttle, dt_s);
            let left_s = (SETTLED_S - release.settled_s).min(limit_s - release.lasted_s);
            if left_s < THROTTLE_STANDS_S && !release.in_failsafe {
                outputs.throttle = mean;
            }
        }
        outputs
    }

    /// What is reported of the trim.
    pub(super) fn trim_conditions(&self) -> Flags {
        let is_lost = self.loops.trim.does_not_follow();
        Flags::NONE.with(flags::TRIM_NOT_FOLLOWED, is_lost).with(
            flags::UNTRIMMED,
            is_lost && self.supervisor.release.is_some(),
        )
    }

    fn is_steady(&self, estimate: &Estimate) -> bool {
        let (bank, pitch_rate, airspeed) = STEADY;
        estimate.roll_rad.abs() < bank
            && estimate.body_rates.pitch_radps.abs() < pitch_rate
            && (estimate.airspeed_mps - self.guidance.targets.airspeed_mps).abs() < airspeed
    }
}

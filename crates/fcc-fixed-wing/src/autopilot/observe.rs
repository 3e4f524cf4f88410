//! From a tick's measurements to the estimate, also after a gap in which a
//! simulated plant was not heard.

use super::Autopilot;
use super::future::{is_from_the_future, without_future};
use super::plant_clock::Waiting;
use super::whereabouts::Whereabouts;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, Readings, Tick, Time};
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{
    FrozenDetector, GateLimits, Quantities, Quantity, airspeed_can_follow, plausibility_gate,
};

impl Autopilot {
    /// Processes a tick's measurements.
    pub(super) fn observe(&mut self, tick: &Tick, measured: &Measurements) {
        let now = tick.woke;
        if is_from_the_future(measured, now) {
            self.observe_present(tick, &without_future(*measured, now));
        } else {
            self.observe_present(tick, measured);
        }
    }

    fn observe_present(&mut self, tick: &Tick, measured: &Measurements) {
        let now = tick.woke;
        self.intake.clock.step(tick, measured);
        self.report_clock_and_sensors();
        if self.intake.clock.waiting() == Waiting::Replaying {
            // What is measured is not the aircraft's state.
            self.intake.before = now;
            return;
        }
        self.follow_pilot(now, measured);
        if self.intake.is_elsewhere().is_empty() {
            self.accept(tick, measured);
        } else {
            self.start_anew(measured);
        }
        if self.intake.clock.waiting() == Waiting::Stopped
            && self.intake.whereabouts.is_left(&self.intake.accepted)
        {
            self.intake.clock.ignore(tick);
        }
        if self.intake.clock.advances(now) {
            self.intake.whereabouts = Whereabouts::of(&self.intake.accepted);
        }
        self.intake.follow_ages(&self.config, now, measured);
        let step_s = self.intake.clock.step_s();
        self.note_throttle(now);
        self.follow_intermittent(step_s);
        let doubted = self.estimator.navigation.airspeed_doubt();
        self.navigate(now, step_s);
        self.follow_ground(now, step_s);
        self.follow_battery(now, step_s);
        self.follow_engine(now, step_s);
        self.note_doubt(doubted);
        let known = self.estimator.navigation.known();
        self.estimator
            .frozen
            .step(&self.intake.accepted, &known, step_s);
        self.take_over_after_loss(now);
        self.take_over_unless_followed(now, self.config.max_age);
        self.follow_failsafe(tick, measured);
        // After an outage everything settles anew before it may engage.
        let unusable = self.silent_or_frozen(now);
        let settled_s = self
            .intake
            .settled_s
            .map_or(0.0, |settled_s| settled_s + step_s);
        self.intake.settled_s = unusable.is_empty().then_some(settled_s);
        self.intake.before = now;
    }

    /// Estimates the aircraft's state, in failsafe without what is lost.
    fn navigate(&mut self, now: Time, step_s: f64) {
        let silent = self.silent_or_frozen(now);
        let sigma_rad = self
            .estimator
            .raw
            .as_ref()
            .map_or(0.0, RawNavigation::tilt_sigma_rad);
        let doubt = self.estimator.navigation.motion_doubt();
        self.estimator.navigation.compare_motion(
            now,
            &self.intake.accepted,
            silent,
            sigma_rad,
            step_s,
        );
        if doubt != self.estimator.navigation.motion_doubt() {
            self.estimator.replacement.forget_offsets();
        }
        let lost = self.lost(now);
        self.estimator
            .navigation
            .knows_motion(self.known_motion(now, lost));
        let replaces = self.supervisor.degraded.is_failsafe
            && lost.contains(Quantity::BodyRates)
            && !lost.contains(Quantity::Attitude);
        self.loops.actuation.derives_rates(replaces);
        let estimate = *self.estimator.estimate();
        self.estimator
            .replacement
            .follow(&self.intake.accepted, lost, &estimate, step_s);
        if self.supervisor.degraded.is_failsafe && !lost.is_empty() {
            let mut left =
                self.estimator
                    .replacement
                    .without(&self.intake.accepted, lost, &estimate, now);
            // Navigation leaves doubted ones out by itself, and sees that they
            // agree again.
            if self.estimator.navigation.airspeed_doubt().is_some() {
                left.airspeed_mps = self.intake.accepted.airspeed_mps;
            }
            if self.estimator.navigation.altitude_doubt().is_some() {
                left.altitude_m = self.intake.accepted.altitude_m;
            }
            self.estimator.navigation.step(now, &left, step_s);
        } else {
            self.estimator
                .navigation
                .step(now, &self.intake.accepted, step_s);
        }
    }

    /// Accepts the plausible measurements of a tick, after the gap that ended
    /// in it, if one did.
    fn accept(&mut self, tick: &Tick, measured: &Measurements) {
        if !self.estimator.knows_attitude() {
            self.forget_attitude();
        }
        self.move_rejected(tick.woke, measured);
        let Some(gap) = self.intake.clock.gap() else {
            self.pass_gate(measured);
            return;
        };
        // What arrives in this tick is later than all before.
        let latest = self.intake.before;
        self.estimator.navigation.postpone(gap.excused, latest);
        if gap.settles_anew {
            // Nothing that was measured before says where the aircraft is now,
            // but how fast it can be.
            let airspeed = self.intake.accepted.airspeed_mps;
            self.intake.accepted = Measurements::default();
            let rejected_by_gate = core::mem::take(&mut self.intake.rejected_by_gate);
            self.pass_gate(measured);
            let passed_s = self.intake.clock.passed_s();
            if !airspeed_can_follow(&airspeed, &self.intake.accepted.airspeed_mps, passed_s) {
                self.intake.accepted.airspeed_mps = airspeed;
                self.intake.rejected_by_gate = rejected_by_gate & Quantity::Airspeed.alone();
            }
        }
        self.intake
            .accepted
            .each_time(&mut |taken| *taken = taken.postponed(gap.excused, latest));
        if gap.settles_anew {
            self.settle_anew(tick);
        } else {
            self.pass_gate(measured);
        }
        if gap.ran_on {
            self.loops
                .heading
                .lead_from(self.guidance.setpoints.roll_rad);
        }
    }

    /// The attitude so far came from gyroscopes that were wrong: the next one is no jump
    /// from it.
    fn forget_attitude(&mut self) {
        self.intake.accepted.attitude = Reading::default();
        self.intake.accepted.heading_rad = Reading::default();
        self.estimator.replacement.forget_angles();
        self.estimator.navigation.adopt_next_attitude();
        let by_gyroscopes = Quantity::Attitude | Quantity::Heading;
        self.intake.rejected_by_gate = self.intake.rejected_by_gate & !by_gyroscopes;
    }

    /// Accepts the plausible ones of a tick's measurements.
    fn pass_gate(&mut self, measured: &Measurements) {
        let limits = self.gate_limits();
        plausibility_gate(&mut self.intake.accepted, measured, &limits);
    }

    /// By what measurements are judged at present.
    pub(super) const fn gate_limits(&self) -> GateLimits {
        GateLimits {
            max_age: self.config.max_age,
            rejected_by_gate: self.intake.rejected_by_gate,
            altitude_step_m: self.estimator.navigation.resolutions().altitude_step_m,
        }
    }

    /// Restarts what was estimated, after the aircraft flew on unheard. Targets
    /// and guidance are kept.
    fn settle_anew(&mut self, tick: &Tick) {
        self.estimator
            .navigation
            .resume(self.intake.clock.passed_s());
        self.estimator.frozen = FrozenDetector::new(self.config.frozen_after.as_secs_f64());
        self.intake.settled_s = None;
        self.intake.renewed_since = tick.woke;
    }

    /// Starts the loops anew, tick by tick, until all that control needs has been
    /// measured anew: it may arrive in several datagrams.
    fn take_over_after_loss(&mut self, now: Time) {
        if self.intake.renewed_since.is_never() {
            return;
        }
        self.rejoin();
        self.loops
            .heading
            .lead_from(self.guidance.setpoints.roll_rad);
        let renewed = Quantity::ALL
            .into_iter()
            .all(|quantity| quantity.taken(&self.intake.accepted) >= self.intake.renewed_since);
        // What has not arrived by then is lost.
        if renewed || now.since(self.intake.renewed_since) > self.config.max_age {
            self.intake.renewed_since = Time::NEVER;
        }
    }

    /// Starts anew with a plant that is another, or elsewhere.
    fn start_anew(&mut self, measured: &Measurements) {
        self.intake.accepted = Measurements::default();
        self.intake.rejected_by_gate = Quantities::NONE;
        self.pass_gate(measured);
        self.estimator.ground.forget_place();
        self.estimator.navigation.reset(&self.config.navigation);
        self.estimator.frozen = FrozenDetector::new(self.config.frozen_after.as_secs_f64());
        self.intake.settled_s = None;
        self.intake.renewed_since = Time::NEVER;
    }
}

//! From a tick's measurements to the estimate, also after a gap in which a
//! simulated plant was not heard.

use super::degraded::by_name;
use super::future::{is_from_the_future, without_future};
use super::place_monitor::PlaceDoubt;
use super::plant_clock::Waiting;
use super::reading_age::taken_of_needed;
use super::whereabouts::Whereabouts;
use super::{Autopilot, flags};
use crate::flight::inertial::RawNavigation;
use crate::flight::navigation::{
    FrozenDetector, GateLimits, Lost, airspeed_can_follow, plausibility_gate,
};
use crate::flight::{Measurements, PlantState};
use crate::framework::{Flags, Reading, Readings, Tick, Time};

impl Autopilot {
    /// Processes a tick's measurements.
    pub(super) fn observe(&mut self, tick: &Tick, measured: &Measurements) {
        let now = tick.woke;
        self.answered = self.answer.take();
        if is_from_the_future(measured, now) {
            self.observe_present(tick, &without_future(*measured, now));
        } else {
            self.observe_present(tick, measured);
        }
    }

    fn observe_present(&mut self, tick: &Tick, measured: &Measurements) {
        let now = tick.woke;
        self.clock.step(tick, measured);
        if self.clock.waiting() == Waiting::Replaying {
            // What is measured is not the aircraft's state.
            self.whereabouts.skip(now);
            self.before = now;
            return;
        }
        self.follow(measured);
        self.follow_pilot(now, measured);
        if self.is_elsewhere().is_empty() {
            self.accept(tick, measured);
        } else {
            self.start_anew(measured);
        }
        if self.clock.waiting() == Waiting::Stopped && self.whereabouts.is_left(&self.accepted) {
            self.clock.ignore(tick);
        }
        if self.clock.advances(now) {
            self.whereabouts.keep(&self.accepted);
        }
        self.follow_ages(now, measured);
        let step_s = self.clock.step_s();
        self.note_throttle(now);
        self.follow_intermittent(step_s);
        let doubted = self.navigation.airspeed_doubt();
        self.navigate(now, measured, step_s);
        self.follow_ground(now, step_s);
        self.follow_battery(now, step_s);
        self.follow_engine(now, step_s);
        self.note_doubt(doubted);
        let known = self.navigation.known();
        self.frozen.step(&self.accepted, &known, step_s);
        self.take_over_after_loss(now);
        self.take_over_unless_followed(now, self.config.max_age);
        self.follow_failsafe(tick, measured);
        // One thing is told in a tick: what can wait does.
        let is_waiting = self.urgent_notice().is_some();
        self.told = self.news.take_if(|_| !is_waiting);
        // After an outage everything settles anew before it may engage.
        let unusable = flags::unusable(self.stale(now), self.frozen());
        let settled_s = self.settled_s.map_or(0.0, |settled_s| settled_s + step_s);
        self.settled_s = unusable.is_empty().then_some(settled_s);
        self.before = now;
    }

    /// Estimates the aircraft's state, in failsafe without what is lost.
    fn navigate(&mut self, now: Time, measured: &Measurements, step_s: f64) {
        let silent = by_name(self.silent_or_frozen(now));
        let sigma_rad = self.raw.as_ref().map_or(0.0, RawNavigation::tilt_sigma_rad);
        let doubt = self.navigation.motion_doubt();
        self.navigation
            .compare_motion(now, &self.accepted, silent, sigma_rad, step_s);
        if doubt != self.navigation.motion_doubt() {
            self.replacement.forget_offsets();
        }
        let lost = self.lost(now, measured);
        self.navigation.knows_motion(self.known_motion(now, lost));
        let lost = by_name(lost);
        let replaces = self.degraded.is_failsafe && lost.body_rates && !lost.attitude;
        self.actuation.derives_rates(replaces);
        let estimate = *self.navigation.estimate();
        self.replacement
            .follow(&self.accepted, lost, &estimate, step_s);
        if self.degraded.is_failsafe && lost != Lost::default() {
            let mut left = self
                .replacement
                .without(&self.accepted, lost, &estimate, now);
            // Navigation leaves doubted ones out by itself, and sees that they
            // agree again.
            if self.navigation.airspeed_doubt().is_some() {
                left.airspeed_mps = self.accepted.airspeed_mps;
            }
            if self.navigation.altitude_doubt().is_some() {
                left.altitude_m = self.accepted.altitude_m;
            }
            self.navigation.step(now, &left, step_s);
        } else {
            self.navigation.step(now, &self.accepted, step_s);
        }
    }

    /// Follows where the aircraft is.
    fn follow(&mut self, measured: &Measurements) {
        if self.plant_is(PlantState::Jumped) || self.plant_is(PlantState::Reloaded) {
            self.whereabouts = Whereabouts::default();
        } else if self.clock.state().is_some() {
            let was_long = self.clock.gap().is_some_and(|gap| gap.was_long);
            // A place that stands still says nothing, and the next one is far away.
            let by_receiver = self.raw.is_some() && !measured.gnss.is_never()
                || matches!(
                    self.ground.place_doubt(),
                    Some(PlaceDoubt::Repeats | PlaceDoubt::Moves)
                );
            let passed_s = self.clock.passed_s();
            let step_m = self.navigation.resolutions().altitude_step_m;
            self.whereabouts
                .step(measured, passed_s, was_long, by_receiver, step_m);
        }
    }

    /// Accepts the plausible measurements of a tick, after the gap that ended
    /// in it, if one did.
    fn accept(&mut self, tick: &Tick, measured: &Measurements) {
        if !self.knows_attitude() {
            self.forget_attitude();
        }
        self.move_distrusted(tick.woke, measured);
        let Some(gap) = self.clock.gap() else {
            self.pass_gate(measured);
            return;
        };
        // What arrives in this tick is later than all before.
        let latest = self.before;
        self.navigation.postpone(gap.excused, latest);
        if gap.settles_anew {
            // Nothing that was measured before says where the aircraft is now,
            // but how fast it can be.
            let airspeed = self.accepted.airspeed_mps;
            self.accepted = Measurements::default();
            let distrusted = core::mem::take(&mut self.distrusted);
            self.pass_gate(measured);
            let passed_s = self.clock.passed_s();
            if !airspeed_can_follow(&airspeed, &self.accepted.airspeed_mps, passed_s) {
                self.accepted.airspeed_mps = airspeed;
                let was_distrusted = distrusted.contains(flags::AIRSPEED);
                self.distrusted = Flags::NONE.with(flags::AIRSPEED, was_distrusted);
            }
        }
        self.accepted
            .each_time(&mut |taken| *taken = taken.postponed(gap.excused, latest));
        if gap.settles_anew {
            self.settle_anew(tick);
        } else {
            self.pass_gate(measured);
        }
        if gap.ran_on {
            self.heading.lead_from(self.setpoints.roll_rad);
        }
    }

    /// The attitude so far came from gyroscopes that were wrong: the next one is no jump
    /// from it.
    fn forget_attitude(&mut self) {
        self.accepted.attitude = Reading::default();
        self.accepted.heading_rad = Reading::default();
        self.replacement.forget_angles();
        self.navigation.adopt_next_attitude();
        let by_gyroscopes = flags::ATTITUDE | flags::HEADING;
        self.distrusted = self.distrusted.keeping(by_gyroscopes, false);
    }

    /// Accepts the plausible ones of a tick's measurements.
    fn pass_gate(&mut self, measured: &Measurements) {
        let limits = self.gate_limits();
        plausibility_gate(&mut self.accepted, measured, &limits);
    }

    /// By what measurements are judged at present.
    pub(super) const fn gate_limits(&self) -> GateLimits {
        GateLimits {
            max_age: self.config.max_age,
            distrusted: self.distrusted,
            altitude_step_m: self.navigation.resolutions().altitude_step_m,
        }
    }

    /// Restarts what was estimated, after the aircraft flew on unheard. Targets
    /// and guidance are kept.
    fn settle_anew(&mut self, tick: &Tick) {
        self.navigation.resume(self.clock.passed_s());
        self.frozen = FrozenDetector::new(self.config.frozen_after.as_secs_f64());
        self.settled_s = None;
        self.renewed_since = tick.woke;
    }

    /// Starts the loops anew, tick by tick, until all that control needs has been
    /// measured anew: it may arrive in several datagrams.
    fn take_over_after_loss(&mut self, now: Time) {
        if self.renewed_since.is_never() {
            return;
        }
        self.rejoin();
        self.heading.lead_from(self.setpoints.roll_rad);
        let renewed = taken_of_needed(&self.accepted)
            .into_iter()
            .all(|(_, taken)| taken >= self.renewed_since);
        // What has not arrived by then is lost.
        if renewed || now.since(self.renewed_since) > self.config.max_age {
            self.renewed_since = Time::NEVER;
        }
    }

    /// Starts anew with a plant that is another, or elsewhere.
    fn start_anew(&mut self, measured: &Measurements) {
        self.accepted = Measurements::default();
        self.distrusted = Flags::NONE;
        self.pass_gate(measured);
        self.ground.forget_place();
        self.navigation.reset(&self.config.navigation);
        self.frozen = FrozenDetector::new(self.config.frozen_after.as_secs_f64());
        self.settled_s = None;
        self.renewed_since = Time::NEVER;
    }
}

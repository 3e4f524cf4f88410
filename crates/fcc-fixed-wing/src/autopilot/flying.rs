//! Control in a tick: from the targets to the outputs.

use super::Autopilot;
use crate::Setpoints;
use crate::control::{Envelope, Schedule};
use fcc_core::blocks::wrap_two_pi;
use fcc_core::flight::Surfaces;
use fcc_core::framework::Time;
use fcc_navigation::{Estimate, Quantities};

impl Autopilot {
    /// The outputs of a tick.
    pub(super) fn fly(&mut self, now: Time) -> Surfaces {
        if self.is_silent(now) {
            return self.silent_trims();
        }
        if !self.intake.renewed_since.is_never() {
            // Some of the estimate is from before the loss.
            return self.loops.last;
        }
        let (estimate, dt_s) = (
            *self.estimator.navigation.estimate(),
            self.intake.clock.step_s(),
        );
        self.follow_outputs(&estimate);
        let (schedule, envelope) = (self.schedule(), self.envelope());
        if self.intake.accepted.body_rates.value != self.loops.kept_trims.found_with {
            self.keep_trims();
        }
        self.learn_straight_trims(&estimate, dt_s);
        let outputs = self.flown(now, &estimate, &envelope, schedule, dt_s);
        self.with_trim(now, outputs, Quantities::NONE)
    }

    /// The outputs of the law that flies.
    fn flown(
        &mut self,
        now: Time,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> Surfaces {
        let recovering = if self.is_on_runway() {
            None
        } else {
            self.recover_from_upset(now, estimate)
        };
        if let Some(outputs) = recovering.or_else(|| self.fly_to_release(estimate, dt_s)) {
            return outputs;
        }
        let by_phase = self.control_on_runway(estimate, dt_s);
        if let Some(outputs) = by_phase.or_else(|| self.control_in_glide(estimate, dt_s)) {
            return outputs;
        }
        let to = self.guidance.targets;
        let ordered_mps = self.flyable_airspeed_mps(to.airspeed_mps);
        self.loops.altitude.order_airspeed(ordered_mps);
        let lateral = self.step_lateral(estimate, envelope, schedule, dt_s);
        let altitude = &mut self.loops.altitude;
        let vertical = altitude.step(to.altitude_m, estimate, envelope, schedule, dt_s);
        let demand = self.throttle_demand(vertical.climb_rate_mps);
        let throttle = self.loops.airspeed.step(&demand, estimate, dt_s);
        self.show(
            lateral.roll_rad,
            vertical.climb_rate_mps,
            vertical.pitch_rad,
        );
        Surfaces {
            throttle,
            elevator: self.loops.actuation.elevator(vertical.elevator),
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        }
    }

    /// The set points of this tick: the targets, and what the loops make of them.
    pub(super) fn show(&mut self, roll_rad: f64, climb_rate_mps: f64, pitch_rad: f64) {
        self.guidance.setpoints = Setpoints {
            airspeed_mps: self.guidance.targets.airspeed_mps,
            heading_rad: wrap_two_pi(self.guidance.targets.heading_rad),
            altitude_m: self.guidance.targets.altitude_m,
            altitude_reference: self.guidance.reference,
            altitude_above_reference_m: self.guidance.targets.altitude_m - self.datum_m(),
            roll_rad,
            climb_rate_mps,
            pitch_rad,
            ..self.guidance.setpoints
        };
    }
}

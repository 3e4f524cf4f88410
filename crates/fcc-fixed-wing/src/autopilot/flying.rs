//! Control in a tick: from the targets to the outputs.

use super::Autopilot;
use crate::control::{Envelope, Schedule};
use fcc_core::flight::Surfaces;
use fcc_core::framework::Time;
use fcc_navigation::{Estimate, Quantities};

impl Autopilot {
    /// The outputs of a tick.
    pub(super) fn fly(&mut self, now: Time) -> Surfaces {
        if self.intake.is_silent(&self.config, now) {
            return self.silent_trims();
        }
        if !self.intake.renewed_since.is_never() {
            // Some of the estimate is from before the loss.
            return self.loops.last;
        }
        let (estimate, dt_s) = (*self.estimator.estimate(), self.intake.clock.step_s());
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
        self.guidance.show(
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
}

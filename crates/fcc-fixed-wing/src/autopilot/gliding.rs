//! The controls without power: the pitch holds the airspeed of the best glide, the throttle
//! is closed but for trying the engine, and the bank follows the way.

use super::Autopilot;
use super::runway::{CLOSES_PER_S, LOWEST_SHARE, OVER_STALL};
use crate::control::{Envelope, PitchCommand};
use fcc_core::flight::Surfaces;
use fcc_guidance::Mode;
use fcc_navigation::Estimate;

impl Autopilot {
    /// The outputs of a glide above its final; none while another mode is flown.
    pub(super) fn control_in_glide(&mut self, estimate: &Estimate, dt_s: f64) -> Option<Surfaces> {
        if self.guidance.mode.mode() != Mode::Glide {
            if core::mem::take(&mut self.loops.glides) {
                // Throttle and pitch were not the loops'.
                let last = self.loops.last;
                self.take_over(&last);
                self.loops
                    .heading
                    .lead_from(self.guidance.setpoints.roll_rad);
            }
            return None;
        }
        self.loops.glides = true;
        let (envelope, schedule) = (self.glide_envelope(), self.schedule());
        let lateral = self.step_lateral(estimate, &envelope, schedule, dt_s);
        let vertical = self.hold_glide(&envelope, estimate, dt_s);
        self.guidance.show(
            lateral.roll_rad,
            vertical.climb_rate_mps,
            vertical.pitch_rad,
        );
        let by = if self.supervisor.engine.opens(&self.config.contingency, dt_s) {
            CLOSES_PER_S
        } else {
            -CLOSES_PER_S
        };
        Some(Surfaces {
            throttle: (self.loops.last.throttle + by * dt_s).clamp(0.0, 1.0),
            elevator: self.loops.actuation.elevator(vertical.elevator),
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        })
    }

    /// Holds the airspeed of the glide by the pitch; in a turn and in gusts the one that
    /// these need.
    pub(super) fn hold_glide(
        &mut self,
        envelope: &Envelope,
        estimate: &Estimate,
        dt_s: f64,
    ) -> PitchCommand {
        let airspeed_mps = self
            .guidance
            .targets
            .airspeed_mps
            .max(envelope.floor_mps(estimate));
        let schedule = self.schedule();
        self.loops
            .altitude
            .hold_airspeed(airspeed_mps, estimate, envelope, schedule, dt_s)
    }

    /// Below the airspeed of the glide there is still one to keep.
    fn glide_envelope(&self) -> Envelope {
        let glide_mps = self.config.envelope.best_glide_airspeed_mps;
        let stall_mps = self.config.envelope.stall_airspeed_mps;
        Envelope {
            min_airspeed_mps: LOWEST_SHARE * glide_mps,
            stall_airspeed_mps: stall_mps.min(glide_mps / OVER_STALL),
            ..self.config.envelope
        }
    }
}

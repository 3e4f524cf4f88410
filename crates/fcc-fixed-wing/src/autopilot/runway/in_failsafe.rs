//! A failsafe in the air of a take-off, a go-around or a landing.
//!
//! What a failsafe holds elsewhere, the pitch and the power of level flight, was not flown
//! yet in a take-off, and is no height to fly on at over a runway. Low it climbs with full
//! throttle and the climb's pitch, as a pilot does without an airspeed; the flare is flown
//! to the ground with the throttle closed.

use super::super::Autopilot;
use super::super::degraded::{Lateral, held_without};
use super::CLOSES_PER_S;
use crate::control::ThrottleDemand;
use fcc_core::blocks::limit;
use fcc_core::flight::Surfaces;
use fcc_guidance::route::RunwayPhase;
use fcc_navigation::{Estimate, Quantities, Quantity};

/// For how long it climbs, s: a Cessna 172 to more than 100 m at its 700 ft/min (handbook
/// of the 172P, 1981, section 5).
const CLIMBS_S: f64 = 40.0;
/// Pitch of a flare that is flown to the ground, rad (3°): the main wheels touch first.
const TOUCHES_RAD: f64 = 0.052;

/// What is flown first.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(in super::super) enum Low {
    /// Nothing else than in any failsafe.
    #[default]
    No,
    /// A climb with this pitch, rad, for this time, s.
    Climbs(f64, f64),
    /// The flare, to the ground.
    Lands,
}

impl Autopilot {
    /// Begins a failsafe: what is flown first. The loops are engaged with what is flown, as
    /// in a take-off only the pitch's is.
    pub(in super::super) fn begin_low(&mut self) {
        let Some(demand) = self.guidance.runway() else {
            return;
        };
        let config = self.config.route.runway;
        let low = match demand.phase {
            RunwayPhase::Flare => Low::Lands,
            phase if phase.is_climb() => Low::Climbs(demand.pitch_rad, CLIMBS_S),
            RunwayPhase::Approach if demand.is_powerless => return,
            RunwayPhase::Approach if demand.height_m < config.decision_height_m => {
                Low::Climbs(config.climb_pitch_rad, CLIMBS_S)
            }
            _ => return,
        };
        self.supervisor.degraded.low = low;
        if let Low::Climbs(..) = low {
            let estimate = *self.estimator.estimate();
            let last = self.loops.last;
            self.take_over(&last);
            // Of level flight, at the airspeed that it has or will have.
            let demand = ThrottleDemand {
                airspeed_mps: estimate.airspeed_mps,
                ..self.throttle_demand(estimate.climb_rate_mps)
            };
            self.loops
                .airspeed
                .engage(last.throttle, &demand, &estimate);
            self.supervisor.degraded.trimmed_mps =
                Some(estimate.airspeed_mps.max(config.climb_mps));
        }
    }

    /// The outputs of a climb or a flare in a failsafe; none if neither is flown (any
    /// longer), or the attitude is not known.
    pub(in super::super) fn fly_low(
        &mut self,
        lost: Quantities,
        estimate: &Estimate,
        dt_s: f64,
    ) -> Option<Surfaces> {
        let low = self.supervisor.degraded.low;
        if low == Low::No || held_without(lost).lateral == Lateral::Trims {
            return None;
        }
        let demand = self.guidance.runway()?;
        let mut envelope = self.runway_envelope(&demand);
        if lost.contains(Quantity::Airspeed) {
            // No change of pitch would change an airspeed that is assumed.
            envelope.min_airspeed_mps = 1.0;
            envelope.stall_airspeed_mps = 1.0;
        }
        let (pitch_rad, throttle) = match low {
            Low::Climbs(pitch_rad, left_s) => {
                let left_s = left_s - dt_s;
                self.supervisor.degraded.low = Low::Climbs(pitch_rad, left_s);
                if left_s <= 0.0 {
                    self.level_off(lost, estimate);
                }
                (
                    pitch_rad,
                    (self.loops.last.throttle + CLOSES_PER_S * dt_s).min(1.0),
                )
            }
            _ => (
                limit(
                    estimate.pitch_rad,
                    TOUCHES_RAD,
                    demand.pitch_rad.max(TOUCHES_RAD),
                ),
                (self.loops.last.throttle - CLOSES_PER_S * dt_s).max(0.0),
            ),
        };
        let schedule = self.loops.schedule_at(&self.config, estimate.airspeed_mps);
        let lateral = self.loops.heading.hold_bank(0.0, estimate, schedule, dt_s);
        let vertical = self
            .loops
            .altitude
            .hold_pitch(pitch_rad, estimate, &envelope, schedule, dt_s);
        self.guidance.show(
            lateral.roll_rad,
            vertical.climb_rate_mps,
            vertical.pitch_rad,
        );
        Some(Surfaces {
            throttle,
            elevator: self.loops.actuation.elevator(vertical.elevator),
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        })
    }

    /// The altitude that it has is kept from now on.
    fn level_off(&mut self, lost: Quantities, estimate: &Estimate) {
        self.supervisor.degraded.low = Low::No;
        self.supervisor.degraded.altitude_m = estimate.altitude_m;
        if !lost.contains(Quantity::Altitude) {
            let schedule = self.loops.schedule_at(&self.config, estimate.airspeed_mps);
            self.loops
                .altitude
                .engage(self.loops.last.elevator, estimate, schedule);
        }
    }
}

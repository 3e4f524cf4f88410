//! The pitch of a climb, and the limits of a phase.

use super::{Autopilot, LOW_M, LOWEST_SHARE, OVER_STALL};
use crate::control::Envelope;
use fcc_core::blocks::limit;
use fcc_guidance::route::{RunwayDemand, RunwayPhase};
use fcc_navigation::Estimate;

/// A go-around begins with this pitch, rad (3°), below this share of the approach's
/// airspeed.
const SLOW_PITCH_RAD: f64 = 0.052;
const SLOW_SHARE: f64 = 0.8;
/// The smallest pitch of a flare: the nose wheel does not touch first, rad.
const LEAST_FLARE_PITCH_RAD: f64 = 0.0;

impl Autopilot {
    /// Whether it was thrown, and climbs.
    pub(super) fn is_thrown(&self, demand: &RunwayDemand) -> bool {
        self.config.route.runway.is_thrown() && demand.phase.is_takeoff()
    }

    /// Whether it is low, and its climb begins with little speed.
    fn begins_slow(&self, demand: &RunwayDemand) -> bool {
        let slow = demand.phase == RunwayPhase::GoAround || self.is_thrown(demand);
        slow && demand.height_m <= LOW_M
    }

    /// The pitch of a climb: low and slow, at first little more than level.
    pub(super) fn climb_pitch_rad(&self, demand: &RunwayDemand, estimate: &Estimate) -> f64 {
        if !self.begins_slow(demand) {
            return demand.pitch_rad;
        }
        let approach_mps = self.config.route.runway.approach_mps;
        let slow_mps = SLOW_SHARE * approach_mps;
        let share = (estimate.airspeed_mps - slow_mps) / (approach_mps - slow_mps);
        let level_rad = SLOW_PITCH_RAD.min(demand.pitch_rad);
        level_rad + limit(share, 0.0, 1.0) * (demand.pitch_rad - level_rad)
    }

    /// The limits of a phase: close to the ground nothing lowers the nose for speed.
    pub(super) fn runway_envelope(&self, demand: &RunwayDemand) -> Envelope {
        let config = &self.config.route.runway;
        let lowest_mps = match demand.phase {
            RunwayPhase::Approach => LOWEST_SHARE * config.approach_mps,
            _ if self.begins_slow(demand) => 1.0,
            RunwayPhase::Climb | RunwayPhase::GoAround => LOWEST_SHARE * config.climb_mps,
            _ => 1.0,
        };
        let stall_mps = (config.approach_mps / OVER_STALL).min(lowest_mps);
        let least_pitch_rad = if demand.phase == RunwayPhase::Flare {
            LEAST_FLARE_PITCH_RAD
        } else {
            self.config.envelope.min_pitch_rad
        };
        Envelope {
            min_airspeed_mps: lowest_mps,
            stall_airspeed_mps: stall_mps,
            airspeed_margin_mps: 0.1 * lowest_mps,
            min_pitch_rad: least_pitch_rad,
            ..self.config.envelope
        }
    }
}

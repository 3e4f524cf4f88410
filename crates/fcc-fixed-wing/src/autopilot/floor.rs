//! The floor: an altitude below which nothing that is flown leads; and the floor and
//! ceiling of a plan's fence, and the ground ahead.
//!
//! A take-off or a landing leads below them. It limits the target altitude, whether that was captured, commanded, restored
//! or is part of a pattern: a descent is captured a margin above the floor, and
//! engaged below it, the aircraft climbs to it. A failsafe that holds no climb,
//! or a pitch, climbs to it as well. Speed comes before it: an aircraft without
//! the power to hold its altitude descends, and a glide without a pilot, too.

use super::Autopilot;
use fcc_core::units::GRAVITY_MPS2;

/// A target this far below the lowest altitude is not limited by it, m: a round
/// altitude in feet is not round in metres.
const ROUNDING_M: f64 = 0.01;

/// How long it takes until the flight path follows the commanded one, s.
const REACTION_S: f64 = 0.5;

/// How much a failsafe that keeps the altitude by pitch loses in turbulence
/// (`docs/envelope.md`, degraded flight), m: 100 ft.
const BY_PITCH_M: f64 = 30.5;

/// The climb rate of a failsafe per height below the lowest altitude, 1/s.
const GAIN_PER_S: f64 = 0.2;

impl Autopilot {
    /// The lowest pressure altitude that is flown to, m; minus infinity without a
    /// floor.
    fn lowest_m(&self) -> f64 {
        let margin_m = self.config.contingency.fence_height_margin_m;
        let fence_m = self.fence().floor_m.map(|floor_m| floor_m + margin_m);
        let terrain_m = self.supervisor.contingencies.lowest_over_terrain_m();
        let envelope_m = self.config.envelope.lowest_altitude_m();
        let lowest_m = [envelope_m, fence_m, terrain_m]
            .into_iter()
            .flatten()
            .fold(f64::NEG_INFINITY, f64::max);
        lowest_m + self.guidance.sea_level_m()
    }

    /// The highest pressure altitude that is flown to, m; infinite without a ceiling.
    fn highest_m(&self) -> f64 {
        let margin_m = self.config.contingency.fence_height_margin_m;
        let ceiling_m = self.fence().ceiling_m.unwrap_or(f64::INFINITY);
        ceiling_m - margin_m + self.guidance.sea_level_m()
    }

    /// Raises the target altitude to the lowest one, and lowers it to the highest.
    pub(super) fn keep_above_floor(&mut self) {
        if self.guidance.runway().is_some() || self.is_on_runway() {
            self.guidance.is_at_floor = false;
            self.loops.altitude.pull_out(0.0);
            return;
        }
        let (lowest_m, demanded_m) = (self.lowest_m(), self.guidance.targets.altitude_m);
        self.guidance.targets.altitude_m = demanded_m.min(self.highest_m()).max(lowest_m);
        self.guidance.is_at_floor =
            (self.guidance.targets.altitude_m - demanded_m).abs() > ROUNDING_M;
        let pull_out_mps2 = self.pull_out_mps2(lowest_m);
        self.loops.altitude.pull_out(pull_out_mps2);
    }

    /// The vertical acceleration with which the present descent ends at an
    /// altitude (m), a = v²/2h, up to that of the largest load; 0 if it does not
    /// descend, m/s².
    fn pull_out_mps2(&self, lowest_m: f64) -> f64 {
        let estimate = self.estimator.estimate();
        let sink_mps = (-estimate.climb_rate_mps).max(0.0);
        let height_m = estimate.altitude_m - lowest_m - REACTION_S * sink_mps;
        let most_mps2 = GRAVITY_MPS2 * (self.config.envelope.max_load_factor - 1.0);
        if height_m > 0.0 {
            (0.5 * sink_mps * sink_mps / height_m).min(most_mps2)
        } else if sink_mps > 0.0 {
            most_mps2
        } else {
            0.0
        }
    }

    /// The altitude for a failsafe to keep by pitch, m: that at its beginning, or
    /// as much above the lowest one as it is kept worse.
    pub(super) fn kept_altitude_m(&self) -> f64 {
        self.supervisor
            .degraded
            .altitude_m
            .max(self.lowest_m() + BY_PITCH_M)
    }

    /// The climb rate for a failsafe to hold, m/s: none, or that to the floor.
    pub(super) fn kept_climb_rate_mps(&self) -> f64 {
        let low_m = self.lowest_m() - self.estimator.estimate().altitude_m;
        (GAIN_PER_S * low_m).max(0.0)
    }
}

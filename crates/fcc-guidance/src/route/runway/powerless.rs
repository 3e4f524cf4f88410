//! A landing without power: a glide along the line, and the flare.

use super::{Outcome, Runway, RunwayConfig, RunwayFlight, RunwayPhase};
use crate::route::OverGround;

/// The time constant of the flare, s: without power there is airspeed for half of the usual
/// one. From 7.1° at 65 kt it needs 7 s, and 10 of the 65 kt.
const FLARE_S: f64 = 2.5;
/// Slower than this share of the glide's airspeed, and so high above the ground that the
/// range finder shows, m, it lowers the nose again.
const SLOWEST_SHARE: f64 = 0.85;
const FLOATS_M: f64 = 5.0;

impl RunwayFlight {
    /// A landing from a glide at an indicated airspeed, m/s, whose angle has this sine.
    pub(in crate::route) fn powerless(
        runway: Runway,
        here: &OverGround,
        config: RunwayConfig,
        airspeed_mps: f64,
        sine: f64,
    ) -> Self {
        let config = RunwayConfig {
            approach_mps: airspeed_mps,
            flare_s: FLARE_S.min(config.flare_s),
            // There is no power for a long one.
            height_uncertainty_m: 0.0,
            ..config
        };
        let flight = Self::new(RunwayPhase::Approach, runway, config, here.altitude_m);
        let mut flight = Self {
            glide_sine: Some(sine),
            level_m: here.altitude_m,
            ..flight
        };
        flight.demand.is_powerless = true;
        flight
    }

    /// One tick of the approach and the flare; nothing gives it up.
    pub(super) fn step_powerless(&mut self, here: &OverGround, sine: f64) -> Outcome {
        let on_wheels = self.touches(here);
        let true_of_indicated = here.true_airspeed_mps / here.airspeed_mps.max(1.0);
        let sink_mps = sine * true_of_indicated * self.config.approach_mps;
        // As the slope of a path, by which the flare's height is computed.
        self.slope = sink_mps / self.demand.ground_speed_mps.max(1.0);
        match self.phase {
            RunwayPhase::Approach if on_wheels => self.phase = RunwayPhase::RollOut,
            RunwayPhase::Approach => {
                self.demand.climb_rate_mps = -sink_mps;
                if self.demand.height_m <= self.flares_m() {
                    self.phase = RunwayPhase::Flare;
                }
            }
            RunwayPhase::Flare => {
                let is_slow = here.airspeed_mps < SLOWEST_SHARE * self.config.approach_mps;
                let is_high = here.height_m.is_some() && self.demand.height_m > FLOATS_M;
                self.flare(here, on_wheels);
                if is_slow && is_high && !on_wheels {
                    self.phase = RunwayPhase::Approach;
                }
            }
            _ => return self.roll_out(on_wheels),
        }
        Outcome::Flown
    }
}

//! Landing: the glide path, and when each phase begins.

use libm::{fabs, tan};

use super::{
    ALTIMETER_OFF_M, CONTACT_S, Outcome, Runway, RunwayConfig, RunwayFlight, RunwayPhase,
    RunwayReason, WEIGHT_WRONG_M,
};
use crate::path::Motion;
use crate::route::OverGround;

/// Climb rate per metre below the glide path, 1/s.
const PATH_GAIN_PER_S: f64 = 0.25;
/// The most that corrects it, m/s.
const MOST_CORRECTION_MPS: f64 = 1.5;
/// Half of the head wind is added to the airspeed, and at most this, m/s (10 kt).
const WIND_SHARE: f64 = 0.5;
const MOST_WIND_MPS: f64 = 5.144;
/// Without weight on wheels, the aircraft is on them below this height, m, and
/// at this share of its approach speed.
const TOUCHES_M: f64 = 0.3;
const TOUCHES_SHARE: f64 = 0.8;
/// Without weight on wheels it lies on the ground when it is slower than this over it,
/// m/s, and than this share of its approach speed in the air.
const LIES_MPS: f64 = 1.0;
const LIES_SHARE: f64 = 0.5;
/// A bounce to this height is flared again, m.
const BOUNCES_M: f64 = 1.0;
/// Before the runway, less than this share of the glide path's height above the ground is
/// too near.
const GROUND_SHARE: f64 = 0.3;
/// The altimeter is compared with the receiver below so many decision heights: far above
/// the ground a warm or cold day sets them apart (30 °C off: 12 m at 122 m).
const COMPARED_BELOW: f64 = 2.0;
/// A flare that lasts longer than so many of its time constants, or below this share of
/// the approach's airspeed, is given up, unless the range finder shows less than this, m.
const LONGEST_FLARES: f64 = 3.0;
const SLOWEST_SHARE: f64 = 0.8;
const FLOATS_M: f64 = 3.0;
/// Where the height is uncertain so much of the glide path's sink rate stays: 140 ft/min of
/// 370, as on glassy water (FAA-H-8083-23, chapter 6: 150).
const UNCERTAIN_SHARE: f64 = 0.3;
/// The lowest height of a flare's begin, m.
const LEAST_FLARE_M: f64 = 1.0;
/// Back above so many times that height, the landing is given up.
const BALLOONS: f64 = 2.0;
/// Below this height a landing is not given up any more by its limits, m.
const COMMITTED_M: f64 = 8.0;
impl RunwayFlight {
    /// A landing, from here on a leg that leads along the runway, with the altitude of a
    /// go-around, m above mean sea level.
    pub(in crate::route) fn landing(
        runway: Runway,
        here: &OverGround,
        motion: &Motion,
        config: RunwayConfig,
        altitude_m: f64,
    ) -> Self {
        let flight = Self::new(RunwayPhase::Approach, runway, config, altitude_m);
        let away_m = flight.left_m(motion).max(1.0);
        let needed = (here.altitude_m - runway.elevation_m) / away_m;
        Self {
            slope: needed.max(tan(config.glide_path_rad)),
            level_m: here.altitude_m,
            ..flight
        }
    }

    /// The altitude of the glide path, and of the runway behind it, m above mean sea level.
    pub(in crate::route) fn path_altitude_m(&self, motion: &Motion) -> f64 {
        self.glide_path_m(motion).max(self.runway.elevation_m)
    }

    /// The altitude of the glide path, m above mean sea level: below the runway behind the
    /// point that is aimed at.
    fn glide_path_m(&self, motion: &Motion) -> f64 {
        let above_m = self.slope * self.left_m(motion);
        (self.runway.elevation_m + above_m).min(self.level_m)
    }

    pub(super) fn step_landing(&mut self, here: &OverGround, motion: &Motion) -> Outcome {
        let head_mps = self.demand.head_wind_mps;
        self.approach_mps =
            self.config.approach_mps + (WIND_SHARE * head_mps).clamp(0.0, MOST_WIND_MPS);
        let on_wheels = self.touches(here);
        match self.phase {
            RunwayPhase::Approach if on_wheels => self.phase = RunwayPhase::RollOut,
            RunwayPhase::Approach => self.approach(here, motion),
            RunwayPhase::Flare => self.flare(here, on_wheels),
            RunwayPhase::GoAround => {
                // An altimeter may show it too high: not while there is ground below.
                let decision_m = self.config.decision_height_m;
                let is_clear = here.height_m.is_none_or(|above_m| above_m > decision_m);
                let is_up = here.altitude_m > self.altitude_m && is_clear;
                if is_up || self.climbs_no_more() {
                    return Outcome::Again;
                }
            }
            _ => return self.roll_out(on_wheels),
        }
        Outcome::Flown
    }

    /// On the wheels; a bounce is flared again.
    pub(super) fn roll_out(&mut self, on_wheels: bool) -> Outcome {
        self.config.height_uncertainty_m = 0.0;
        if !on_wheels && self.demand.height_m > BOUNCES_M && !self.demand.takes_off {
            self.phase = RunwayPhase::Flare;
        }
        self.step_on_wheels()
    }

    /// Whether the wheels are on the ground: by their switch, as far as the height agrees,
    /// and without one, or with one that has not noticed, by height and airspeed.
    pub(super) fn touches(&mut self, here: &OverGround) -> bool {
        let (height_m, ranged) = (self.demand.height_m, here.height_m.is_some());
        if here.on_wheels == Some(true) && height_m > WEIGHT_WRONG_M {
            self.is_weight_wrong = true;
        }
        let is_slow = here.airspeed_mps < TOUCHES_SHARE * self.config.approach_mps;
        match here.on_wheels {
            // A range finder that shows too much does not overrule wheels that roll.
            Some(true) if !self.is_weight_wrong => {
                !ranged || height_m < BOUNCES_M || is_slow && self.contact_s > CONTACT_S
            }
            Some(false) if !ranged => false,
            Some(_) => height_m < TOUCHES_M && is_slow && self.may_be_down(here),
            // One without wheels may lie where its altimeter shows more.
            None => height_m < TOUCHES_M && is_slow || self.lies(here),
        }
    }

    /// Whether it may be down although its switch does not show weight: not where the
    /// altitude is higher than the range finder shows. Without a switch the range finder is
    /// all there is.
    fn may_be_down(&self, here: &OverGround) -> bool {
        here.on_wheels.is_none() || self.by_altitude_m(here) - self.demand.height_m < FLOATS_M
    }

    fn lies(&self, here: &OverGround) -> bool {
        self.demand.ground_speed_mps.abs() < LIES_MPS
            && here.airspeed_mps < LIES_SHARE * self.config.approach_mps
    }

    fn approach(&mut self, here: &OverGround, motion: &Motion) {
        let path_m = self.glide_path_m(motion);
        let off_m = path_m - self.runway.elevation_m - self.demand.height_m;
        let descends = if path_m < self.level_m {
            self.sink_mps()
        } else {
            0.0
        };
        self.demand.climb_rate_mps =
            -descends + (PATH_GAIN_PER_S * off_m).clamp(-MOST_CORRECTION_MPS, MOST_CORRECTION_MPS);
        // Elsewhere than at the runway the range finder is not descended by, but warns.
        let path_above_m = path_m - self.runway.elevation_m;
        let is_low = here
            .height_m
            .is_some_and(|above_m| above_m < GROUND_SHARE * path_above_m);
        if self.begins_too_low(motion) {
            self.give_up(RunwayPhase::GoAround, RunwayReason::GlidePath);
        } else if is_low && !self.is_over_runway(motion) {
            self.give_up(RunwayPhase::GoAround, RunwayReason::Ground);
        } else if self.is_range_doubted
            && self.is_over_runway(motion)
            && self.by_altitude_m(here) > COMMITTED_M
        {
            self.give_up(RunwayPhase::GoAround, RunwayReason::RangeJump);
        } else if self.is_altimeter_off(here) {
            self.give_up(RunwayPhase::GoAround, RunwayReason::Receiver);
        } else if self.demand.height_m <= self.flares_m() {
            self.phase = RunwayPhase::Flare;
        } else if path_m < self.level_m
            && let Some(reason) = self.must_go_around(here, off_m)
        {
            self.give_up(RunwayPhase::GoAround, reason);
        }
    }

    /// Whether it began below the decision height, where the glide path is above it: a
    /// landing begins on the path or below it in level flight, not at the ground.
    fn begins_too_low(&self, motion: &Motion) -> bool {
        let decision_m = self.config.decision_height_m;
        let path_above_m = tan(self.config.glide_path_rad) * self.left_m(motion);
        self.level_m - self.runway.elevation_m < decision_m && path_above_m > decision_m
    }

    /// Whether the altimeter is off, and no range finder shows where the ground is. It is asked
    /// when one of altimeter and receiver shows that the ground is near.
    fn is_altimeter_off(&self, here: &OverGround) -> bool {
        let height_m = self.demand.height_m;
        let is_ranged = here.height_m.is_some() && !self.is_range_doubted;
        let is_off = |off_m: f64| {
            height_m + off_m.min(0.0) < COMPARED_BELOW * self.config.decision_height_m
                && fabs(off_m) > ALTIMETER_OFF_M
        };
        !is_ranged && height_m >= COMMITTED_M && here.above_receiver_m.is_some_and(is_off)
    }

    pub(super) fn flare(&mut self, here: &OverGround, on_wheels: bool) {
        let config = self.config;
        let height_m = self.demand.height_m.max(0.0);
        let above_m = (height_m - self.demand.uncertainty_m).max(0.0);
        let flared_mps = above_m / config.flare_s + self.touchdown_mps();
        self.demand.climb_rate_mps = -flared_mps.min(self.sink_mps());
        // With a range finder that shows nothing, the ground is far.
        let is_ranged = here.height_m.is_some() && !self.is_range_doubted;
        let is_near = is_ranged && height_m < FLOATS_M && self.may_be_down(here);
        let is_long = self.phase_s > LONGEST_FLARES * config.flare_s
            || here.airspeed_mps < SLOWEST_SHARE * config.approach_mps;
        let balloons = height_m > (BALLOONS * self.flares_m()).max(COMMITTED_M);
        if on_wheels {
            self.phase = RunwayPhase::RollOut;
        } else if self.is_range_doubted && self.by_altitude_m(here) > COMMITTED_M {
            self.give_up(RunwayPhase::GoAround, RunwayReason::RangeJump);
        } else if self.glide_sine.is_none() && (balloons || is_long && here.ranges && !is_near) {
            self.give_up(RunwayPhase::GoAround, RunwayReason::LongFlare);
        }
    }

    /// The sink rate of the glide path, m/s.
    fn sink_mps(&self) -> f64 {
        (self.slope * self.demand.ground_speed_mps).max(self.config.touchdown_mps)
    }

    /// The sink rate in which the flare ends, m/s: faster where the height is uncertain, so
    /// that the wheels touch within a time.
    fn touchdown_mps(&self) -> f64 {
        let least_mps = self.config.touchdown_mps;
        if self.demand.uncertainty_m > 0.0 {
            least_mps + UNCERTAIN_SHARE * (self.sink_mps() - least_mps)
        } else {
            least_mps
        }
    }

    /// The height of the flare's begin, m.
    pub(super) fn flares_m(&self) -> f64 {
        let slowed_mps = self.sink_mps() - self.touchdown_mps();
        (self.config.flare_s * slowed_mps).max(LEAST_FLARE_M) + self.demand.uncertainty_m
    }

    /// Gives it up for a reason: a landing, unless the wheels are on the ground, or a
    /// take-off, unless they have left it.
    pub(in crate::route) const fn go_around(&mut self, reason: RunwayReason) {
        let phase = match self.phase {
            RunwayPhase::Approach | RunwayPhase::Flare if self.glide_sine.is_none() => {
                RunwayPhase::GoAround
            }
            RunwayPhase::Hand | RunwayPhase::Roll => RunwayPhase::RollOut,
            _ => return,
        };
        self.give_up(phase, reason);
    }

    /// Why a landing is given up on the glide path below the decision height.
    fn must_go_around(&self, here: &OverGround, off_m: f64) -> Option<RunwayReason> {
        let (config, height_m) = (&self.config, self.demand.height_m);
        let airspeed_mps = fabs(here.airspeed_mps - self.approach_mps);
        let reason = if fabs(self.demand.cross_track_m) > config.most_cross_track_m {
            RunwayReason::CentreLine
        } else if fabs(off_m) > config.most_off_path_m {
            RunwayReason::GlidePath
        } else if airspeed_mps > config.most_off_airspeed_mps {
            RunwayReason::Airspeed
        } else if fabs(here.roll_rad) > config.most_bank_rad {
            RunwayReason::Bank
        } else {
            return None;
        };
        (height_m < config.decision_height_m && height_m > COMMITTED_M).then_some(reason)
    }
}

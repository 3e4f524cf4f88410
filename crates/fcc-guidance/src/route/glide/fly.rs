//! What is flown in each stage of a glide, and when the next one begins.

use core::f64::consts::{PI, TAU};

use super::{GlideFlight, Stage};
use crate::path::{Motion, Path, length};
use crate::route::runway::RunwayFlight;
use crate::route::{OverGround, ROLL_LAG_S, RouteConfig};

/// A circle over the key, from which nothing leads but the low key, is flown if this share
/// of what it costs is left beyond it, and the key is flown to.
pub(super) const CIRCLE_SPARE: f64 = 0.15;

impl GlideFlight {
    /// Goes on to the next stage; the landing, near the end of the final.
    pub(super) fn go_on(
        &mut self,
        here: &OverGround,
        motion: &Motion,
        config: &RouteConfig,
    ) -> Option<RunwayFlight> {
        let (at_m, pattern) = (motion.position_m, self.pattern);
        let ahead_m = ahead_m(motion, config);
        let is_second_half = |left_rad: f64| left_rad > ahead_m / pattern.radius_m && left_rad < PI;
        match self.stage {
            Stage::Key(leg) if leg.left_m(at_m) <= ahead_m => {
                let is_outward = pattern.key_left_rad(at_m) < PI;
                self.stage = Stage::Circle(is_outward);
            }
            Stage::Round(from_m, course, was_half) => {
                let now = pattern.circle_from(from_m, course).nearest(at_m).course;
                let is_half = is_second_half(pattern.around_rad(now, course));
                if was_half && !is_half {
                    self.stage = Stage::Aside(at_m, pattern.aside());
                    self.next_s = 0.0;
                } else {
                    self.stage = Stage::Round(from_m, course, is_half);
                }
            }
            Stage::Circle(was_outward) => {
                let is_outward = is_second_half(pattern.key_left_rad(at_m));
                self.stage = Stage::Circle(is_outward);
                if was_outward && !is_outward {
                    let air = self.air(here, motion);
                    let height_m = self.height_m(here, self.elevation_m);
                    let circle_m = (1.0 + CIRCLE_SPARE) * pattern.circle_cost_m(&air);
                    if height_m < circle_m + pattern.low_key_cost_m(0.0, &air) {
                        self.stage = Stage::Downwind;
                    }
                }
            }
            Stage::Downwind => {
                let before_m = pattern.before_m(at_m) + ahead_m;
                let air = self.air(here, motion);
                let height_m = self.height_m(here, self.elevation_m);
                let is_low = pattern.low_key_cost_m(before_m, &air) >= height_m;
                if is_low || before_m >= pattern.longest_m() {
                    self.fly_to_final(here, pattern.shortest_m());
                    self.next_s = 0.0;
                }
            }
            Stage::Direct(leg, final_m) if leg.left_m(at_m) <= ahead_m => {
                self.stage = Stage::Turn(final_m);
            }
            Stage::Turn(final_m) => {
                let left_rad = pattern.turn_left_rad(final_m, at_m);
                let is_over = left_rad <= ahead_m / pattern.radius_m || left_rad > TAU - 0.5;
                if is_over {
                    self.stage = Stage::Final;
                }
            }
            Stage::Final if pattern.before_m(at_m) <= pattern.shortest_m() => {
                return self.runway.map(|runway| self.land(runway, here, config));
            }
            _ => {}
        }
        None
    }

    /// What is followed.
    pub(in crate::route) fn path(&self) -> Path {
        match self.stage {
            Stage::Key(leg) | Stage::Direct(leg, _) => leg.path(),
            Stage::Begin | Stage::Circle(_) => self.pattern.key(),
            Stage::Downwind => self.pattern.downwind(),
            Stage::Aside(through_m, course) => Path::Line { through_m, course },
            Stage::Round(from_m, course, _) => self.pattern.circle_from(from_m, course),
            Stage::Turn(final_m) => self.pattern.turn(final_m),
            Stage::Final => self.pattern.landing(),
        }
    }
}

/// How far before an arc its bank is commanded, m.
fn ahead_m(motion: &Motion, config: &RouteConfig) -> f64 {
    let ramp_s = config.bank_rad / config.bank_rate_radps;
    length(motion.ground_velocity_mps) * (0.5 * ramp_s + ROLL_LAG_S)
}

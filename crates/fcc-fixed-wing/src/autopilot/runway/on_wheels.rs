//! The controls on the wheels.

use super::super::Autopilot;
use super::super::place_monitor::STANDS_MPS;
use super::{CLOSES_PER_S, RUDDER_PER_RADPS, notice};
use crate::control::Lateral;
use fcc_core::blocks::{limit, limit_abs};
use fcc_core::flight::Surfaces;
use fcc_guidance::route::{RunwayConfig, RunwayDemand, RunwayPhase, RunwayReason};
use fcc_navigation::{Estimate, Quantities, Quantity};

/// Heading towards the centre line per metre off it, rad/m, per m/s, and at most, rad.
const STEERS_RAD_PER_M: f64 = 0.02;
const STEERS_RAD_PER_MPS: f64 = 0.03;
const MOST_STEERED_RAD: f64 = 0.15;
/// Yaw rate per heading error, 1/s.
const YAW_GAIN_PER_S: f64 = 1.0;
/// Slower than this the nose wheel is steered as at it, m/s.
const LEAST_STEERED_MPS: f64 = 3.0;
/// Roll rate per bank on the wheels, 1/s.
const LEVELS_PER_S: f64 = 2.6;
/// How fast the brakes are set, 1/s.
const BRAKES_PER_S: f64 = 0.5;
/// Brakes are used below this share of the approach's airspeed.
const BRAKES_BELOW: f64 = 0.85;
/// After so long on the wheels it brakes at any speed, s: one whose throttle does not close
/// does not become slow.
const BRAKES_AFTER_S: f64 = 10.0;

/// So far off the centre line, m, after this time, s, as it moves away from it, it rolls
/// without brakes, and with this share of them after that: where one fails, the other turns
/// the aircraft by more than nose wheel and rudder do. Farther off than a runway is wide it
/// stops.
const STRAYS_M: f64 = 6.0;
const STRAYS_IN_S: f64 = 2.0;
const STRAYED_SHARE: f64 = 0.5;
const BESIDE_M: f64 = 15.0;
/// How fast the brakes are released then, 1/s.
const RELEASES_PER_S: f64 = 2.0;
/// The elevator is held back in full from this speed on of the air along the aircraft, m/s.
const AIR_ALONG_MPS: f64 = 5.0;

/// The elevator, held back so far while the air comes from ahead, at a speed along the
/// aircraft, m/s, and neutral where it comes from behind: held back it would lift the tail
/// (FAA-H-8083-3C, chapter 2, taxiing in a quartering tail wind: elevator down). It is not
/// pushed forward: the moment of an elevator in air from behind is not known here.
pub(super) fn elevator(back: f64, along_mps: f64) -> f64 {
    back * limit(along_mps / AIR_ALONG_MPS, 0.0, 1.0)
}

/// Whether it rolls away from the centre line, towards the edge of the runway.
fn strays(cross_track_m: f64, cross_track_mps: f64) -> bool {
    let off_m = cross_track_m.abs();
    let away_mps = cross_track_mps * cross_track_m.signum();
    away_mps > 0.0 && off_m + STRAYS_IN_S * away_mps > STRAYS_M && off_m < BESIDE_M
}

impl Autopilot {
    /// In a failsafe on the wheels: to a stop, straight on as far as the yaw rate is known.
    pub(in super::super) fn stop_on_wheels(&mut self, lost: Quantities) -> Option<Surfaces> {
        let phase = self.guidance.runway()?.phase;
        let rolls = match self.estimator.ground.on_wheels() {
            _ if phase == RunwayPhase::Hand => true,
            Some(on_wheels) => {
                on_wheels && (phase.is_on_wheels() || self.supervisor.degraded.lands())
            }
            None => phase.is_on_wheels() && phase != RunwayPhase::Rotate,
        };
        if !rolls {
            return None;
        }
        if !self.supervisor.degraded.lands() {
            self.guidance.mode.go_around(RunwayReason::Failsafe);
        }
        let (config, dt_s) = (self.config.route.runway, self.intake.clock.step_s());
        let yaw_radps = if lost.contains(Quantity::BodyRates) {
            0.0
        } else {
            self.estimator.estimate().body_rates.yaw_radps
        };
        let speed_mps = self.estimator.ground.speed_mps().max(LEAST_STEERED_MPS);
        let brake = &mut self.guidance.on_runway.brake;
        *brake += limit_abs(config.brake - *brake, BRAKES_PER_S * dt_s);
        let (left_brake, right_brake) = (Some(*brake), Some(*brake));
        Some(Surfaces {
            throttle: (self.loops.last.throttle - CLOSES_PER_S * dt_s).max(0.0),
            rudder: limit_abs(-self.schedule().moment * RUDDER_PER_RADPS * yaw_radps, 1.0),
            nose_wheel: Some(limit_abs(
                -yaw_radps * config.steering_radius_m / speed_mps,
                1.0,
            )),
            left_brake,
            right_brake,
            ..Surfaces::IDLE
        })
    }

    /// How far the heading is to the left of that which leads to the centre line, rad.
    fn steered_rad(&self, demand: &RunwayDemand) -> f64 {
        let towards_rad = limit_abs(
            STEERS_RAD_PER_M * demand.cross_track_m + STEERS_RAD_PER_MPS * demand.cross_track_mps,
            MOST_STEERED_RAD,
        );
        self.off_heading_rad(demand) - towards_rad
    }

    /// On the wheels: along the centre line, wings level.
    pub(super) fn steer(
        &mut self,
        demand: &RunwayDemand,
        estimate: &Estimate,
        dt_s: f64,
    ) -> Lateral {
        let off_rad = self.steered_rad(demand);
        let rudder = self.rudder_towards(off_rad, estimate, dt_s);
        let schedule = self.schedule();
        let level_radps = -LEVELS_PER_S * estimate.roll_rad;
        let level = self
            .loops
            .heading
            .surfaces_for(level_radps, 0.0, 0.0, estimate, schedule);
        Lateral {
            roll_rad: 0.0,
            aileron: level.aileron,
            rudder,
        }
    }

    /// The outputs with flaps, brakes and nose wheel.
    pub(super) fn with_wheels(
        &mut self,
        demand: &RunwayDemand,
        outputs: Surfaces,
        estimate: &Estimate,
        dt_s: f64,
    ) -> Surfaces {
        let config = self.config.route.runway;
        // Without a measured airspeed it may stay what it was.
        let speed_mps = if self.estimator.navigation.airspeed_doubt().is_some() {
            demand.ground_speed_mps
        } else {
            estimate.airspeed_mps
        };
        let brakes = matches!(demand.phase, RunwayPhase::RollOut | RunwayPhase::Stopped)
            && (speed_mps < BRAKES_BELOW * config.approach_mps || demand.phase_s > BRAKES_AFTER_S);
        let rolls = demand.phase == RunwayPhase::RollOut && !demand.takes_off;
        // Dead reckoning moves a standing aircraft, and noise of the velocity does.
        let is_known =
            self.estimator.ground.is_measured() && self.estimator.ground.speed_mps() > STANDS_MPS;
        let strays =
            is_known && brakes && rolls && strays(demand.cross_track_m, demand.cross_track_mps);
        let control = &mut self.guidance.on_runway;
        if strays && !control.strayed {
            control.strayed = true;
            self.journal.add(notice(RunwayReason::Strays));
        }
        let share = if control.strayed && rolls {
            STRAYED_SHARE
        } else {
            1.0
        };
        let to = if brakes && !strays {
            share * config.brake
        } else {
            0.0
        };
        let brake = &mut control.brake;
        *brake += limit(to - *brake, -RELEASES_PER_S * dt_s, BRAKES_PER_S * dt_s);
        let flaps = if demand.phase.is_takeoff() || demand.phase == RunwayPhase::GoAround {
            config.takeoff_flaps
        } else {
            config.landing_flaps
        };
        let outputs = if demand.phase == RunwayPhase::Stopped {
            Surfaces::IDLE
        } else {
            outputs
        };
        Surfaces {
            flaps: Some(flaps),
            left_brake: Some(*brake),
            right_brake: Some(*brake),
            nose_wheel: match demand.phase {
                RunwayPhase::Stopped => Some(0.0),
                phase => phase
                    .is_on_wheels()
                    .then(|| self.nose_wheel(demand, &config)),
            },
            ..outputs
        }
    }

    /// A turn's rate is V/R, and full deflection's R is known.
    fn nose_wheel(&self, demand: &RunwayDemand, config: &RunwayConfig) -> f64 {
        let off_rad = self.steered_rad(demand);
        let speed_mps = demand.ground_speed_mps.max(LEAST_STEERED_MPS);
        limit_abs(
            YAW_GAIN_PER_S * off_rad * config.steering_radius_m / speed_mps,
            1.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{elevator, strays};
    use fcc_core::units::KNOT_MPS;

    /// On a runway of 100 ft, whose edge is 15.24 m from its middle: not where it wanders
    /// along the line or returns to it, and not where it has left.
    #[test]
    fn what_rolls_towards_the_edge_of_a_runway_strays() {
        for (off_m, away_mps, expected) in [
            (8.0, 1.0, true),
            (-8.0, -1.0, true),
            (2.0, 2.5, true),
            (8.0, -1.0, false),
            (2.5, 0.5, false),
            (15.24, 1.0, false),
        ] {
            assert_eq!(strays(off_m, away_mps), expected, "{off_m} {away_mps}");
        }
    }

    /// FAA-H-8083-3C, chapter 2: up in a head wind, and not in a tail wind. At 20 kt over
    /// the ground air that moves with 25 kt comes from behind.
    #[test]
    fn the_elevator_is_not_held_back_in_a_tail_wind() {
        for (ground_kt, head_kt, expected) in [
            (20.0, 0.0, 0.6),
            (20.0, 25.0, 0.6),
            (60.0, -25.0, 0.6),
            (25.0, -25.0, 0.0),
            (15.0, -25.0, 0.0),
            (0.0, -25.0, 0.0),
            (0.0, 0.0, 0.0),
        ] {
            let held = elevator(0.6, (ground_kt + head_kt) * KNOT_MPS);
            assert!(
                (held - expected).abs() < 1e-9,
                "{ground_kt} {head_kt} {held}"
            );
        }
    }
}

//! Take-off: when each phase begins.

use libm::{atan2, cos, sin};
use nalgebra::Vector2;

use super::{
    ALTIMETER_OFF_M, CONTACT_S, Outcome, Runway, RunwayConfig, RunwayFlight, RunwayPhase,
    RunwayReason, WEIGHT_WRONG_M,
};
use crate::path::{Motion, length};
use crate::route::{OverGround, TookOff};
use fcc_core::blocks::wrap_pi;

/// Off the wheels, and so high, m, it climbs.
const CLIMBS_M: f64 = 3.0;
/// Of a tail wind with which none takes off, m/s (15 kt): an airspeed that is farther below
/// the speed over the ground is wrong.
const MOST_TAIL_WIND_MPS: f64 = 7.716_667;
/// So much slower in the air, for this time, s, it is wrong, from this share of the speed of
/// the rotation over the ground on: the sensor is late, and a gust is short.
const BEHIND_FOR_S: f64 = 1.0;
const BEHIND_FROM: f64 = 0.6;
/// Off the ground for this time, s, it flies: by its switch and so high, m, or without it by
/// the height above and the climb rate, m/s: a steep runway rises by less.
const OFF_GROUND_S: f64 = 0.5;
const OFF_GROUND_M: f64 = 1.0;
pub(super) const OFF_GROUND_MPS: f64 = 1.0;
/// After so long on the wheels with its nose raised, or on them again, it has not the power
/// to fly, s.
const LIFTS_OFF_WITHIN_S: f64 = 10.0;
/// Of the speed of the rotation: slower over the ground it does not fly, and with a lower
/// airspeed none does.
const FLIES_FROM: f64 = 0.85;
/// Farther off the centre line a take-off is given up, m.
const MOST_CROSS_TRACK_M: f64 = 12.0;
/// The nose is so near to the runway's direction as a take-off begins, rad: 20°.
const ALIGNED_RAD: f64 = 0.349;
/// A hand moves at most so fast over the ground, m/s, and is so high above it, m.
pub const HELD_MPS: f64 = 5.0;
const HELD_M: f64 = 1.5;
/// Accelerated for so long, within so much of bank, it is thrown, s, rad (45°): a knock is
/// shorter.
const THROWN_S: f64 = 0.1;
const THROWN_BANK_RAD: f64 = 0.785;
/// A take-off is over so near to its altitude, m.
const REACHED_M: f64 = 3.0;

impl RunwayFlight {
    /// A take-off to an altitude, m above mean sea level. Without a runway it goes
    /// straight ahead from here, and so it does from a hand. One that is begun in the air
    /// climbs.
    pub(in crate::route) fn takeoff(
        runway: Option<Runway>,
        here: &OverGround,
        config: RunwayConfig,
        altitude_m: f64,
        pitch_rad: Option<f64>,
    ) -> Self {
        let elevation_m = here.altitude_m;
        let runway = runway.filter(|_| !config.is_thrown());
        let ahead = || {
            let ground = here.ground_velocity_mps;
            let course_rad = if length(ground) > config.rotate_mps {
                atan2(ground.y, ground.x)
            } else {
                here.heading_rad
            };
            straight_ahead(here, course_rad, elevation_m)
        };
        // The altimeter says where the ground is, if it stands there.
        let stands = here.on_wheels == Some(true);
        let planned_m = runway.map(|runway| runway.elevation_m);
        let runway = runway.map_or_else(ahead, |runway| Runway {
            elevation_m: if stands {
                elevation_m
            } else {
                runway.elevation_m
            },
            ..runway
        });
        let phase = if config.is_thrown() && length(here.ground_velocity_mps) < HELD_MPS {
            RunwayPhase::Hand
        } else if !config.is_thrown()
            && here
                .on_wheels
                .unwrap_or(here.airspeed_mps < config.rotate_mps)
        {
            RunwayPhase::Roll
        } else {
            RunwayPhase::Climb
        };
        let pitch_rad = pitch_rad.unwrap_or(config.climb_pitch_rad);
        let mut flight = Self::new(phase, runway, config, altitude_m);
        flight.pitch_rad = pitch_rad;
        flight.began_m = flight.left_m(&here.motion_in(&runway.at));
        let off_rad = wrap_pi(flight.demand.course_rad - here.heading_rad);
        if phase == RunwayPhase::Roll {
            flight.begin_at(here);
            if off_rad.abs() > ALIGNED_RAD {
                flight.give_up(RunwayPhase::RollOut, RunwayReason::Alignment);
            } else if planned_m.is_some_and(|m| (m - elevation_m).abs() > ALTIMETER_OFF_M) {
                flight.give_up(RunwayPhase::RollOut, RunwayReason::Altimeter);
            }
        }
        flight
    }

    /// Records where it takes off.
    fn begin_at(&mut self, here: &OverGround) {
        self.took_off = Some(TookOff {
            latitude_rad: here.latitude_rad,
            longitude_rad: here.longitude_rad,
            course_rad: wrap_pi(self.demand.course_rad),
            elevation_m: self.runway.elevation_m,
        });
    }

    /// Waits in the hand. It is thrown straight ahead: who throws it says whereto.
    fn wait_for_throw(&mut self, here: &OverGround, dt_s: f64) {
        let pushed =
            here.forward_mps2 > self.config.launch_mps2 && here.roll_rad.abs() < THROWN_BANK_RAD;
        self.thrown_s = if pushed { self.thrown_s + dt_s } else { 0.0 };
        if self.thrown_s < THROWN_S {
            return;
        }
        self.runway = straight_ahead(here, here.heading_rad, here.altitude_m - HELD_M);
        self.demand.course_rad = here.heading_rad;
        self.begin_at(here);
        self.phase = RunwayPhase::Rotate;
    }

    pub(super) fn step_takeoff(
        &mut self,
        here: &OverGround,
        motion: &Motion,
        dt_s: f64,
    ) -> Outcome {
        let rolled_m = self.began_m - self.left_m(motion);
        // A throw may be slower than what flies.
        let flies = !self.config.is_thrown() || here.airspeed_mps >= self.config.rotate_mps;
        let on_wheels = here.on_wheels == Some(true);
        if on_wheels && self.demand.height_m > WEIGHT_WRONG_M {
            self.is_weight_wrong = true;
        }
        let weighs = on_wheels && !self.is_weight_wrong;
        let lifts_off = flies && !weighs && self.demand.height_m > CLIMBS_M;
        let stays_behind = self.stays_behind(here, dt_s);
        let is_aside = self.demand.cross_track_m.abs() > MOST_CROSS_TRACK_M;
        match self.phase {
            RunwayPhase::Hand => self.wait_for_throw(here, dt_s),
            // Not any more once it may fly.
            RunwayPhase::Roll if self.off_ground_s > 0.0 => {}
            RunwayPhase::Roll if is_aside => {
                self.give_up(RunwayPhase::RollOut, RunwayReason::CentreLine);
            }
            RunwayPhase::Roll
                if rolled_m > self.config.longest_roll_m
                    || self.phase_s > self.config.longest_roll_s() =>
            {
                self.give_up(RunwayPhase::RollOut, RunwayReason::LongRoll);
            }
            RunwayPhase::Roll if here.airspeed_mps >= self.config.rotate_mps => {
                self.phase = RunwayPhase::Rotate;
            }
            RunwayPhase::Roll if stays_behind => {
                self.give_up(RunwayPhase::RollOut, RunwayReason::NoAirspeed);
            }
            RunwayPhase::Rotate | RunwayPhase::Climb if self.has_rolled(LIFTS_OFF_WITHIN_S) => {
                self.give_up(RunwayPhase::RollOut, RunwayReason::NoLiftOff);
            }
            RunwayPhase::Rotate | RunwayPhase::Climb if is_aside && self.has_rolled(CONTACT_S) => {
                self.give_up(RunwayPhase::RollOut, RunwayReason::CentreLine);
            }
            RunwayPhase::Rotate if lifts_off => self.phase = RunwayPhase::Climb,
            RunwayPhase::Climb
                if here.altitude_m > self.altitude_m - REACHED_M || self.climbs_no_more() =>
            {
                return Outcome::Done;
            }
            _ => {}
        }
        Outcome::Flown
    }

    /// Whether its wheels are on the ground for so long, s, since the nose was raised, or
    /// again. Nothing is known without their switch.
    fn has_rolled(&self, for_s: f64) -> bool {
        self.phase_s.min(self.contact_s) > for_s && self.demand.height_m < CLIMBS_M
    }

    /// Whether the airspeed has stayed farther below the speed over the ground than a tail
    /// wind makes it: the pitot tube is covered or blocked.
    fn stays_behind(&mut self, here: &OverGround, dt_s: f64) -> bool {
        let over_ground_mps = self.demand.ground_speed_mps;
        let is_behind = over_ground_mps > BEHIND_FROM * self.config.rotate_mps
            && over_ground_mps - here.true_airspeed_mps > MOST_TAIL_WIND_MPS;
        self.behind_s = if is_behind { self.behind_s + dt_s } else { 0.0 };
        self.behind_s > BEHIND_FOR_S
    }

    /// Whether an aircraft that is to roll, or to brake after its take-off was given up,
    /// flies: one with enough speed lifts off by itself.
    pub(super) fn has_left_the_ground(&mut self, here: &OverGround, dt_s: f64) -> bool {
        let rolls = match self.phase {
            RunwayPhase::Roll => true,
            // With an engine that is out, or in a failsafe, it does not climb.
            RunwayPhase::RollOut => {
                self.demand.takes_off
                    && matches!(
                        self.demand.reason,
                        RunwayReason::NoAirspeed
                            | RunwayReason::LongRoll
                            | RunwayReason::NoLiftOff
                            | RunwayReason::CentreLine
                    )
            }
            _ => false,
        };
        let is_off = match here.on_wheels {
            // A range finder may show nothing else than on the wheels.
            Some(false) => self.demand.height_m.max(self.by_altitude_m(here)) > OFF_GROUND_M,
            _ => {
                self.demand.height_m > CLIMBS_M
                    && here.climb_rate_mps > OFF_GROUND_MPS
                    && here.airspeed_mps < self.flies_mps()
            }
        };
        let flies = rolls && is_off && self.demand.ground_speed_mps > self.flies_mps();
        self.off_ground_s = if flies { self.off_ground_s + dt_s } else { 0.0 };
        self.off_ground_s > OFF_GROUND_S
    }

    fn flies_mps(&self) -> f64 {
        FLIES_FROM * self.config.rotate_mps
    }

    /// It flies: nothing is braked any more. The nose is raised, or held if it flies with an
    /// airspeed with which none does, and so with an unknown one.
    pub(super) fn fly_off(&mut self, here: &OverGround) {
        let is_wrong = here.airspeed_mps < self.flies_mps();
        self.demand.airspeed_is_wrong = is_wrong;
        self.phase = if is_wrong || self.phase == RunwayPhase::RollOut {
            RunwayPhase::Climb
        } else {
            RunwayPhase::Rotate
        };
        self.demand.reason = RunwayReason::None;
        self.off_ground_s = 0.0;
    }
}

/// From here on, on a course, rad.
fn straight_ahead(here: &OverGround, course_rad: f64, elevation_m: f64) -> Runway {
    Runway {
        at: here.plane(),
        course: Vector2::new(cos(course_rad), sin(course_rad)),
        elevation_m,
    }
}

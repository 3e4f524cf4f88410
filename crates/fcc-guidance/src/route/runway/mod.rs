//! Take-off and landing: the phases of both along a runway's centre line.
//!
//! ```text
//! take-off   Roll ─► Rotate ─► Climb ─► the next step
//!              ├─► RollOut ─► Stopped                 (too far off the centre line)
//!              └───────┴────► Climb                   (off the ground without a rotation)
//!            Hand ─► Rotate ─► Climb                  (thrown)
//! landing    Approach ─► Flare ─► RollOut ─► Stopped
//!              └───────────┴─► GoAround ─► the landing sequence again
//! ```
//!
//! What the controls do in each phase is the autopilot's; here is when it begins and
//! ends, and the path.

mod config;
mod landing;
mod powerless;
mod range;
mod reason;
mod takeoff;
#[cfg(test)]
mod tests;

pub use config::RunwayConfig;
pub use reason::RunwayReason;
pub use takeoff::HELD_MPS;

use nalgebra::Vector2;

use super::{OverGround, TookOff};
use crate::path::{LocalPlane, Motion, Path, cross};

/// An altimeter that is farther off is not landed or taken off by, m: 2 hPa.
pub const ALTIMETER_OFF_M: f64 = 20.0;
/// Wheels that bear weight above this height do not, m.
const WEIGHT_WRONG_M: f64 = 15.0;

/// Wheels that bear weight for so long are on the ground, and have not bounced, s.
const CONTACT_S: f64 = 1.0;

/// A runway: a point of its centre line and its direction.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Runway {
    /// Of a landing, where it is aimed at; of a take-off, where the plan begins.
    pub at: LocalPlane,
    /// The way along it in that plane, of length 1.
    pub course: Vector2<f64>,
    /// m above mean sea level.
    pub elevation_m: f64,
}

/// The phases of a take-off and of a landing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RunwayPhase {
    /// In the hand, without throttle, until it is thrown.
    Hand,
    /// On the wheels, with full throttle.
    Roll,
    /// The nose is raised; or it was thrown, and gains speed.
    Rotate,
    /// Away from the runway, with full throttle and a pitch.
    Climb,
    /// On the glide path.
    Approach,
    /// The sink rate is reduced, and the nose aligned with the runway.
    Flare,
    /// On the wheels, braking.
    RollOut,
    /// At rest, the brakes set.
    Stopped,
    /// The landing was given up: as in `Climb`.
    GoAround,
}

impl RunwayPhase {
    /// Whether the wheels carry the aircraft, or a hand, or did so just before.
    pub const fn is_on_wheels(self) -> bool {
        matches!(
            self,
            Self::Hand | Self::Roll | Self::Rotate | Self::RollOut | Self::Stopped
        )
    }

    /// Whether it is flown with full throttle and a pitch.
    pub const fn is_climb(self) -> bool {
        matches!(self, Self::Rotate | Self::Climb | Self::GoAround)
    }

    /// Whether it belongs to a take-off.
    pub const fn is_takeoff(self) -> bool {
        matches!(self, Self::Hand | Self::Roll | Self::Rotate | Self::Climb)
    }
}

/// What the controls need to know of a take-off or a landing.
#[expect(clippy::struct_excessive_bools, reason = "independent of each other")]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RunwayDemand {
    /// The phase.
    pub phase: RunwayPhase,
    /// For how long it has lasted, s.
    pub phase_s: f64,
    /// Whether it is a climb that lasts too long.
    pub lacks_power: bool,
    /// True course of the runway, rad.
    pub course_rad: f64,
    /// How far to the right of the centre line the aircraft is, m, and moves, m/s.
    pub cross_track_m: f64,
    /// See `cross_track_m`.
    pub cross_track_mps: f64,
    /// Of the wheels above the ground, m.
    pub height_m: f64,
    /// What that may be off in a landing with power, m: until the wheels touch the airspeed is
    /// held and the nose aligned, so much higher. 0 by a range finder.
    pub uncertainty_m: f64,
    /// Speed over the ground along the runway, m/s.
    pub ground_speed_mps: f64,
    /// The head wind along it, m/s, as it was before the wheels touched: on them the
    /// airspeed, of which it is computed, ends at 0 also where the air comes from behind.
    /// 0 before a take-off.
    pub head_wind_mps: f64,
    /// The climb rate that leads along the glide path, m/s, up.
    pub climb_rate_mps: f64,
    /// The pitch of the climb, rad.
    pub pitch_rad: f64,
    /// Why it was given up.
    pub reason: RunwayReason,
    /// Whether it is a take-off, or was one until it was given up.
    pub takes_off: bool,
    /// Whether a take-off flies with an airspeed with which it cannot.
    pub airspeed_is_wrong: bool,
    /// Whether there is no power: the pitch holds the airspeed, and nothing gives it up.
    pub is_powerless: bool,
}

/// A take-off or landing that is flown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RunwayFlight {
    pub(super) phase: RunwayPhase,
    pub(super) runway: Runway,
    pub(super) config: RunwayConfig,
    /// Where it is over, m above mean sea level: that of a take-off, or of a go-around.
    pub(super) altitude_m: f64,
    pub(super) pitch_rad: f64,
    /// Of the glide path: its tangent, and the altitude at which it is met, m.
    slope: f64,
    level_m: f64,
    demand: RunwayDemand,
    /// The last speed of the approach, m/s.
    approach_mps: f64,
    /// Where it began, m to the runway's point.
    began_m: f64,
    /// For how long it has been in its phase, s.
    phase_s: f64,
    /// Whether the wheels bore weight where they cannot.
    is_weight_wrong: bool,
    /// For how long the wheels have borne weight without a climb or a sink, s.
    contact_s: f64,
    /// The sine of the glide's angle; none with power.
    glide_sine: Option<f64>,
    /// For how long it has been accelerated in the hand, s.
    thrown_s: f64,
    /// For how long a take-off that was to roll has been off the ground, s, and its airspeed
    /// has been farther below the speed over the ground than a tail wind makes it, s.
    off_ground_s: f64,
    behind_s: f64,
    /// Where a take-off has begun.
    took_off: Option<TookOff>,
    /// How far above the runway's elevation the ground is that ranges show, m.
    ground_above_m: Option<f64>,
    /// Whether they show other ground now, farther from that elevation.
    is_range_doubted: bool,
}

/// A climb that has not reached its altitude after this time, s, has not the power for
/// it, and would lead straight on for ever: from this height on, m, the plan is flown as it
/// is. At 1.5 m/s it is 180 m.
const LONGEST_CLIMB_S: f64 = 120.0;
const TURNS_M: f64 = 45.0;

/// What follows of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Outcome {
    /// It goes on.
    Flown,
    /// The end is reached.
    Done,
    /// The aircraft stands: the end is reached, and nothing follows.
    Stands,
    /// A go-around is over.
    Again,
}

impl RunwayFlight {
    fn new(phase: RunwayPhase, runway: Runway, config: RunwayConfig, altitude_m: f64) -> Self {
        Self {
            phase,
            runway,
            config,
            altitude_m,
            pitch_rad: config.climb_pitch_rad,
            slope: 0.0,
            level_m: altitude_m,
            approach_mps: config.approach_mps,
            began_m: 0.0,
            phase_s: 0.0,
            is_weight_wrong: false,
            contact_s: 0.0,
            glide_sine: None,
            thrown_s: 0.0,
            off_ground_s: 0.0,
            behind_s: 0.0,
            took_off: None,
            ground_above_m: None,
            is_range_doubted: false,
            demand: RunwayDemand {
                phase,
                phase_s: 0.0,
                lacks_power: false,
                course_rad: libm::atan2(runway.course.y, runway.course.x),
                cross_track_m: 0.0,
                cross_track_mps: 0.0,
                height_m: 0.0,
                uncertainty_m: 0.0,
                ground_speed_mps: 0.0,
                head_wind_mps: 0.0,
                climb_rate_mps: 0.0,
                pitch_rad: config.climb_pitch_rad,
                reason: RunwayReason::None,
                takes_off: phase.is_takeoff(),
                airspeed_is_wrong: false,
                is_powerless: false,
            },
        }
    }

    pub(super) const fn demand(&self) -> RunwayDemand {
        self.demand
    }

    pub(super) const fn took_off(&self) -> Option<TookOff> {
        self.took_off
    }

    pub(super) const fn path(&self) -> Path {
        Path::Line {
            through_m: Vector2::new(0.0, 0.0),
            course: self.runway.course,
        }
    }

    /// The indicated airspeed to fly, m/s.
    pub(super) const fn airspeed_mps(&self) -> f64 {
        match self.phase {
            RunwayPhase::Approach | RunwayPhase::Flare => self.approach_mps,
            RunwayPhase::RollOut | RunwayPhase::Stopped => 0.0,
            _ => self.config.climb_mps,
        }
    }

    /// How far it is to the point of the runway, m along it.
    pub(super) fn left_m(&self, motion: &Motion) -> f64 {
        -self.runway.course.dot(&motion.position_m)
    }

    /// Whether the ground below is the runway's, or as high: an embankment, a wood and a
    /// valley before it are not. Without power it lands on whatever is below.
    fn is_over_runway(&self, motion: &Motion) -> bool {
        /// So near to the point that is aimed at, m.
        const NEAR_M: f64 = 400.0;
        self.phase.is_takeoff() || self.glide_sine.is_some() || self.left_m(motion) < NEAR_M
    }

    /// One tick.
    pub(super) fn step(&mut self, here: &OverGround, motion: &Motion, dt_s: f64) -> Outcome {
        let course = self.runway.course;
        self.demand = RunwayDemand {
            cross_track_m: cross(course, motion.position_m),
            cross_track_mps: cross(course, motion.ground_velocity_mps),
            ground_speed_mps: course.dot(&motion.ground_velocity_mps),
            head_wind_mps: if self.phase.is_on_wheels() {
                self.demand.head_wind_mps
            } else {
                -course.dot(&motion.wind_mps)
            },
            height_m: self.height_m(here, motion),
            pitch_rad: self.pitch_rad,
            ..self.demand
        };
        let rests =
            here.on_wheels == Some(true) && here.climb_rate_mps.abs() < takeoff::OFF_GROUND_MPS;
        self.contact_s = if rests { self.contact_s + dt_s } else { 0.0 };
        let before = self.phase;
        self.phase_s += dt_s;
        let outcome = if self.has_left_the_ground(here, dt_s) {
            self.fly_off(here);
            Outcome::Flown
        } else if self.phase.is_takeoff() {
            self.step_takeoff(here, motion, dt_s)
        } else if let Some(sine) = self.glide_sine {
            self.step_powerless(here, sine)
        } else {
            self.step_landing(here, motion)
        };
        if self.phase != before {
            self.phase_s = 0.0;
        }
        self.demand.phase = self.phase;
        self.demand.phase_s = self.phase_s;
        self.demand.lacks_power = self.phase.is_climb() && self.phase_s > LONGEST_CLIMB_S;
        outcome
    }

    /// Whether a climb is over, because it lasts too long.
    fn climbs_no_more(&self) -> bool {
        self.demand.lacks_power && self.demand.height_m > TURNS_M
    }

    /// Gives it up, for a reason.
    const fn give_up(&mut self, phase: RunwayPhase, reason: RunwayReason) {
        self.phase = phase;
        self.phase_s = 0.0;
        self.demand.phase = phase;
        self.demand.reason = reason;
    }

    /// Rolls out, and stands at last.
    fn step_on_wheels(&mut self) -> Outcome {
        /// Slower than this it stands, m/s.
        const STANDS_MPS: f64 = 0.3;
        if self.phase == RunwayPhase::RollOut && self.demand.ground_speed_mps < STANDS_MPS {
            self.phase = RunwayPhase::Stopped;
            return if self.demand.takes_off {
                Outcome::Flown
            } else {
                Outcome::Stands
            };
        }
        Outcome::Flown
    }
}

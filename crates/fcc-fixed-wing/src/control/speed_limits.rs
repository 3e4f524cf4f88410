//! The pitch at which the airspeed stays within its limits.

use super::Envelope;
use fcc_core::blocks::{LowPass, limit, limit_abs};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::Estimate;

/// Limits of the pitch, rad; if they conflict, the upper one applies, since too
/// slow is more dangerous than too fast.
///
/// ```
/// use fcc_fixed_wing::control::PitchLimits;
///
/// let limits = PitchLimits { max_rad: -0.1, min_rad: -0.05 };
/// assert_eq!(limits.of(0.2), -0.1);
/// assert_eq!(limits.of(-0.2), -0.1);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PitchLimits {
    /// Above it, the aircraft becomes too slow.
    pub max_rad: f64,
    /// Below it, too fast.
    pub min_rad: f64,
}

impl PitchLimits {
    /// The nearest pitch within the limits.
    pub fn of(&self, pitch_rad: f64) -> f64 {
        limit(pitch_rad, self.min_rad, self.max_rad)
    }
}

/// The pitch at which the airspeed stays within its limits.
///
/// Energy that an aircraft does not have it cannot spend on height and speed:
/// the path angle at which it keeps its speed is its excess thrust over weight,
/// (T - D)/W = sin γ + V̇/g (Lambregts 1983). Speed goes first here: pitch is
/// limited to what leaves the acceleration k·(V₀ - V), V₀ being the limit. The angle itself
/// need not be known: the present pitch, delayed as the flight path follows it,
/// plus the present acceleration over g, is the pitch of constant speed, in a
/// vertical wind, too. So the limit is where the pitch is when it takes over, no
/// integral winds up, and the limit speed is held without a steady error.
///
/// ```
/// use fcc_fixed_wing::control::{Envelope, SpeedLimits};
/// use fcc_navigation::Estimate;
///
/// // The engine has failed: at 70 kt and 4° of pitch the aircraft loses 1.2 m/s
/// // each second. For 65 kt at least it must lower the nose.
/// let mut speed = SpeedLimits::new();
/// let glide = Estimate {
///     airspeed_mps: 36.0,
///     pitch_rad: 0.07,
///     acceleration_mps2: -1.2,
///     ..Estimate::default()
/// };
/// let limits = speed.step(&glide, &Envelope::default(), 0.025);
/// assert!(limits.max_rad < glide.pitch_rad);
/// ```
#[derive(Clone, Debug)]
pub struct SpeedLimits {
    /// The pitch, as the flight path follows it, rad.
    path: LowPass,
    /// The pitch of constant airspeed, rad.
    constant: LowPass,
    /// The angle of the path at constant airspeed, rad: relative to the air, and to
    /// the ground.
    in_air: LowPass,
    over_ground: LowPass,
    /// How far the lowest airspeed is raised, m/s.
    raised_mps: f64,
    /// The airspeed that is ordered, m/s.
    ordered_mps: f64,
    /// The last upper limit, rad.
    max_rad: f64,
    /// For how long the pitch or the angle of attack was at its upper limit, less the time since, s.
    held_s: f64,
    is_short: bool,
    /// For how long energy has been short, s.
    short_s: f64,
    /// For how long the angle of attack was at its limit, less the time since, s.
    at_largest_angle_s: f64,
}

/// How fast the airspeed approaches its limit, 1/s.
const GAIN_PER_S: f64 = 0.3;
/// The flight path follows the pitch after V/(g·n'), n' being load per
/// angle of attack, s: 0.5 for a Cessna 172 at
/// 65 kt (Etkin and Reid 1996, section 4.9).
const PATH_LAG_S: f64 = 0.5;
/// Gusts and noise of the accelerometers are smoothed by this, s.
const SMOOTHED_S: f64 = 0.7;
/// Energy is short once the pitch was held for so long, s; and no longer once it
/// was free for as long.
const SHORT_S: f64 = 2.0;
/// A path of constant airspeed that descends more steeply, rad (3°), is a glide.
const GLIDE_RAD: f64 = -0.05;
/// An aircraft that does not climb over the ground with all of the thrust is flown
/// faster: on the back side of the power curve a higher airspeed needs less power.
/// At the largest angle of attack at once, otherwise after this time, s: most
/// sinking air is left before.
const NO_CLIMB_AFTER_S: f64 = 10.0;
/// The angles of that path are smoothed by these, s: in the air, and over the
/// ground, where turbulence and a turn are no lack of power.
const IN_AIR_S: f64 = 3.0;
const OVER_GROUND_S: f64 = 10.0;
/// The airspeed of the best climb over that of the best glide: 1.14 by the handbook
/// of the Cessna 172N (74 and 65 KIAS), 1.2 if it is heavier than was configured.
const CLIMB_OVER_GLIDE: f64 = 1.2;
/// How fast the lowest airspeed is raised, and lowered again, m/s².
const RAISED_MPS2: f64 = 0.5;

impl SpeedLimits {
    /// Without a past.
    pub const fn new() -> Self {
        Self {
            path: LowPass::new(PATH_LAG_S),
            constant: LowPass::new(SMOOTHED_S),
            in_air: LowPass::new(IN_AIR_S),
            over_ground: LowPass::new(OVER_GROUND_S),
            raised_mps: 0.0,
            ordered_mps: 0.0,
            max_rad: f64::INFINITY,
            held_s: 0.0,
            is_short: false,
            short_s: 0.0,
            at_largest_angle_s: 0.0,
        }
    }

    /// The limits of the pitch.
    pub fn step(&mut self, estimate: &Estimate, envelope: &Envelope, dt_s: f64) -> PitchLimits {
        let path = self.path.step(estimate.pitch_rad, dt_s);
        let constant = self
            .constant
            .step(path + estimate.acceleration_mps2 / GRAVITY_MPS2, dt_s);
        let floor_mps = envelope.floor_mps(estimate);
        let climbs = estimate.climb_rate_mps / estimate.true_airspeed_mps.max(1.0)
            + estimate.acceleration_mps2 / GRAVITY_MPS2;
        self.in_air
            .step(constant - estimate.angle_of_attack_rad, dt_s);
        self.over_ground.step(climbs, dt_s);
        self.short_s = if self.is_short {
            self.short_s + dt_s
        } else {
            0.0
        };
        let floor_mps = floor_mps + self.raise(floor_mps, envelope, dt_s);
        self.max_rad = self.pitch_for(floor_mps, estimate);
        PitchLimits {
            max_rad: self.max_rad,
            min_rad: self.pitch_for(envelope.max_airspeed_mps, estimate),
        }
    }

    /// The pitch that leads to an airspeed, m/s, by the last [`SpeedLimits::step`], rad.
    pub fn pitch_for(&self, airspeed_mps: f64, estimate: &Estimate) -> f64 {
        let off_mps = estimate.airspeed_mps - airspeed_mps;
        self.constant.output() + GAIN_PER_S * off_mps / GRAVITY_MPS2
    }

    /// The airspeed that is ordered, m/s: if height cannot be held at the lowest one,
    /// this one goes first.
    pub const fn order(&mut self, airspeed_mps: f64) {
        self.ordered_mps = airspeed_mps;
    }

    /// How far the lowest airspeed is raised, m/s. With too little energy all of the
    /// thrust is given.
    fn raise(&mut self, floor_mps: f64, envelope: &Envelope, dt_s: f64) -> f64 {
        let glide_mps = envelope.best_glide_airspeed_mps;
        let is_persistent = self.short_s > NO_CLIMB_AFTER_S || self.at_largest_angle_s >= SHORT_S;
        let (to_mps, most_mps2) = if !self.is_short {
            (floor_mps, RAISED_MPS2)
        } else if self.in_air.output() < GLIDE_RAD {
            (glide_mps.max(floor_mps + self.raised_mps), RAISED_MPS2)
        } else if is_persistent && self.over_ground.output() < 0.0 {
            let most_mps = CLIMB_OVER_GLIDE * glide_mps;
            (self.ordered_mps.min(most_mps), RAISED_MPS2)
        } else {
            (floor_mps + self.raised_mps, 0.0)
        };
        let more_mps = (to_mps - floor_mps).max(0.0) - self.raised_mps;
        self.raised_mps += limit_abs(more_mps, most_mps2 * dt_s);
        self.raised_mps
    }

    /// The pitch that is commanded, rad, after [`SpeedLimits::step`], and whether the
    /// angle of attack is at its limit, so that it is not flown.
    pub fn commanded(&mut self, pitch_rad: f64, is_at_largest_angle: bool, dt_s: f64) {
        let is_held = pitch_rad >= self.max_rad || is_at_largest_angle;
        let step_s = if is_held { dt_s } else { -dt_s };
        self.held_s = limit(self.held_s + step_s, 0.0, SHORT_S);
        let step_s = if is_at_largest_angle { dt_s } else { -dt_s };
        self.at_largest_angle_s = limit(self.at_largest_angle_s + step_s, 0.0, SHORT_S);
        if self.held_s >= SHORT_S {
            self.is_short = true;
        } else if self.held_s <= 0.0 {
            self.is_short = false;
        }
    }

    /// How long the pitch has been at its upper limit, 0..=1: 1 when energy is
    /// short. Height is given up for want of thrust, so that this is also the
    /// least throttle.
    pub fn shortage(&self) -> f64 {
        self.held_s / SHORT_S
    }

    /// Whether energy is short for both height and airspeed: the airspeed is
    /// held, and height is given up.
    pub const fn is_short(&self) -> bool {
        self.is_short
    }
}

impl Default for SpeedLimits {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_navigation::Estimate;

    /// A point mass: the engine stops at 80 kt, the drag is 0.12 of the weight
    /// (the glide ratio of a Cessna 172 at 65 kt is 9 to 1: handbook of the 172N,
    /// 1.5 nautical miles for 1,000 ft), the path follows the pitch after 0.5 s,
    /// and the air sinks by 5 m/s, which an aircraft does not feel.
    #[test]
    fn a_glide_is_held_at_the_lowest_airspeed() {
        let envelope = Envelope::default();
        let mut speed = SpeedLimits::new();
        let (mut airspeed_mps, mut path_rad, mut least_mps) = (41.2, 0.0, f64::INFINITY);
        let mut pitch_rad: f64 = 0.05;
        for _ in 0..2_400 {
            let acceleration_mps2 = -GRAVITY_MPS2 * (0.12 + libm::sin(path_rad));
            airspeed_mps += 0.025 * acceleration_mps2;
            path_rad += 0.025 / 0.5 * (pitch_rad - 0.05 - path_rad);
            let estimate = Estimate {
                pitch_rad,
                airspeed_mps,
                acceleration_mps2,
                ..Estimate::default()
            };
            pitch_rad = speed.step(&estimate, &envelope, 0.025).of(0.2);
            speed.commanded(pitch_rad, false, 0.025);
            least_mps = least_mps.min(airspeed_mps);
        }
        let knots = |mps: f64| mps / 0.514_444;
        assert!(knots(least_mps) > 64.0, "{}", knots(least_mps));
        assert!(
            (knots(airspeed_mps) - 65.0).abs() < 0.5,
            "{}",
            knots(airspeed_mps)
        );
        assert!(speed.is_short());
        assert_eq!(speed.shortage(), 1.0);
    }

    #[test]
    fn with_energy_to_spare_nothing_is_limited() {
        let mut speed = SpeedLimits::new();
        let cruise = Estimate {
            airspeed_mps: 51.4,
            ..Estimate::default()
        };
        let limits = speed.step(&cruise, &Envelope::default(), 0.025);
        speed.commanded(limits.of(0.1), false, 10.0);
        assert_eq!(limits.of(0.1), 0.1);
        assert_eq!(limits.of(-0.1), -0.1);
        assert!(!speed.is_short());
    }
}

//! The pitch at which the airspeed stays within its limits.

use super::Envelope;
use crate::blocks::{LowPass, RateLimit, limit};
use crate::flight::navigation::Estimate;
use crate::units::GRAVITY_MPS2;

/// Limits of the pitch, rad; if they conflict, the upper one applies, since too
/// slow is more dangerous than too fast.
///
/// ```
/// use fcc_core::flight::control::PitchLimits;
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
/// use fcc_core::flight::control::{Envelope, SpeedLimits};
/// use fcc_core::flight::navigation::Estimate;
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
    /// How far the lowest airspeed is raised to that of the best glide, m/s.
    glide: RateLimit,
    /// The last upper limit, rad.
    max_rad: f64,
    /// For how long the pitch was at its upper limit, less the time since, s.
    held_s: f64,
    is_short: bool,
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
/// How fast the airspeed of the best glide is approached, m/s².
const TO_GLIDE_MPS2: f64 = 0.5;

impl SpeedLimits {
    /// Without a past.
    pub const fn new() -> Self {
        let mut glide = RateLimit::new(TO_GLIDE_MPS2);
        glide.reset(0.0);
        Self {
            path: LowPass::new(PATH_LAG_S),
            constant: LowPass::new(SMOOTHED_S),
            glide,
            max_rad: f64::INFINITY,
            held_s: 0.0,
            is_short: false,
        }
    }

    /// The limits of the pitch.
    pub fn step(&mut self, estimate: &Estimate, envelope: &Envelope, dt_s: f64) -> PitchLimits {
        let path = self.path.step(estimate.pitch_rad, dt_s);
        let constant = self
            .constant
            .step(path + estimate.acceleration_mps2 / GRAVITY_MPS2, dt_s);
        let floor_mps = envelope.floor_mps(estimate);
        // With all of the thrust and too little energy: a glide.
        let glides = self.is_short && constant - estimate.angle_of_attack_rad < GLIDE_RAD;
        let raised_mps = if glides {
            (envelope.best_glide_airspeed_mps - floor_mps).max(0.0)
        } else {
            0.0
        };
        let floor_mps = floor_mps + self.glide.step(raised_mps, dt_s);
        let at = |airspeed_mps: f64| {
            constant + GAIN_PER_S * (estimate.airspeed_mps - airspeed_mps) / GRAVITY_MPS2
        };
        self.max_rad = at(floor_mps);
        PitchLimits {
            max_rad: self.max_rad,
            min_rad: at(envelope.max_airspeed_mps),
        }
    }

    /// The pitch that is commanded, rad, after [`SpeedLimits::step`].
    pub fn commanded(&mut self, pitch_rad: f64, dt_s: f64) {
        let step_s = if pitch_rad < self.max_rad {
            -dt_s
        } else {
            dt_s
        };
        self.held_s = limit(self.held_s + step_s, 0.0, SHORT_S);
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
    use crate::flight::navigation::Estimate;

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
            speed.commanded(pitch_rad, 0.025);
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
        speed.commanded(limits.of(0.1), 10.0);
        assert_eq!(limits.of(0.1), 0.1);
        assert_eq!(limits.of(-0.1), -0.1);
        assert!(!speed.is_short());
    }
}

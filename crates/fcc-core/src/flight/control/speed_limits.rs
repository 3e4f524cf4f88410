//! The pitch at which the airspeed stays within its limits.

use crate::blocks::{LowPass, limit};
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
/// limited to what leaves the acceleration k·(V_limit - V). The angle itself
/// need not be known: the present pitch, delayed as the flight path follows it,
/// plus the present acceleration over g, is the pitch of constant speed, in a
/// vertical wind, too. So the limit is where the pitch is when it takes over, no
/// integral winds up, and the limit speed is held without a steady error.
///
/// ```
/// use fcc_core::flight::control::SpeedLimits;
/// use fcc_core::flight::navigation::Estimate;
///
/// // The engine has failed: at 70 kt and 4° of pitch the aircraft loses 1.2 m/s
/// // each second. At 65 kt at least it must lower the nose.
/// let mut speed = SpeedLimits::new();
/// let glide = Estimate {
///     airspeed_mps: 36.0,
///     pitch_rad: 0.07,
///     acceleration_mps2: -1.2,
///     ..Estimate::default()
/// };
/// let limits = speed.step(&glide, 33.44..=69.45, 0.025);
/// assert!(limits.max_rad < glide.pitch_rad);
/// ```
#[derive(Clone, Debug)]
pub struct SpeedLimits {
    /// The pitch, as the flight path follows it, rad.
    path: LowPass,
    /// The pitch of constant airspeed, rad.
    constant: LowPass,
}

/// How fast the airspeed approaches its limit, 1/s.
const GAIN_PER_S: f64 = 0.3;
/// The flight path follows the pitch after V/(g·n_α), s: 0.5 for a Cessna 172 at
/// 65 kt (Etkin and Reid 1996, section 4.9).
const PATH_LAG_S: f64 = 0.5;
/// Gusts and noise of the accelerometers are smoothed by this, s.
const SMOOTHED_S: f64 = 0.7;

impl SpeedLimits {
    /// Without a past.
    pub const fn new() -> Self {
        Self {
            path: LowPass::new(PATH_LAG_S),
            constant: LowPass::new(SMOOTHED_S),
        }
    }

    /// The limits of the pitch for these limits of the indicated airspeed, m/s.
    pub fn step(
        &mut self,
        estimate: &Estimate,
        airspeeds_mps: core::ops::RangeInclusive<f64>,
        dt_s: f64,
    ) -> PitchLimits {
        let path = self.path.step(estimate.pitch_rad, dt_s);
        let constant = self
            .constant
            .step(path + estimate.acceleration_mps2 / GRAVITY_MPS2, dt_s);
        let at = |airspeed_mps: f64| {
            constant + GAIN_PER_S * (estimate.airspeed_mps - airspeed_mps) / GRAVITY_MPS2
        };
        PitchLimits {
            max_rad: at(*airspeeds_mps.start()),
            min_rad: at(*airspeeds_mps.end()),
        }
    }
}

impl Default for SpeedLimits {
    fn default() -> Self {
        Self::new()
    }
}

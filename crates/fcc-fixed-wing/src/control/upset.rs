//! Whether the aircraft is upset: attitude and motion that no command of the
//! outer loops explains.

use core::f64::consts::FRAC_PI_2;

use libm::{asin, atan2, cos, sin, sqrt};

use super::Envelope;
use fcc_core::blocks::limit_abs;
use fcc_navigation::Estimate;

/// The motion of the aircraft relative to gravity and its path, without Euler
/// angles' singularity: from the direction of gravity in body axes.
///
/// ```
/// use fcc_fixed_wing::control::Motion;
/// use fcc_navigation::Estimate;
///
/// // Inverted in level flight: gravity acts through the canopy.
/// let inverted = Estimate {
///     roll_rad: 180.0_f64.to_radians(),
///     true_airspeed_mps: 50.0,
///     ..Estimate::default()
/// };
/// let motion = Motion::of(&inverted);
/// assert!((motion.down[2] + 1.0).abs() < 1e-12);
/// assert!((motion.bank_rad.to_degrees() - 180.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Motion {
    /// The direction of gravity in body axes (forward, right, down); of unit
    /// length.
    pub down: [f64; 3],
    /// The bank by that direction, rad, -π..π; arbitrary with the nose straight
    /// up or down.
    pub bank_rad: f64,
    /// The flight path's angle above the horizon, rad.
    pub path_rad: f64,
    /// The angle of attack in still air, without sideslip, rad: the difference of
    /// attitude and path. An updraught of w m/s at V m/s makes it too small by
    /// w/V, a downdraught too large.
    pub angle_of_attack_rad: f64,
}

/// The least sine of the angle between the wings and the vertical for an angle of
/// attack.
const LEAST_LENGTH: f64 = 0.5;

impl Motion {
    /// The motion of an estimate.
    pub fn of(estimate: &Estimate) -> Self {
        let (sin_pitch, cos_pitch) = (sin(estimate.pitch_rad), cos(estimate.pitch_rad));
        let (right, down) = (
            cos_pitch * sin(estimate.roll_rad),
            cos_pitch * cos(estimate.roll_rad),
        );
        let speed = estimate.true_airspeed_mps.max(1.0);
        let sin_path = limit_abs(estimate.climb_rate_mps / speed, 1.0);
        // Without sideslip sin γ = sin θ cos α - cos θ cos φ sin α (Stevens, Lewis
        // and Johnson 2016, equation 3.6-1), which is R sin(δ - α).
        let length = sqrt(sin_pitch * sin_pitch + down * down).max(1e-6);
        let attitude = atan2(sin_pitch, down);
        let path = asin(limit_abs(sin_path / length, 1.0));
        // Inverted, the angle is beyond π/2, and the path is seen from behind.
        let path = if attitude.abs() > FRAC_PI_2 {
            attitude.signum() * core::f64::consts::PI - path
        } else {
            path
        };
        // On the wing's edge with the nose level the path says nothing of it, nor one that is
        // steeper than any without sideslip.
        let angle_of_attack_rad = if length < LEAST_LENGTH || sin_path.abs() > length {
            0.0
        } else {
            attitude - path
        };
        Self {
            down: [-sin_pitch, right, down],
            bank_rad: atan2(right, down),
            path_rad: asin(sin_path),
            angle_of_attack_rad,
        }
    }
}

/// Detects an upset, with hysteresis.
///
/// ```
/// use fcc_fixed_wing::control::{Envelope, Motion, UpsetDetector};
/// use fcc_navigation::Estimate;
///
/// let (envelope, mut upset) = (Envelope::default(), UpsetDetector::default());
/// let mut flown = Estimate { airspeed_mps: 51.4, true_airspeed_mps: 53.8, ..Estimate::default() };
/// let mut step = |flown: &Estimate| upset.step(flown, &Motion::of(flown), 0.0, &envelope, 0.025);
/// assert!(!step(&flown));
/// flown.roll_rad = 80.0_f64.to_radians();
/// assert!(step(&flown));
/// // At 50° it still is, ...
/// flown.roll_rad = 50.0_f64.to_radians();
/// assert!(step(&flown));
/// // ... and not with the wings level for half a second.
/// flown.roll_rad = 0.0;
/// assert!((0..30).any(|_| !step(&flown)));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct UpsetDetector {
    is_upset: bool,
    is_spinning: bool,
    /// How long the wing has been stalled, s.
    stalled_s: f64,
    /// How long the elevator has been fully up, and nothing has risen, s.
    full_up_s: f64,
    /// How long the spin's signs have been there, s.
    spinning_s: f64,
    /// How long the flight has been normal again, s.
    normal_s: f64,
}

/// Bank and pitch beyond the commanded limits by which the aircraft is upset, rad
/// (25°, 15°): twice what severe turbulence adds to a Cessna 172's.
const BANK_BEYOND_RAD: f64 = 0.436;
const PITCH_BEYOND_RAD: f64 = 0.262;
/// Below this bank it is not upset, whatever is commanded, rad (55°).
const LEAST_BANK_RAD: f64 = 0.96;
/// How far ahead a roll is extrapolated, s: about twice the time constant of a
/// light aircraft's roll.
const AHEAD_S: f64 = 0.3;
/// The margin by which the bank ahead has to exceed the limit, rad (20°).
const AHEAD_BEYOND_RAD: f64 = 0.349;
/// The angle of attack of a wing that is surely stalled, rad (20°): 4° beyond
/// that of light aircraft, as much as a gust of 2.5 m/s at the stalling speed.
const STALLED_RAD: f64 = 0.349;
/// ... at no more than this multiple of the stalling airspeed: faster, such a
/// difference of attitude and path is a downdraught's.
const STALLED_BELOW: f64 = 1.0;
/// ... and with no more load than this multiple of what the wing has there, (V/Vs)²: half as
/// much again for an aircraft lighter than was configured. With more the airspeed is wrong.
const STALLED_LOAD: f64 = 1.5;
const STALLED_FOR_S: f64 = 0.6;
/// At any airspeed, since its sensor may be wrong, a wing is stalled that answers
/// an elevator this far up neither with load, g, nor with a pitch rate, rad/s (5
/// °/s), for this time, s, at an angle this far beyond the largest commanded one,
/// rad (2°). "The stick fully back, a high sink rate and no pitch authority" are
/// signs of a full stall (FAA-H-8083-3C, chapter 5).
const FULL_UP: f64 = 0.95;
const ANSWERS_LOAD: f64 = 1.3;
const ANSWERS_RADPS: f64 = 0.087;
const UNANSWERED_BEYOND_RAD: f64 = 0.035;
const UNANSWERED_FOR_S: f64 = 2.0;
/// The yaw rate of a spin and that at which its rotation has stopped, rad/s (40
/// and 20 °/s). A light aircraft spins a turn in 3 s (FAA-H-8083-3C, chapter 5),
/// about half of it in yaw; in a level turn at 60° and 60 kt yaw is 16 °/s.
const SPIN_RADPS: f64 = 0.698;
const SPIN_STOPPED_RADPS: f64 = 0.349;
const SPIN_FOR_S: f64 = 0.1;
/// A spin is slow: at no more than this multiple of the stalling airspeed. The lift
/// of a wing at 30° is two thirds of the largest, and it turns at 2 to 3 g.
const SPIN_BELOW: f64 = 2.0;
/// When the flight is normal again: bank (30°), rates (20 °/s), path (-10°).
const NORMAL_BANK_RAD: f64 = 0.524;
const NORMAL_RADPS: f64 = 0.349;
const NORMAL_PATH_RAD: f64 = -0.175;
const NORMAL_FOR_S: f64 = 0.4;
/// Above this multiple of the stalling airspeed the outer loops fly again.
const FLIES_ABOVE: f64 = 1.15;

impl UpsetDetector {
    /// A detector in undisturbed flight.
    pub const fn new() -> Self {
        Self {
            is_upset: false,
            is_spinning: false,
            stalled_s: 0.0,
            full_up_s: 0.0,
            spinning_s: 0.0,
            normal_s: 0.0,
        }
    }

    /// Whether the aircraft is upset, after a step with the estimate's motion and
    /// the elevator where it was commanded to; 0 if it does not follow.
    pub fn step(
        &mut self,
        estimate: &Estimate,
        motion: &Motion,
        elevator: f64,
        envelope: &Envelope,
        dt_s: f64,
    ) -> bool {
        let stall_mps = envelope.stall_airspeed_mps;
        let rates = estimate.body_rates;
        let stalled = motion.angle_of_attack_rad > STALLED_RAD
            && estimate.airspeed_mps < STALLED_BELOW * stall_mps
            && estimate.load_factor
                < STALLED_LOAD
                    * (estimate.airspeed_mps / stall_mps)
                    * (estimate.airspeed_mps / stall_mps);
        self.stalled_s = lasting(self.stalled_s, stalled, dt_s);
        let beyond_rad = motion.angle_of_attack_rad - envelope.max_angle_of_attack_rad;
        let unanswered = elevator > FULL_UP
            && beyond_rad > UNANSWERED_BEYOND_RAD
            && estimate.load_factor < ANSWERS_LOAD
            && rates.pitch_radps < ANSWERS_RADPS;
        self.full_up_s = lasting(self.full_up_s, unanswered, dt_s);
        // In a spin the airspeed's estimate may be wrong, and the path with it: an
        // angle that is measured counts as well.
        let largest = motion.angle_of_attack_rad.max(estimate.angle_of_attack_rad);
        let spin = largest > STALLED_RAD
            && rates.yaw_radps.abs() > SPIN_RADPS
            && estimate.airspeed_mps < SPIN_BELOW * stall_mps;
        self.spinning_s = lasting(self.spinning_s, spin, dt_s);
        self.is_spinning = self.spinning_s > SPIN_FOR_S
            || self.is_spinning && rates.yaw_radps.abs() > SPIN_STOPPED_RADPS;

        let bank = motion.bank_rad.abs();
        let bank_limit = envelope.bank_limit_rad();
        let most_bank = (bank_limit + BANK_BEYOND_RAD).max(LEAST_BANK_RAD);
        let rolling_out = rates.roll_radps * motion.bank_rad.signum();
        let (least_pitch, most_pitch) = (envelope.min_pitch_rad, envelope.max_pitch_rad);
        let begins = bank > most_bank
            || bank > bank_limit && bank + AHEAD_S * rolling_out > most_bank + AHEAD_BEYOND_RAD
            || estimate.pitch_rad > most_pitch + PITCH_BEYOND_RAD
            || estimate.pitch_rad < least_pitch - PITCH_BEYOND_RAD
            || self.stalled_s > STALLED_FOR_S
            || self.is_unanswered()
            || self.is_spinning;
        let normal = !begins
            && !stalled
            && bank < NORMAL_BANK_RAD.max(bank_limit)
            && rates.roll_radps.abs() < NORMAL_RADPS
            && rates.pitch_radps.abs() < NORMAL_RADPS
            && estimate.pitch_rad < most_pitch + 0.2 * PITCH_BEYOND_RAD
            && motion.path_rad > NORMAL_PATH_RAD
            && estimate.airspeed_mps > FLIES_ABOVE * stall_mps;
        self.normal_s = lasting(self.normal_s, normal, dt_s);
        self.is_upset = begins || self.is_upset && self.normal_s < NORMAL_FOR_S;
        self.is_upset
    }

    /// Whether the aircraft is upset.
    pub const fn is_upset(&self) -> bool {
        self.is_upset
    }

    /// Whether it spins.
    pub const fn is_spinning(&self) -> bool {
        self.is_spinning
    }

    /// Whether the wing is stalled.
    pub fn is_stalled(&self) -> bool {
        self.stalled_s > 0.0 || self.is_unanswered()
    }

    /// Whether an elevator that is fully up has no effect.
    pub fn is_unanswered(&self) -> bool {
        self.full_up_s > UNANSWERED_FOR_S
    }
}

/// How long something has lasted, s.
fn lasting(for_s: f64, still: bool, dt_s: f64) -> f64 {
    if still { for_s + dt_s } else { 0.0 }
}

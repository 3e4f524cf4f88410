//! The limits of what the outer loops command.

use core::ops::RangeInclusive;

use libm::acos;

use super::ClimbLimits;
use crate::blocks::limit;

/// The limits of what the outer loops command.
///
/// ```
/// use fcc_core::flight::control::Envelope;
///
/// // A level turn at 2 g has a bank of 60°.
/// let envelope = Envelope { max_bank_rad: 1.3, max_load_factor: 2.0, ..Envelope::default() };
/// assert!((envelope.bank_limit_rad().to_degrees() - 60.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Envelope {
    /// Largest bank, rad.
    pub max_bank_rad: f64,
    /// Largest load factor in g; above 1.
    pub max_load_factor: f64,
    /// Largest pitch, rad.
    pub max_pitch_rad: f64,
    /// Smallest pitch, rad; negative.
    pub min_pitch_rad: f64,
    /// Lowest indicated airspeed, m/s: below it, the aircraft descends to gain
    /// speed.
    pub min_airspeed_mps: f64,
    /// Highest indicated airspeed, m/s: above it, the aircraft does not
    /// descend.
    pub max_airspeed_mps: f64,
    /// Largest climb rate, m/s.
    pub max_climb_mps: f64,
    /// Largest descent rate, m/s, a positive number.
    pub max_sink_mps: f64,
    /// Within this margin of either airspeed limit the climb limits are
    /// reduced, m/s.
    pub airspeed_margin_mps: f64,
    /// No command and no mode leads below this altitude, m above mean sea level
    /// by the altimeter setting; [`Envelope::NO_FLOOR_M`] for none.
    pub floor_m: f64,
}

impl Default for Envelope {
    /// A light single-engine aircraft such as the Cessna 172.
    fn default() -> Self {
        Self {
            max_bank_rad: 30.0_f64.to_radians(),
            max_load_factor: 2.0,
            max_pitch_rad: 20.0_f64.to_radians(),
            min_pitch_rad: -15.0_f64.to_radians(),
            min_airspeed_mps: 33.438_889,   // 65 kt
            max_airspeed_mps: 69.45,        // 135 kt
            max_climb_mps: 4.902_2,         // 965 ft/min
            max_sink_mps: 4.902_2,          // 965 ft/min
            airspeed_margin_mps: 4.115_556, // 8 kt
            floor_m: Self::NO_FLOOR_M,
        }
    }
}

impl Envelope {
    /// The floor if there is none: 1,500 ft below sea level, below all land.
    pub const NO_FLOOR_M: f64 = -457.2;

    /// The bank limit: the configured one, or the one at which a level turn
    /// reaches the largest load factor (n = 1/cos φ), whichever is less; rad.
    pub fn bank_limit_rad(&self) -> f64 {
        self.max_bank_rad
            .min(acos(1.0 / self.max_load_factor.max(1.0)))
    }

    /// Climb limits at an indicated airspeed: they are reduced near the lowest
    /// airspeed (below it only a descent is permitted) and near the highest.
    pub fn climb_limits(&self, airspeed_mps: f64) -> ClimbLimits {
        let margin = self.airspeed_margin_mps.max(0.1);
        let above_floor = (airspeed_mps - self.min_airspeed_mps) / margin;
        let below_ceiling = (self.max_airspeed_mps - airspeed_mps) / margin;
        ClimbLimits {
            max_mps: limit(
                self.max_climb_mps * above_floor,
                -self.max_sink_mps,
                self.max_climb_mps,
            ),
            min_mps: limit(
                -self.max_sink_mps * below_ceiling,
                -self.max_sink_mps,
                self.max_climb_mps,
            ),
        }
    }

    /// The airspeeds that may be commanded, m/s: a margin inside the limits, so
    /// that climb and descent are possible from level flight there.
    pub fn allowed_airspeeds(&self) -> RangeInclusive<f64> {
        self.min_airspeed_mps + self.airspeed_margin_mps
            ..=self.max_airspeed_mps - self.airspeed_margin_mps
    }

    /// The nearest airspeed that may be commanded, m/s.
    pub fn allowed_airspeed(&self, airspeed_mps: f64) -> f64 {
        let allowed = self.allowed_airspeeds();
        limit(airspeed_mps, *allowed.start(), *allowed.end())
    }

    /// The least throttle at an airspeed, 0..=1: full at the lowest airspeed
    /// and below, zero from half a margin above it. It is linear in between, so
    /// that noise at the limit does not make the throttle jump.
    pub fn least_throttle(&self, airspeed_mps: f64) -> f64 {
        let half_margin = 0.5 * self.airspeed_margin_mps.max(0.1);
        limit(
            (self.min_airspeed_mps + half_margin - airspeed_mps) / half_margin,
            0.0,
            1.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FAA-H-8083-3C, figure 10-1: a level turn at 60° of bank has a load
    /// factor of 2.
    #[test]
    fn the_load_factor_limits_the_bank() {
        let envelope = Envelope {
            max_bank_rad: 80.0_f64.to_radians(),
            ..Envelope::default()
        };
        assert!((envelope.bank_limit_rad().to_degrees() - 60.0).abs() < 1e-9);
        assert!((Envelope::default().bank_limit_rad().to_degrees() - 30.0).abs() < 1e-9);
    }

    #[test]
    fn below_the_limits_only_descent_and_above_only_climb_is_permitted() {
        let envelope = Envelope::default();
        assert!(envelope.climb_limits(30.0).max_mps < 0.0);
        assert!(envelope.climb_limits(73.0).min_mps > 0.0);
        let cruise = envelope.climb_limits(51.4);
        assert_eq!((cruise.min_mps, cruise.max_mps), (-4.902_2, 4.902_2));
    }
}

//! The limits of what the outer loops command.

use core::ops::RangeInclusive;

use libm::{acos, cos, sqrt};

use super::MAX_TURN_BANK_RAD;
use fcc_core::blocks::{limit, limit_abs};
use fcc_navigation::Estimate;

/// The limits of what the outer loops command.
///
/// ```
/// use fcc_fixed_wing::control::Envelope;
///
/// // A level turn at 2 g has a bank of 60°; 0.1 g are kept for the path.
/// let envelope = Envelope { max_bank_rad: 1.3, max_load_factor: 2.1, ..Envelope::default() };
/// assert!((envelope.bank_limit_rad().to_degrees() - 60.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Envelope {
    /// Largest bank, rad.
    pub max_bank_rad: f64,
    /// Largest load factor in g; at least [`Envelope::LEAST_MAX_LOAD_FACTOR`].
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
    /// Airspeeds that are commanded keep this margin from either airspeed
    /// limit, m/s.
    pub airspeed_margin_mps: f64,
    /// The floor: the altitude below which nothing that is flown leads, m above
    /// mean sea level by the altimeter setting; [`Envelope::NO_FLOOR_M`] for none.
    pub floor_m: f64,
    /// Altitudes that are flown to keep this margin above the floor, m.
    pub floor_margin_m: f64,
    /// Stalling speed, clean, without power, at the heaviest weight flown,
    /// indicated, m/s.
    pub stall_airspeed_mps: f64,
    /// Airspeed of the longest glide, indicated, m/s.
    pub best_glide_airspeed_mps: f64,
    /// Manoeuvring speed (Va): up to it full deflection stalls the wing before
    /// the limit load is reached, indicated, m/s.
    pub maneuvering_airspeed_mps: f64,
    /// Never-exceed speed (Vne), indicated, m/s.
    pub never_exceed_airspeed_mps: f64,
    /// Limit load factor of the structure, g.
    pub limit_load_factor: f64,
    /// Negative limit load factor of the structure, g; negative.
    pub limit_negative_load_factor: f64,
    /// Largest angle of attack, rad: below that of the stall.
    pub max_angle_of_attack_rad: f64,
}

/// The factor over the stalling speed at the present load that the lowest
/// airspeed keeps at least.
const OVER_STALL: f64 = 1.15;
/// The part of the largest load factor that turns leave to the flight path, g: a
/// turn that needs all of it cannot raise its path. 0.1 g turns a path at 100 kt
/// by 1° in a second.
const RESERVED_LOAD: f64 = 0.1;
/// Gusts of so many standard deviations count as load.
const GUST_DEVIATIONS: f64 = 2.0;
/// The bank that is left to a slow aircraft, rad (5°).
const LEAST_BANK_RAD: f64 = 0.087;

impl Default for Envelope {
    /// A Cessna 172. The stalling speed is that of the heaviest one, the R172K at
    /// 2,550 lb (its handbook of 1977: 53 KCAS, flaps up, power off); glide,
    /// manoeuvring and never-exceed speed are the 172N's (65, 97 and 160 KIAS);
    /// loads of the normal category (14 CFR 23.337: +3.8, -0.4 times that).
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
            floor_margin_m: 15.24,          // 50 ft
            stall_airspeed_mps: 27.265_556, // 53 kt
            best_glide_airspeed_mps: 33.438_889,
            maneuvering_airspeed_mps: 49.901_111,  // 97 kt
            never_exceed_airspeed_mps: 82.311_111, // 160 kt
            limit_load_factor: 3.8,
            limit_negative_load_factor: -1.52,
            max_angle_of_attack_rad: 12.0_f64.to_radians(),
        }
    }
}

impl Envelope {
    /// The floor if there is none: 1,500 ft below sea level, below all land.
    pub const NO_FLOOR_M: f64 = -457.2;

    /// The lowest altitude that may be commanded, m above mean sea level: a margin
    /// above the floor. None without a floor.
    pub fn lowest_altitude_m(&self) -> Option<f64> {
        (self.floor_m > Self::NO_FLOOR_M).then_some(self.floor_m + self.floor_margin_m)
    }

    /// The smallest of the largest load factors with which turns are flown, g:
    /// the reserve, and 0.01 g for a bank of 8°.
    pub const LEAST_MAX_LOAD_FACTOR: f64 = 1.11;

    /// The bank limit: the configured one, or the one at which a level turn
    /// (n = 1/cos φ) leaves 0.1 g of the largest load factor, whichever is less;
    /// rad.
    pub fn bank_limit_rad(&self) -> f64 {
        let load = (self.max_load_factor - RESERVED_LOAD).max(1.0);
        self.max_bank_rad.min(acos(1.0 / load))
    }

    /// The bank limit at an airspeed, rad: less where the aircraft is too slow
    /// for the load of the turn, the wing's gusts included.
    pub fn bank_limit_at_rad(&self, estimate: &Estimate) -> f64 {
        let ratio = estimate.airspeed_mps / (OVER_STALL * self.stall_airspeed_mps);
        let load = ratio * ratio - GUST_DEVIATIONS * estimate.gust_load;
        let slow = acos(1.0 / load.max(1.0));
        self.bank_limit_rad().min(slow.max(LEAST_BANK_RAD))
    }

    /// The lowest indicated airspeed for the load of the present bank and of the
    /// present gusts, m/s: a wing stalls at the stalling speed times the root of
    /// the load (FAA-H-8083-3C, chapter 5).
    pub fn floor_mps(&self, estimate: &Estimate) -> f64 {
        self.floor_in_turn_mps(estimate.roll_rad, estimate.gust_load)
    }

    /// The same for a bank, rad, and a load of gusts, g, one standard deviation.
    pub(crate) fn floor_in_turn_mps(&self, bank_rad: f64, gust_load: f64) -> f64 {
        let bank = limit_abs(bank_rad, MAX_TURN_BANK_RAD);
        let load = 1.0 / cos(bank) + GUST_DEVIATIONS * gust_load;
        let stall = OVER_STALL * self.stall_airspeed_mps * sqrt(load.max(1.0));
        let middle = 0.5 * (self.min_airspeed_mps + self.max_airspeed_mps);
        limit(stall, self.min_airspeed_mps, middle)
    }

    /// The least airspeed for the throttle to hold, m/s: above the floor.
    pub fn least_target_mps(&self, estimate: &Estimate) -> f64 {
        self.floor_mps(estimate) + 0.5 * self.airspeed_margin_mps
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
    fn the_load_factor_less_a_reserve_limits_the_bank() {
        let degrees = |max_load_factor| {
            let envelope = Envelope {
                max_bank_rad: 80.0_f64.to_radians(),
                max_load_factor,
                ..Envelope::default()
            };
            envelope.bank_limit_rad().to_degrees()
        };
        assert!((degrees(2.1) - 60.0).abs() < 1e-9);
        // 1/cos 17.75° is 1.05, 1/cos 8.07° is 1.01.
        assert!((degrees(1.15) - 17.75).abs() < 0.01);
        assert!((degrees(Envelope::LEAST_MAX_LOAD_FACTOR) - 8.07).abs() < 0.01);
        assert!((Envelope::default().bank_limit_rad().to_degrees() - 30.0).abs() < 1e-9);
    }

    /// FAA-H-8083-3C, chapter 5: the stalling speed at 45° of bank is 1.19 times
    /// that of level flight.
    #[test]
    fn the_floor_rises_with_the_root_of_the_load() {
        let envelope = Envelope {
            min_airspeed_mps: 10.0,
            ..Envelope::default()
        };
        let banked = |degrees: f64| Estimate {
            roll_rad: degrees.to_radians(),
            ..Estimate::default()
        };
        let level = envelope.floor_mps(&banked(0.0));
        assert!((level / envelope.stall_airspeed_mps - 1.15).abs() < 1e-9);
        assert!((envelope.floor_mps(&banked(45.0)) / level - 1.19).abs() < 0.01);
    }

    #[test]
    fn a_slow_aircraft_banks_less() {
        let envelope = Envelope::default();
        let at = |knots: f64, gust_load: f64| {
            envelope
                .bank_limit_at_rad(&Estimate {
                    airspeed_mps: knots * 0.514_444,
                    gust_load,
                    ..Estimate::default()
                })
                .to_degrees()
        };
        assert_eq!(at(73.0, 0.0), at(100.0, 0.0));
        assert!(at(57.0, 0.0) < 29.0);
        assert!((at(50.0, 0.0) - 5.0).abs() < 0.1);
        assert!(at(73.0, 0.4) < 30.0);
    }
}

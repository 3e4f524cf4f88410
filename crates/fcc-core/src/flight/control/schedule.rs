//! The scaling of gains with airspeed.

use crate::blocks::limit;

/// The scaling of gains with airspeed, by the ratio of the reference airspeed
/// to the present.
///
/// ```
/// use fcc_core::flight::control::Schedule;
///
/// // At √2 times the reference airspeed dynamic pressure is twice as high.
/// let schedule = Schedule::at(2.0_f64.sqrt() * 50.0, 50.0);
/// assert!((schedule.moment - 0.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Schedule {
    /// For moments: a surface's moment is proportional to dynamic pressure, so
    /// this is (V₀/V)².
    pub moment: f64,
    /// For rates: at a given deflection the turn rate is proportional to
    /// airspeed, so this is V₀/V.
    pub rate: f64,
}

/// The limit of the ratio, in both directions: a blocked pitot tube must not
/// make the gains extremely large or small.
const MAX_RATIO: f64 = 1.8;

impl Schedule {
    /// The schedule at an indicated airspeed.
    pub fn at(airspeed_mps: f64, reference_mps: f64) -> Self {
        let ratio = limit(
            reference_mps / airspeed_mps.max(1.0),
            1.0 / MAX_RATIO,
            MAX_RATIO,
        );
        Self {
            moment: ratio * ratio,
            rate: ratio,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_dynamic_pressure_halves_the_gain() {
        let schedule = Schedule::at(50.0 * core::f64::consts::SQRT_2, 50.0);
        assert!((schedule.moment - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_blocked_pitot_tube_is_bounded() {
        assert!(Schedule::at(0.0, 50.0).moment <= 1.8 * 1.8);
        assert!(Schedule::at(500.0, 50.0).moment >= 1.0 / (1.8 * 1.8));
    }
}

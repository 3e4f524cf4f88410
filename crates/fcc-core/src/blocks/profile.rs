//! The speed at which to close an error without overshoot.

use libm::sqrt;

/// The speed at which to close an error so that braking at a constant
/// deceleration ends at zero: proportional near the target, a square root
/// further out, with a continuous slope.
///
/// From v² = 2 a s. With gain k the proportional part extends to e₀ = a/k²;
/// beyond it, v = √(2a(|e| - e₀/2)).
///
/// ```
/// use fcc_core::blocks::SquareRootProfile;
///
/// // 100 m to go, braking with 2 m/s²: v² = 2 a s allows 20 m/s.
/// let brake = SquareRootProfile { gain_per_s: 10.0, deceleration: 2.0 };
/// assert!((brake.speed(100.0) - 20.0).abs() < 0.01);
/// assert!((brake.speed(-0.01) + 0.1).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SquareRootProfile {
    /// Closing speed per error near the target, 1/s; positive.
    pub gain_per_s: f64,
    /// The planned deceleration, units/s²; positive.
    pub deceleration: f64,
}

impl SquareRootProfile {
    /// The closing speed for an error, units/s, with the sign of the error.
    pub fn speed(&self, error: f64) -> f64 {
        let knee = self.deceleration / (self.gain_per_s * self.gain_per_s);
        let distance = error.abs();
        if distance <= knee {
            self.gain_per_s * error
        } else {
            sqrt(2.0 * self.deceleration * (distance - 0.5 * knee)).copysign(error)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: SquareRootProfile = SquareRootProfile {
        gain_per_s: 0.5,
        deceleration: 1.0,
    };

    #[test]
    fn value_and_slope_are_continuous() {
        let knee = 4.0;
        assert!((PROFILE.speed(knee) - 2.0).abs() < 1e-12);
        let slope = (PROFILE.speed(knee + 1e-6) - PROFILE.speed(knee)) / 1e-6;
        assert!((slope - 0.5).abs() < 1e-5);
    }

    /// When the profile is followed exactly, the deceleration never exceeds the
    /// planned one.
    #[test]
    fn following_it_brakes_as_planned_without_overshoot() {
        let (mut error, dt) = (100.0_f64, 1e-3);
        let mut last = PROFILE.speed(error);
        for _ in 0..40_000 {
            error -= PROFILE.speed(error) * dt;
            let speed = PROFILE.speed(error);
            assert!(error >= 0.0);
            assert!((last - speed) / dt <= 1.0 + 1e-2);
            last = speed;
        }
        assert!(error < 1e-3);
    }

    #[test]
    fn it_is_an_odd_function() {
        assert!((PROFILE.speed(-30.0) + PROFILE.speed(30.0)).abs() < 1e-15);
    }
}

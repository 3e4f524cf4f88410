//! L1: Park, Deyst and How, "A New Nonlinear Guidance Logic for Trajectory
//! Tracking", AIAA 2004-4900.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use libm::{asin, atan2, sin};

use super::law::TurnDirection;
use super::{LateralLaw, Motion, Path, cross, length, unit};

/// Period and damping of L1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct L1Config {
    /// Of the oscillation around a straight line, s, positive.
    pub period_s: f64,
    /// Of the same; 1/√2 is the paper's.
    pub damping: f64,
}

impl Default for L1Config {
    /// The paper's damping, and a period that leaves 1 s of roll lag its room.
    fn default() -> Self {
        Self {
            period_s: 17.0,
            damping: FRAC_1_SQRT_2,
        }
    }
}

/// The law: the acceleration of a circle from the aircraft to a reference point on
/// the path, L1 ahead.
///
/// a = 4ζ²V²/L1 · sin η (the paper's equation 1 with ζ = 1/√2: 2V²/L1 · sin η), with
/// V the speed over the ground and L1 = ζTV/π. On a circle the part of sin η that is
/// the circle's own, L1/2R, has the paper's factor 2, so that it is V²/R with any
/// damping. There L1 is at most R, which the paper requires for convergence.
///
/// The paper's acceleration is perpendicular to the ground velocity; a bank
/// accelerates perpendicular to the air velocity, so it is divided by the cosine of
/// the angle between both.
///
/// ```
/// use fcc_guidance::path::{L1, L1Config, LateralLaw, Motion, Path};
/// use nalgebra::Vector2;
///
/// // On the circle without wind: V²/R (the paper's section III.B).
/// let path = Path::Circle { centre_m: Vector2::zeros(), radius_m: 1_000.0, clockwise: true };
/// let motion = Motion {
///     position_m: Vector2::new(0.0, 1_000.0),
///     ground_velocity_mps: Vector2::new(-50.0, 0.0),
///     wind_mps: Vector2::zeros(),
/// };
/// let a = L1::new(L1Config::default()).acceleration_mps2(&path, &motion);
/// assert!((a - 2.5).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct L1 {
    config: L1Config,
    direction: TurnDirection,
}

/// Slower than this over the ground the direction of flight says nothing, m/s.
const LEAST_SPEED_MPS: f64 = 1.0;
/// The least cosine of the crab angle that is divided by: 78°.
const LEAST_COSINE: f64 = 0.2;

impl L1 {
    /// With a configuration.
    pub fn new(config: L1Config) -> Self {
        Self {
            config,
            direction: TurnDirection::default(),
        }
    }

    /// The distance of the reference point at a speed over the ground, m.
    pub fn distance_m(&self, ground_speed_mps: f64) -> f64 {
        self.config.damping * self.config.period_s * ground_speed_mps / PI
    }
}

impl LateralLaw for L1 {
    fn acceleration_mps2(&mut self, path: &Path, motion: &Motion) -> f64 {
        let speed = length(motion.ground_velocity_mps).max(LEAST_SPEED_MPS);
        let (Some(course), Some(heading)) = (
            unit(motion.ground_velocity_mps),
            unit(motion.air_velocity_mps()),
        ) else {
            return 0.0;
        };
        let nearest = path.nearest(motion.position_m);
        let mut l1 = self.distance_m(speed);
        if let Path::Circle { radius_m, .. } = path {
            l1 = l1.min(*radius_m);
        }
        // The way from the nearest point of the path to the reference point.
        let off = (nearest.cross_track_m / l1).clamp(-FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        let ahead = half_chord_rad(l1, nearest.curvature_per_m);
        let to_path = atan2(cross(course, nearest.course), course.dot(&nearest.course));
        let eta = self.direction.keep(to_path) - asin(off) + ahead;
        let eta = eta.clamp(-FRAC_PI_2, FRAC_PI_2);
        let gain = 4.0 * self.config.damping * self.config.damping * speed * speed / l1;
        let along = 2.0 * speed * speed / l1;
        let a = gain * (sin(eta) - sin(ahead)) + along * sin(ahead);
        let crab = course.dot(&heading).max(LEAST_COSINE);
        a / crab
    }
}

/// The angle between the path and the way to the point L1 ahead on it: asin(L1/2R).
fn half_chord_rad(l1: f64, curvature_per_m: f64) -> f64 {
    asin((0.5 * l1 * curvature_per_m).clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    const PAPER: L1Config = L1Config {
        period_s: 17.0,
        damping: FRAC_1_SQRT_2,
    };

    fn motion(north: f64, east: f64, course_deg: f64, speed: f64) -> Motion {
        let course = course_deg.to_radians();
        Motion {
            position_m: Vector2::new(north, east),
            ground_velocity_mps: Vector2::new(course.cos(), course.sin()) * speed,
            wind_mps: Vector2::zeros(),
        }
    }

    const NORTH: Path = Path::Line {
        through_m: Vector2::new(0.0, 0.0),
        course: Vector2::new(1.0, 0.0),
    };

    /// Equation 1 of the paper: a = 2V²/L1 · sin η, with η the angle to a point on
    /// the line at the distance L1.
    #[test]
    fn is_the_papers_equation_on_a_line() {
        let mut law = L1::new(PAPER);
        let l1 = law.distance_m(50.0);
        // ζT/π = 0.7071 · 17 / 3.14159 = 3.826 s.
        assert!((l1 - 191.3).abs() < 0.1, "{l1}");
        // Parallel to the line, 95.65 m to its right: sin η = -1/2.
        let a = law.acceleration_mps2(&NORTH, &motion(0.0, l1 / 2.0, 0.0, 50.0));
        assert!((a + 50.0 * 50.0 / l1).abs() < 1e-9, "{a}");
        // On the line, 30° to the right of it: sin η = -1/2.
        let a = law.acceleration_mps2(&NORTH, &motion(0.0, 0.0, 30.0, 50.0));
        assert!((a + 50.0 * 50.0 / l1).abs() < 1e-9, "{a}");
    }

    #[test]
    fn keeps_turning_the_same_way() {
        let mut law = L1::new(PAPER);
        let first = law.acceleration_mps2(&NORTH, &motion(0.0, 0.0, 179.0, 50.0));
        assert!(first < 0.0);
        let second = law.acceleration_mps2(&NORTH, &motion(0.0, 0.0, 181.0, 50.0));
        assert!(second < 0.0, "{second}");
    }
}

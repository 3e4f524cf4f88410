//! The path over time that the position loop follows: limited in speed, acceleration and jerk.

use libm::{hypot, sqrt};
use nalgebra::Vector3;

/// Of the way that is left, speed is at most this share per second, 1/s.
const APPROACH_PER_S: f64 = 2.0;
/// How fast a difference in speed disappears, 1/s: the approach is critically damped.
pub(crate) const SPEED_PER_S: f64 = 4.0 * APPROACH_PER_S;
/// The share of the acceleration that braking uses; the rest is for turning.
const BRAKING: f64 = 0.6;

/// A straight way.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Leg {
    /// Its begin, m.
    pub from_m: Vector3<f64>,
    /// Its end, m.
    pub to_m: Vector3<f64>,
    /// Along it, m/s.
    pub speed_mps: f64,
    /// At its end, m/s.
    pub exit_mps: f64,
}

impl Leg {
    /// Its direction; zero for a leg without length.
    pub fn direction(&self) -> Vector3<f64> {
        let way = self.to_m - self.from_m;
        way.try_normalize(1e-3).unwrap_or_default()
    }
}

/// A point that moves.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Trajectory {
    /// m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// m/s².
    pub acceleration_mps2: Vector3<f64>,
}

impl Trajectory {
    /// Moves along a leg, within an acceleration, m/s², and a jerk, m/s³. Returns the way that
    /// is left, m.
    pub fn follow(&mut self, leg: &Leg, most_mps2: f64, jerk_mps3: f64, dt_s: f64) -> f64 {
        let left = leg.to_m - self.position_m;
        let direction = leg.direction();
        let is_line = direction != Vector3::zeros();
        let line = if is_line {
            direction
        } else {
            left.try_normalize(1e-9).unwrap_or_default()
        };
        let along_m = left.dot(&line);
        let across = if is_line {
            left - line * along_m
        } else {
            Vector3::zeros()
        };
        let brakes_mps2 = BRAKING * most_mps2;
        let speed_mps = hypot(approach(along_m.abs(), brakes_mps2), leg.exit_mps);
        let ahead_mps = speed_mps.min(leg.speed_mps).copysign(along_m);
        let back_mps = approach(across.norm(), brakes_mps2).min(leg.speed_mps);
        let back = across.try_normalize(1e-9).unwrap_or_default() * back_mps;
        self.accelerate(&(line * ahead_mps), &back, most_mps2, jerk_mps3, dt_s);
        (leg.to_m - self.position_m).norm()
    }

    /// Changes the velocity towards a wanted one, and moves. What is across the line comes before
    /// what is along it.
    pub(crate) fn accelerate(
        &mut self,
        along_mps: &Vector3<f64>,
        across_mps: &Vector3<f64>,
        most_mps2: f64,
        jerk_mps3: f64,
        dt_s: f64,
    ) {
        let change = along_mps + across_mps - self.velocity_mps;
        let line = along_mps.try_normalize(1e-9).unwrap_or_default();
        let along = line * change.dot(&line);
        let first = ((change - along) * SPEED_PER_S).cap_magnitude(most_mps2);
        let rest_mps2 = sqrt((most_mps2 * most_mps2 - first.norm_squared()).max(0.0));
        let wanted_mps2 = first + (along * SPEED_PER_S).cap_magnitude(rest_mps2);
        self.acceleration_mps2 +=
            (wanted_mps2 - self.acceleration_mps2).cap_magnitude(jerk_mps3 * dt_s);
        self.velocity_mps += self.acceleration_mps2 * dt_s;
        self.position_m += self.velocity_mps * dt_s;
    }
}

/// The speed at which a way is left in which it can stop: in proportion to it near the end, and
/// by v² = 2as farther away.
fn approach(way_m: f64, brakes_mps2: f64) -> f64 {
    let near_m = brakes_mps2 / (APPROACH_PER_S * APPROACH_PER_S);
    if way_m < near_m {
        APPROACH_PER_S * way_m
    } else {
        sqrt(2.0 * brakes_mps2 * (way_m - 0.5 * near_m))
    }
}

/// The speed through a corner between two directions, and how far before it the turn begins, if
/// the path may be `rounding_m` inside of it: an arc of the radius R = r cos/(1 - cos) of half
/// the angle, begun R tan of it before.
pub(crate) fn corner(
    before: &Vector3<f64>,
    after: &Vector3<f64>,
    rounding_m: f64,
    most_mps2: f64,
    speed_mps: f64,
) -> (f64, f64) {
    let cos = before.dot(after).clamp(-1.0, 1.0);
    let (cos_half, sin_half) = (sqrt(0.5 * (1.0 + cos)), sqrt(0.5 * (1.0 - cos)));
    if cos_half < 1e-3 {
        return (0.0, 0.0);
    }
    let radius_m = rounding_m * cos_half / (1.0 - cos_half).max(1e-6);
    let passes_mps = sqrt(BRAKING * most_mps2 * radius_m).min(speed_mps);
    let radius_m = passes_mps * passes_mps / (BRAKING * most_mps2);
    // The turn begins as late as the velocity lags.
    let lag_m = passes_mps / SPEED_PER_S * sin_half;
    (passes_mps, radius_m * sin_half / cos_half + lag_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 5 m with 3.5 m/s²: a bang-bang path takes 2√(5/3.5) = 2.4 s, and this one is
    /// to be within 0.3 m after 3 s without overshoot.
    #[test]
    fn a_step_ends_where_it_is_to() {
        let mut path = Trajectory::default();
        let leg = Leg {
            to_m: Vector3::new(3.0, 4.0, 0.0),
            speed_mps: 8.0,
            ..Leg::default()
        };
        let (mut within_s, mut beyond_m) = (0.0, 0.0_f64);
        for tick in 1..4_000_u32 {
            let before = path.acceleration_mps2;
            let left_m = path.follow(&leg, 3.5, 25.0, 0.0025);
            if left_m > 0.3 {
                within_s = f64::from(tick) * 0.0025;
            }
            beyond_m = beyond_m.max(path.position_m.norm() - 5.0);
            assert!(path.acceleration_mps2.norm() <= 3.5 + 1e-9);
            assert!((path.acceleration_mps2 - before).norm() <= 25.0 * 0.0025 + 1e-9);
        }
        assert!(within_s < 2.9, "{within_s}");
        assert!(beyond_m < 0.02, "{beyond_m}");
        assert!((path.position_m - leg.to_m).norm() < 1e-3);
    }

    /// A right angle may be rounded by 0.5 m: R = 0.5/(√2 - 1) = 1.207 m, and the turn begins
    /// as far before the corner, and as the velocity lags, 1.6 m/s / 8 · sin 45°.
    #[test]
    fn corners_are_rounded_as_far_as_permitted() {
        let (speed, before_m) = corner(&Vector3::x(), &Vector3::y(), 0.5, 3.5, 8.0);
        assert!(
            (speed - (0.6_f64 * 3.5 * 1.207).sqrt()).abs() < 0.01,
            "{speed}"
        );
        assert!((before_m - 1.207 - 0.141).abs() < 0.001, "{before_m}");
        assert_eq!(
            corner(&Vector3::x(), &-Vector3::x(), 0.5, 3.5, 8.0),
            (0.0, 0.0)
        );
        let (speed, before_m) = corner(&Vector3::x(), &Vector3::x(), 0.5, 3.5, 8.0);
        assert!(speed == 8.0 && before_m < 1e-6);
    }
}

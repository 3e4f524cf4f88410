//! Turns in wind: how fast over the ground, how wide, and where they begin.
//!
//! An aircraft of airspeed V in a wind W that flies a circle of the curvature κ over
//! the ground has to accelerate by κ·Vg²/cos(crab): its course changes by κ·Vg, and
//! of the acceleration, which is perpendicular to the air velocity, the part that is
//! perpendicular to the course is the cosine of the angle between both. It is
//! largest downwind, κ·(V + W)².

use core::f64::consts::PI;

use libm::{acos, atan2, cos, hypot, sin, sqrt, tan};
use nalgebra::Vector2;

use fcc_core::blocks::wrap_pi;
use fcc_core::units::GRAVITY_MPS2;

/// The speed over the ground along a course, m/s: the wind triangle. None if the
/// wind is too strong for this course.
///
/// ```
/// use fcc_guidance::path::turn::ground_speed_mps;
/// use nalgebra::Vector2;
///
/// // 100 kt with 20 kt from the right: √(100² - 20²) = 97.98 kt (FAA-H-8083-25,
/// // chapter 16, gives the same triangle).
/// let kt = 1_852.0 / 3_600.0;
/// let speed = ground_speed_mps(0.0, 100.0 * kt, Vector2::new(0.0, -20.0 * kt)).unwrap();
/// assert!((speed / kt - 97.98).abs() < 0.005);
/// ```
pub fn ground_speed_mps(course_rad: f64, airspeed_mps: f64, wind_mps: Vector2<f64>) -> Option<f64> {
    let (along, across) = (
        wind_mps.x * cos(course_rad) + wind_mps.y * sin(course_rad),
        wind_mps.y * cos(course_rad) - wind_mps.x * sin(course_rad),
    );
    let rest = airspeed_mps * airspeed_mps - across * across;
    if rest <= 0.0 {
        return None;
    }
    let speed = sqrt(rest) + along;
    (speed > 0.0).then_some(speed)
}

/// The smallest radius of a whole circle over the ground, m, with a bank in rad; none
/// if the wind is not weaker than the airspeed.
///
/// ```
/// use fcc_guidance::path::turn::smallest_circle_m;
///
/// // 100 kt, 30°: V²/(g tan φ) = 467.4 m in calm air, 618.2 m in 15 kt.
/// let kt = 1_852.0 / 3_600.0;
/// let bank = 30.0_f64.to_radians();
/// assert!((smallest_circle_m(100.0 * kt, 0.0, bank).unwrap() - 467.4).abs() < 0.1);
/// assert!((smallest_circle_m(100.0 * kt, 15.0 * kt, bank).unwrap() - 618.2).abs() < 0.1);
/// assert!(smallest_circle_m(10.0, 10.0, bank).is_none());
/// ```
pub fn smallest_circle_m(airspeed_mps: f64, wind_mps: f64, bank_rad: f64) -> Option<f64> {
    let downwind = airspeed_mps + wind_mps;
    (wind_mps < airspeed_mps).then(|| downwind * downwind / (GRAVITY_MPS2 * tan(bank_rad)))
}

/// The smallest radius over the ground of a turn from a course through an angle, rad,
/// positive to the right, with a bank in rad; none if the wind is too strong.
pub fn smallest_turn_m(
    from_course_rad: f64,
    through_rad: f64,
    airspeed_mps: f64,
    wind_mps: Vector2<f64>,
    bank_rad: f64,
) -> Option<f64> {
    let downwind_rad = atan2(wind_mps.y, wind_mps.x);
    // The courses nearest to downwind: it itself, or an end of the turn.
    let half = 0.5 * through_rad;
    let from_middle = wrap_pi(downwind_rad - (from_course_rad + half));
    let worst = from_course_rad + half + from_middle.clamp(-half.abs(), half.abs());
    let wind = hypot(wind_mps.x, wind_mps.y);
    if wind >= airspeed_mps {
        return None;
    }
    let speed = ground_speed_mps(worst, airspeed_mps, wind_mps)?;
    let across = wind * sin(worst - downwind_rad) / airspeed_mps;
    let cosine = sqrt(1.0 - across * across);
    Some(speed * speed / (cosine * GRAVITY_MPS2 * tan(bank_rad)))
}

/// The largest turn that is flown before its waypoint, rad; a sharper one would begin
/// too long before it. A right angle of a map counts as one: from the meridians'
/// convergence and the places' rounding it is off by up to 1°.
pub const FLY_BY_RAD: f64 = 91.0 / 180.0 * PI;

/// A turn at a waypoint from one leg onto the next, over the ground: one arc before
/// the waypoint (fly-by), or behind it an arc beyond the next course and one back
/// (fly-over).
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Turn {
    /// Along an arc that touches both legs.
    FlyBy {
        /// From the beginning of the arc to the waypoint, and from there to its end,
        /// m.
        lead_m: f64,
    },
    /// Over the waypoint.
    FlyOver {
        /// How far beyond the next course the first arc turns, rad, positive.
        beyond_rad: f64,
        /// From the waypoint to the end of the second arc, along the next leg, m.
        rejoin_m: f64,
    },
}

impl Turn {
    /// The turn through an angle in rad, to either side, with arcs of a radius in m.
    ///
    /// A turn through Δ with a radius R leads by R·tan(Δ/2). An arc from the waypoint
    /// through Δ + β and one back through β end on the next leg if
    /// cos β = (1 + cos Δ)/2, at the distance R·(2 sin β + sin Δ).
    ///
    /// ```
    /// use fcc_guidance::path::turn::Turn;
    ///
    /// // 90°: the lead is the radius. 180°: a half circle and 90°, and 90° back.
    /// let Turn::FlyBy { lead_m } = Turn::new(90.0_f64.to_radians(), 500.0) else { panic!() };
    /// assert!((lead_m - 500.0).abs() < 1e-9);
    /// let turn = Turn::new(-180.0_f64.to_radians(), 500.0);
    /// let Turn::FlyOver { beyond_rad, rejoin_m } = turn else { panic!() };
    /// assert!((beyond_rad.to_degrees() - 90.0).abs() < 1e-6);
    /// assert!((rejoin_m - 1_000.0).abs() < 1e-6);
    /// ```
    pub fn new(through_rad: f64, radius_m: f64) -> Self {
        let angle = through_rad.abs().min(PI);
        if angle <= FLY_BY_RAD {
            return Self::FlyBy {
                lead_m: radius_m * tan(0.5 * angle),
            };
        }
        Self::over(angle, radius_m)
    }

    /// The same, but over the waypoint where the arc of a fly-by would pass it at more
    /// than a distance, m: R(1/cos(Δ/2) - 1).
    ///
    /// ```
    /// use fcc_guidance::path::turn::Turn;
    ///
    /// // 90° with 500 m pass at 207 m.
    /// let angle = 90.0_f64.to_radians();
    /// assert!(matches!(Turn::within(angle, 500.0, 208.0), Turn::FlyBy { .. }));
    /// assert!(matches!(Turn::within(angle, 500.0, 207.0), Turn::FlyOver { .. }));
    /// ```
    pub fn within(through_rad: f64, radius_m: f64, within_m: f64) -> Self {
        let turn = Self::new(through_rad, radius_m);
        let angle = through_rad.abs().min(PI);
        let passes_m = radius_m * (1.0 / cos(0.5 * angle) - 1.0);
        match turn {
            Self::FlyBy { .. } if passes_m > within_m => Self::over(angle, radius_m),
            turn => turn,
        }
    }

    fn over(angle: f64, radius_m: f64) -> Self {
        let beyond_rad = acos(0.5 * (1.0 + cos(angle)));
        Self::FlyOver {
            beyond_rad,
            rejoin_m: radius_m * (2.0 * sin(beyond_rad) + sin(angle)),
        }
    }

    /// What it needs of the leg before the waypoint, m.
    pub const fn before_m(&self) -> f64 {
        match *self {
            Self::FlyBy { lead_m } => lead_m,
            Self::FlyOver { .. } => 0.0,
        }
    }

    /// What it needs of the leg behind it, m.
    pub const fn after_m(&self) -> f64 {
        match *self {
            Self::FlyBy { lead_m } => lead_m,
            Self::FlyOver { rejoin_m, .. } => rejoin_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KT: f64 = 1_852.0 / 3_600.0;

    /// A turn's smallest radius is the one at the worst of all of its courses, found
    /// by trying them.
    #[test]
    fn the_worst_course_of_a_turn_is_found() {
        for wind_from in 0..36 {
            let to = f64::from(wind_from).mul_add(10.0, 180.0).to_radians();
            let wind = Vector2::new(to.cos(), to.sin()) * (20.0 * KT);
            for through_deg in [-150.0_f64, -90.0, -30.0, 30.0, 90.0, 150.0] {
                let through = through_deg.to_radians();
                let found =
                    smallest_turn_m(1.0, through, 100.0 * KT, wind, 30.0_f64.to_radians()).unwrap();
                let tried = (0..=1_000)
                    .map(|n| 1.0 + through * f64::from(n) / 1_000.0)
                    .map(|course| {
                        // By vectors: a unit of course, and the air velocity that it needs.
                        let unit = Vector2::new(course.cos(), course.sin());
                        let speed = ground_speed_mps(course, 100.0 * KT, wind).unwrap();
                        let air = (unit * speed - wind).normalize();
                        speed * speed / (air.dot(&unit) * 9.806_65 * 30.0_f64.to_radians().tan())
                    })
                    .fold(0.0, f64::max);
                assert!(tried <= found * (1.0 + 1e-9), "{tried} {found}");
                assert!(tried >= found * (1.0 - 1e-5), "{tried} {found}");
            }
        }
    }
}

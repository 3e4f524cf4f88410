//! NPFG: nonlinear path following guidance for wind of any strength. Stastny, "L1
//! Guidance Logic Extension for Small UAVs: Handling High Winds and Small Loiter
//! Radii", arXiv 1804.04209, 2018; Stastny and Siegwart, "On Flying Backwards:
//! Preventing Run-away of Small, Low-speed, Fixed-wing UAVs in Strong Winds", IROS
//! 2019; Stastny, "Low-Altitude Control and Local Re-Planning Strategies for Small
//! Fixed-Wing Unmanned Aerial Vehicles", ETH Zürich 2020, chapter 4.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use libm::{atan2, cos, sin, sqrt};
use nalgebra::Vector2;

use super::{Motion, Nearest, Path, cross, length, unit};

/// Period and damping of NPFG.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NpfgConfig {
    /// Of the oscillation around a path, s. A lag of roll needs at least 1.5π of it,
    /// divided by the damping, and a limited rate of the bank more: with 15°/s, 12 s
    /// end in an oscillation.
    pub period_s: f64,
    /// Of the same.
    pub damping: f64,
}

impl Default for NpfgConfig {
    /// For 1 s of roll lag, and a bank that changes by 15° in a second.
    fn default() -> Self {
        Self {
            period_s: 20.0,
            damping: FRAC_1_SQRT_2,
        }
    }
}

/// The law: a bearing over the ground that turns from the shortest way to the path
/// into the path's own course, the air velocity that gives this bearing in the wind,
/// and the acceleration that turns the present air velocity into it; on a curved
/// path the acceleration that keeps it there is added.
///
/// Where no heading gives the bearing, because the wind is too strong, the aircraft
/// is carried away as little as possible; in between both are blended.
///
/// ```
/// use fcc_guidance::path::{Motion, Npfg, NpfgConfig, Path};
/// use nalgebra::Vector2;
///
/// // On a line to the north in 10 m/s of wind from the west, with the heading that
/// // compensates it: nothing to do.
/// let path = Path::Line { through_m: Vector2::zeros(), course: Vector2::new(1.0, 0.0) };
/// let motion = Motion {
///     position_m: Vector2::new(500.0, 0.0),
///     ground_velocity_mps: Vector2::new(45.0, 0.0),
///     wind_mps: Vector2::new(0.0, 10.0),
/// };
/// let a = Npfg::new(NpfgConfig::default()).acceleration_mps2(&path, &motion);
/// assert!(a.abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Npfg {
    config: NpfgConfig,
    direction: TurnDirection,
}

/// Over what margin of airspeed over the wind feasible becomes infeasible, m/s.
const MARGIN_MPS: f64 = 1.5;
/// A path is turned around at most so sharply, as a share of its radius: inside of
/// a circle's centre its curvature is infinite.
const LEAST_RADIUS_SHARE: f64 = 0.1;

impl Npfg {
    /// With a configuration.
    pub fn new(config: NpfgConfig) -> Self {
        Self {
            config,
            direction: TurnDirection::default(),
        }
    }

    /// The acceleration to the right of the air velocity, m/s², that brings an aircraft onto
    /// a path and along it. It is finite for any finite motion.
    pub fn acceleration_mps2(&mut self, path: &Path, motion: &Motion) -> f64 {
        let air = motion.air_velocity_mps();
        let (airspeed, wind) = (length(air), motion.wind_mps);
        let Some(heading) = unit(air) else {
            return 0.0;
        };
        let nearest = path.nearest(motion.position_m);
        let (proximity, bearing) = self.bearing(&nearest, motion);
        let wanted = air_velocity_for(bearing, airspeed, wind);
        let error = self
            .direction
            .keep(atan2(cross(heading, wanted), heading.dot(&wanted)));
        let gain = 4.0 * PI * self.config.damping / self.config.period_s;
        // Behind the beam the largest acceleration, not less of it again.
        let turning = gain * airspeed * sin(error.clamp(-FRAC_PI_2, FRAC_PI_2));
        turning + proximity * curve(path, &nearest, motion, airspeed)
    }

    /// How near the path is: 0 where the error is so large that the shortest way is
    /// flown, 1 on the path; and the bearing, of length 1.
    fn bearing(&self, nearest: &Nearest, motion: &Motion) -> (f64, Vector2<f64>) {
        let time_s = self.config.period_s * self.config.damping;
        let speed = length(motion.ground_velocity_mps);
        // Of less than 1 m/s a parabola, so that the bound is never 0.
        let bound_m = if speed > 1.0 {
            speed * time_s
        } else {
            0.5 * time_s * (speed * speed + 1.0)
        };
        let share = (nearest.cross_track_m.abs() / bound_m).min(1.0);
        let look_ahead_rad = FRAC_PI_2 * (1.0 - share) * (1.0 - share);
        let Some(to_path) = unit(nearest.point_m - motion.position_m) else {
            return (1.0, nearest.course);
        };
        let bearing = nearest.course * sin(look_ahead_rad) + to_path * cos(look_ahead_rad);
        let proximity = sin(look_ahead_rad) * sin(look_ahead_rad);
        (proximity, unit(bearing).unwrap_or(nearest.course))
    }
}

/// From 0, where no heading gives a bearing at an airspeed in a wind, to 1.
fn feasibility(bearing: Vector2<f64>, airspeed: f64, wind: Vector2<f64>) -> f64 {
    // Against the wind its whole speed counts, not only its cross part.
    let against = if bearing.dot(&wind) < 0.0 {
        length(wind)
    } else {
        cross(wind, bearing).abs()
    };
    let share = ((airspeed - against) / MARGIN_MPS).clamp(0.0, 1.0);
    let sine = sin(FRAC_PI_2 * share);
    sine * sine
}

/// The air velocity that moves along a bearing, as nearly as the wind permits.
fn air_velocity_for(bearing: Vector2<f64>, airspeed: f64, wind: Vector2<f64>) -> Vector2<f64> {
    let feasible = feasibility(bearing, airspeed, wind);
    // The wind triangle: the cross part compensates the wind's.
    let along_wind = bearing.dot(&wind);
    let across = wind - bearing * along_wind;
    let rest = sqrt((airspeed * airspeed - across.dot(&across)).max(0.0));
    let exact = bearing * rest - across;
    let least_bad = unit(bearing * length(wind) - wind).map_or(exact, |way| way * airspeed);
    let blended = exact * feasible + least_bad * (1.0 - feasible);
    unit(blended).map_or(exact, |way| way * airspeed)
}

/// The acceleration that keeps an aircraft on a curved path in wind: κV²/cos(crab),
/// with V the speed over the ground along the path, κ that of the parallel curve on
/// which the aircraft is, and the crab angle that of the course of the path.
fn curve(path: &Path, nearest: &Nearest, motion: &Motion, airspeed: f64) -> f64 {
    if matches!(path, Path::Line { .. }) {
        return 0.0;
    }
    let course = nearest.course;
    let feasible = feasibility(course, airspeed, motion.wind_mps);
    let share = 1.0 - nearest.curvature_per_m * nearest.cross_track_m;
    let curvature = nearest.curvature_per_m / share.max(LEAST_RADIUS_SHARE);
    let along = motion.ground_velocity_mps.dot(&course).max(0.0);
    let across = cross(course, motion.wind_mps);
    let through_air = sqrt((airspeed * airspeed - across * across).max(0.0));
    let cosine = through_air / airspeed.max(1e-3);
    feasible * curvature * along * along / cosine.max(LEAST_RADIUS_SHARE)
}

/// Beyond this error of the course a turn that has begun keeps its direction: which
/// way is the shorter one may change with each gust.
const REVERSED_RAD: f64 = 0.9 * PI;

/// Keeps the direction of a turn.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct TurnDirection {
    last_rad: f64,
}

impl TurnDirection {
    /// The error of the course in -π to π, or beyond by what the turn that has
    /// begun leaves.
    fn keep(&mut self, error_rad: f64) -> f64 {
        let flips = error_rad.abs() > REVERSED_RAD
            && self.last_rad.abs() > REVERSED_RAD
            && (error_rad > 0.0) != (self.last_rad > 0.0);
        let kept = if flips { -error_rad } else { error_rad };
        self.last_rad = kept;
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NORTH: Path = Path::Line {
        through_m: Vector2::new(0.0, 0.0),
        course: Vector2::new(1.0, 0.0),
    };

    fn law() -> Npfg {
        Npfg::new(NpfgConfig::default())
    }

    /// Near a line in calm air the law is a second-order system with the period and
    /// damping of its configuration: a = -(2π/T)² e - 2ζ(2π/T) ė.
    #[test]
    fn is_a_second_order_system_near_a_line() {
        let omega = 2.0 * PI / 20.0;
        let at = |east: f64, drift: f64| {
            let motion = Motion {
                position_m: Vector2::new(0.0, east),
                ground_velocity_mps: Vector2::new(50.0, drift),
                wind_mps: Vector2::zeros(),
            };
            law().acceleration_mps2(&NORTH, &motion)
        };
        let stiffness = -at(0.01, 0.0) / 0.01;
        assert!(
            (stiffness / (omega * omega) - 1.0).abs() < 1e-3,
            "{stiffness}"
        );
        let damping = -at(0.0, 0.01) / 0.01;
        assert!(
            (damping / (2.0 * FRAC_1_SQRT_2 * omega) - 1.0).abs() < 1e-3,
            "{damping}"
        );
    }

    /// Far from the line it flies straight to it, from either side.
    #[test]
    fn flies_straight_to_a_line_that_is_far_away() {
        for (east, course) in [(5_000.0, -1.0), (-5_000.0, 1.0)] {
            let motion = Motion {
                position_m: Vector2::new(0.0, east),
                ground_velocity_mps: Vector2::new(0.0, 50.0 * course),
                wind_mps: Vector2::zeros(),
            };
            let a = law().acceleration_mps2(&NORTH, &motion);
            assert!(a.abs() < 1e-9, "{a}");
        }
    }

    /// In a wind of twice the airspeed the nose is turned against it, so that the
    /// aircraft is carried away at the difference of both (the paper's section IV).
    #[test]
    fn does_not_run_away_in_a_wind_that_is_faster() {
        let wind = Vector2::new(0.0, 20.0);
        let wanted = air_velocity_for(Vector2::new(0.0, -1.0), 10.0, wind);
        assert!(
            (wanted - Vector2::new(0.0, -10.0)).norm() < 1e-9,
            "{wanted}"
        );
        // With the wind, any bearing along it is feasible.
        let wanted = air_velocity_for(Vector2::new(0.0, 1.0), 10.0, wind);
        assert!((wanted - Vector2::new(0.0, 10.0)).norm() < 1e-9, "{wanted}");
    }
}

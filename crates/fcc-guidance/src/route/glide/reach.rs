//! How much height a path over the ground costs without power, in wind.

use libm::{ceil, cos, fabs, sin, sqrt};
use nalgebra::Vector2;

use crate::path::turn::ground_speed_mps;
use fcc_core::units::GRAVITY_MPS2;

/// A glide at constant airspeed through still air.
///
/// Height is lost with time, and the time that a path takes is the wind's: over the
/// ground it is flown with the speed of the wind triangle. A path that the wind does not
/// allow costs infinitely much.
///
/// ```
/// use fcc_guidance::route::Glide;
/// use nalgebra::Vector2;
///
/// // Handbook of the Cessna 172P (1981), figure 3-1: 1.5 nautical miles for 1,000 ft at
/// // 65 kt without wind, 9.1 to 1.
/// let kt = 1_852.0 / 3_600.0;
/// let glide = Glide::with_ratio(65.0 * kt, 9.114);
/// let lost_m = glide.straight_m(0.0, 1.5 * 1_852.0, Vector2::zeros());
/// assert!((lost_m - 304.8).abs() < 0.1);
/// // Against 20 kt the same height leads 45/65 as far.
/// let lost_m = glide.straight_m(0.0, 1.5 * 1_852.0, Vector2::new(-20.0 * kt, 0.0));
/// assert!((lost_m - 304.8 * 65.0 / 45.0).abs() < 2.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Glide {
    /// True airspeed, m/s.
    pub true_airspeed_mps: f64,
    /// Sink rate, wings level, m/s.
    pub sink_mps: f64,
}

/// Turns are added up in parts of this angle at most, rad.
const PART_RAD: f64 = 0.4;

impl Glide {
    /// With a glide ratio: the way through the air over the height that is lost.
    pub fn with_ratio(true_airspeed_mps: f64, ratio: f64) -> Self {
        Self {
            true_airspeed_mps,
            sink_mps: true_airspeed_mps / sqrt(1.0 + ratio * ratio),
        }
    }

    /// The height that a straight way of this length costs, m, on a true course, rad, with
    /// the air moving to `wind_mps`.
    pub fn straight_m(&self, course_rad: f64, distance_m: f64, wind_mps: Vector2<f64>) -> f64 {
        match ground_speed_mps(course_rad, self.horizontal_mps(), wind_mps) {
            Some(speed_mps) => self.sink_mps * distance_m / speed_mps,
            None => f64::INFINITY,
        }
    }

    /// The height that an arc over the ground costs, m, from a course through an angle, rad,
    /// positive to the right.
    ///
    /// With the polar D = D₀ (q/q₀ + n² q₀/q)/2 at the airspeed of the best glide, q = q₀, the
    /// drag, and with it the sink rate, is (1 + n²)/2 of that in level flight, n being the
    /// load factor (Anderson 1999, Aircraft Performance and Design, section 5.4 and 6.2);
    /// n² = 1 + (a/g)², where a is what the arc needs across the airspeed.
    pub fn arc_m(
        &self,
        from_course_rad: f64,
        through_rad: f64,
        radius_m: f64,
        wind_mps: Vector2<f64>,
    ) -> f64 {
        let parts = ceil(fabs(through_rad) / PART_RAD).max(1.0);
        let part_rad = through_rad / parts;
        let mut course_rad = from_course_rad + 0.5 * part_rad;
        let mut lost_m = 0.0;
        let mut left = parts;
        while left > 0.5 {
            let Some(speed_mps) = ground_speed_mps(course_rad, self.horizontal_mps(), wind_mps)
            else {
                return f64::INFINITY;
            };
            let across_mps = wind_mps.y * cos(course_rad) - wind_mps.x * sin(course_rad);
            let crab = across_mps / self.horizontal_mps();
            let across_mps2 = speed_mps * speed_mps / (radius_m * sqrt(1.0 - crab * crab));
            let load = across_mps2 / GRAVITY_MPS2;
            let sink_mps = self.sink_mps * (1.0 + 0.5 * load * load);
            lost_m += sink_mps * fabs(part_rad) * radius_m / speed_mps;
            course_rad += part_rad;
            left -= 1.0;
        }
        lost_m
    }

    fn horizontal_mps(&self) -> f64 {
        let squared = self.true_airspeed_mps * self.true_airspeed_mps;
        sqrt((squared - self.sink_mps * self.sink_mps).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;

    const KT: f64 = 1_852.0 / 3_600.0;
    const FT: f64 = 0.304_8;

    fn handbook() -> Glide {
        // 1.5 nautical miles for 1,000 ft.
        Glide::with_ratio(65.0 * KT, 1.5 * 1_852.0 / (1_000.0 * FT))
    }

    /// The handbook's figure 3-1 at 3,000 ft of height: 4.5 nautical miles.
    #[test]
    fn the_handbook_s_distance_is_reached() {
        let lost_ft = handbook().straight_m(1.0, 4.5 * 1_852.0, Vector2::zeros()) / FT;
        assert!((lost_ft - 3_000.0).abs() < 1.0, "{lost_ft}");
    }

    /// The wind triangle of 64.6 kt along the horizon and 20 kt from behind, ahead and
    /// across: 84.6, 44.6 and √(64.6² - 20²) = 61.4 kt over the ground.
    #[test]
    fn wind_changes_the_way_and_not_the_time() {
        let glide = handbook();
        let horizontal_kt = (65.0_f64.powi(2) - (65.0_f64 / 9.169).powi(2)).sqrt();
        for (course_rad, speed_kt) in [
            (0.0, horizontal_kt + 20.0),
            (PI, horizontal_kt - 20.0),
            (FRAC_PI_2, (horizontal_kt.powi(2) - 400.0).sqrt()),
        ] {
            let wind = Vector2::new(20.0 * KT, 0.0);
            let lost_m = glide.straight_m(course_rad, 1_852.0, wind);
            // 65 kt through 9.114 to 1 sink 7.09 kt.
            let expected_m = 1_852.0 / speed_kt * (65.0 / 9.169);
            assert!((lost_m - expected_m).abs() < 0.2, "{course_rad}: {lost_m}");
        }
        let storm = Vector2::new(-70.0 * KT, 0.0);
        assert_eq!(glide.straight_m(0.0, 1.0, storm), f64::INFINITY);
        assert_eq!(glide.arc_m(0.0, 1.0, 400.0, storm), f64::INFINITY);
    }

    /// A full turn with 30° of bank, n = 1.1547: R = V²/(g tan 30°), and 1.167 times the sink
    /// rate for 2πR/V.
    #[test]
    fn a_turn_sinks_faster() {
        let glide = handbook();
        let horizontal_mps = 65.0 * KT * 9.114 / 9.169;
        let radius_m = horizontal_mps.powi(2) / (9.806_65 * 30.0_f64.to_radians().tan());
        let time_s = TAU * radius_m / horizontal_mps;
        let expected_m = time_s * 65.0 * KT / 9.169 * (1.0 + 4.0 / 3.0) / 2.0;
        for through in [TAU, -TAU] {
            let lost_m = glide.arc_m(0.7, through, radius_m, Vector2::zeros());
            assert!((lost_m - expected_m).abs() < 0.2, "{lost_m} {expected_m}");
        }
    }
}

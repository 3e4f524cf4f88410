//! Fixes of satellite navigation.

use std::collections::VecDeque;

use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::Reading;

use crate::{Measured, Sample};

impl Measured for GnssFix {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        into.gnss = Reading::new(sample.value, sample.taken);
    }
}

/// Receivers leave out the course of what hardly moves; faster than this they
/// have none for another reason, m/s.
const STANDING_MPS: f64 = 0.5;

/// North and east, m/s, of a speed and its course from true north; a receiver that
/// stands has no course.
pub fn velocity_over_ground(speed_mps: f64, course_deg: Option<f64>) -> Option<[f64; 2]> {
    let Some(course_deg) = course_deg else {
        return (speed_mps < STANDING_MPS).then_some([0.0; 2]);
    };
    let (sin, cos) = libm::sincos(course_deg.to_radians());
    Some([speed_mps * cos, speed_mps * sin])
}

const DAY_S: f64 = 86_400.0;
/// The mean is over this time, s. The quarter is for receivers that are not exactly
/// on time.
const CLIMB_OVER_S: f64 = 1.25;
/// At most 25 a second.
const MOST_ALTITUDES: usize = 32;

/// The vertical speed of a receiver that gives none: the change of its altitude over
/// the last second. There is none with the first altitude, and it is half a second
/// late.
///
/// ```
/// use fcc_device::VerticalSpeed;
///
/// let mut speed = VerticalSpeed::default();
/// assert_eq!(speed.down_mps(10.0, 500.0), None);
/// assert_eq!(speed.down_mps(11.0, 503.0), Some(-3.0));
/// ```
#[derive(Clone, Debug, Default)]
pub struct VerticalSpeed {
    /// With their times, the oldest first.
    altitudes: VecDeque<(f64, f64)>,
}

impl VerticalSpeed {
    /// Takes an altitude, m, at a time, s, which may begin anew at midnight; the
    /// speed down, m/s.
    pub fn down_mps(&mut self, time_s: f64, altitude_m: f64) -> Option<f64> {
        let since = |then: f64| (time_s - then).rem_euclid(DAY_S);
        while let Some((then, _)) = self.altitudes.front()
            && (since(*then) > CLIMB_OVER_S || self.altitudes.len() >= MOST_ALTITUDES)
        {
            self.altitudes.pop_front();
        }
        let first = self.altitudes.front().copied();
        self.altitudes.push_back((time_s, altitude_m));
        let (then, before_m) = first?;
        let passed_s = since(then);
        (passed_s > 0.0).then(|| (before_m - altitude_m) / passed_s)
    }
}

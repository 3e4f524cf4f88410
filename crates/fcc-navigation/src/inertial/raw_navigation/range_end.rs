//! The load beyond the end of an accelerometer's range: many phones end at 2 g.

use libm::fabs;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::RawNavigation;
use super::readings::{force_in, known, rates_of};
use crate::inertial::Solution;
use fcc_core::flight::BodyRates;
use fcc_core::framework::Reading;
use fcc_core::units::GRAVITY_MPS2;

/// A sample is at the end of the range if it is one of so many in a row, ...
const IN_A_ROW: u8 = 3;
/// ... that differ by less than this share: engines shake one that is not, ...
const ALIKE: f64 = 0.004;
/// ... are at least so large, m/s² (no range is smaller than 2 g), ...
const LEAST_MPS2: f64 = 16.0;
/// ... and the aircraft turns by more than this many times as much.
const MORE: f64 = 1.1;

/// Follows the samples along the vertical axis of the body, on which the loads are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RangeEnd {
    last_mps2: f64,
    alike: u8,
}

impl RangeEnd {
    /// The specific force down, m/s²: what is measured, or at the end of the range what
    /// keeps the flight path turning with the body at its pitch rate, rad/s.
    fn restored(&mut self, down_mps2: f64, pitch_radps: f64, solution: &Solution) -> f64 {
        let is_alike = fabs(down_mps2) >= LEAST_MPS2
            && fabs(down_mps2 - self.last_mps2) < ALIKE * fabs(down_mps2);
        self.alike = if is_alike {
            self.alike.saturating_add(1)
        } else {
            0
        };
        self.last_mps2 = down_mps2;
        if self.alike < IN_A_ROW {
            return down_mps2;
        }
        let expected = turning_mps2(pitch_radps, solution);
        if expected / down_mps2 > MORE {
            expected
        } else {
            down_mps2
        }
    }
}

impl RawNavigation {
    /// The specific force that was just read, restored if it is at the end of its range.
    pub(super) fn restored_force(&mut self, rates: &Reading<BodyRates>) -> [f64; 3] {
        let pitch_radps = rates_of(rates, &self.solution).value.pitch_radps;
        let force = &mut self.used.raw_specific_force.value;
        force.z_mps2 = self
            .range_end
            .restored(force.z_mps2, pitch_radps, &self.solution);
        force_in(force)
    }
}

/// The specific force down of a steady turn of the flight path with the body: u q and
/// gravity's part (Stevens and Lewis, equations of motion in body axes, w' = 0, p v = 0).
fn turning_mps2(pitch_radps: f64, solution: &Solution) -> f64 {
    let [w, x, y, z] = solution.quaternion;
    let [wind_north, wind_east] = solution.wind_mps.map(known);
    let [north, east, down] = solution.velocity_mps;
    let attitude = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let air = Vector3::new(north - wind_north, east - wind_east, down);
    let gravity = attitude.inverse_transform_vector(&Vector3::new(0.0, 0.0, GRAVITY_MPS2));
    let forward_mps = attitude.inverse_transform_vector(&air).x;
    -(forward_mps * pitch_radps + gravity.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level, at 50 m/s.
    fn level() -> Solution {
        Solution {
            quaternion: [1.0, 0.0, 0.0, 0.0],
            velocity_mps: [50.0, 0.0, 0.0],
            wind_mps: [0.0, 0.0],
            ..Solution::UNKNOWN
        }
    }

    /// A pull-up with n g turns the path by (n - 1) g/V (FAA-H-8083-3C, chapter 3: 3 g at
    /// 50 m/s: 22.5 °/s).
    #[test]
    fn three_g_are_seen_by_an_accelerometer_of_two() {
        let mut range = RangeEnd::default();
        let pitch_radps = 22.5_f64.to_radians();
        for _ in 0..IN_A_ROW {
            assert_eq!(range.restored(-19.6, pitch_radps, &level()), -19.6);
        }
        let seen = range.restored(-19.55, pitch_radps, &level());
        assert!((seen / -GRAVITY_MPS2 - 3.0).abs() < 0.01, "{seen}");
    }

    #[test]
    fn one_within_its_range_is_believed() {
        let mut range = RangeEnd::default();
        for tick in 0..40 {
            // Shaken by an engine, by 0.3 m/s².
            let down = -19.6 + if tick % 2 == 0 { 0.3 } else { -0.3 };
            assert_eq!(range.restored(down, 0.4, &level()), down);
        }
        // Steady, and what the rates say.
        let pitch_radps = GRAVITY_MPS2 / 50.0;
        for _ in 0..40 {
            assert_eq!(range.restored(-19.6, pitch_radps, &level()), -19.6);
        }
    }

    #[test]
    fn without_an_attitude_it_is_as_measured() {
        let mut range = RangeEnd::default();
        for _ in 0..40 {
            assert_eq!(range.restored(-19.6, 0.4, &Solution::UNKNOWN), -19.6);
        }
    }
}

//! The models of the forces as another flight takes them over.

use super::super::airframe::LearnedAirframe;
use super::{AirspeedFilter, Models};

/// Standard deviations from one flight to another: of the offset, a sensor's warm-up
/// (5 mg); of the thrust ratio and of the lift, weight and density, as shares; of the
/// angle without lift, how the sensors are mounted and warm, rad (0.3°).
const OFFSET_SD: f64 = 0.005;
const THRUST_SHARE: f64 = 0.05;
const LIFT_SHARE: f64 = 0.03;
const ZERO_LIFT_SD_RAD: f64 = 0.005;

/// The models and their standard deviations.
pub(super) fn models(learned: LearnedAirframe) -> (Models, Models) {
    let LearnedAirframe {
        axial_offset,
        full_thrust_ratio,
        zero_lift_angle_rad,
        one_g_angle_rad,
    } = learned;
    (
        [
            axial_offset,
            full_thrust_ratio,
            zero_lift_angle_rad,
            one_g_angle_rad,
        ],
        [
            OFFSET_SD,
            THRUST_SHARE * full_thrust_ratio,
            ZERO_LIFT_SD_RAD,
            LIFT_SHARE * one_g_angle_rad,
        ],
    )
}

impl AirspeedFilter {
    /// What it has learned.
    pub(in super::super) const fn learned(&self) -> LearnedAirframe {
        let [
            _,
            _,
            axial_offset,
            full_thrust_ratio,
            zero_lift_angle_rad,
            one_g_angle_rad,
            _,
        ] = self.x;
        LearnedAirframe {
            axial_offset,
            full_thrust_ratio,
            zero_lift_angle_rad,
            one_g_angle_rad,
        }
    }
}

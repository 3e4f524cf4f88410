//! What several parts of navigation need of attitude and height, computed once a
//! tick.

use libm::sqrt;

use super::attitude::Orientation;
use super::upward::Upward;
use super::vertical::VerticalState;
use fcc_core::flight::atmosphere::density_ratio;

/// Attitude and height, and what follows from them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<'a> {
    pub(super) orientation: &'a Orientation,
    pub(super) upward: Upward,
    pub(super) vertical: VerticalState,
    /// √(density over its value at sea level).
    pub(super) sqrt_density: f64,
}

/// The air's density at the altitude for which it was computed last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Density {
    altitude_m: f64,
    sqrt_ratio: f64,
}

impl Density {
    pub(super) const AT_SEA_LEVEL: Self = Self {
        altitude_m: 0.0,
        sqrt_ratio: 1.0,
    };

    /// That of the last altitude.
    pub(super) const fn last_sqrt_ratio(&self) -> f64 {
        self.sqrt_ratio
    }

    /// √(density over its value at sea level).
    pub(super) fn sqrt_ratio(&mut self, altitude_m: f64) -> f64 {
        if altitude_m != self.altitude_m {
            *self = Self {
                altitude_m,
                sqrt_ratio: sqrt(density_ratio(altitude_m)),
            };
        }
        self.sqrt_ratio
    }
}

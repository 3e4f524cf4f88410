//! The angle between the body and the path, in any attitude.

use libm::{asin, atan2, cos, sin};

use fcc_core::blocks::limit_abs;

/// Where up is in the aircraft's plane of symmetry: (sin θ, cos φ cos θ).
#[derive(Clone, Copy, Debug)]
pub(super) struct Upward {
    /// From the body's -z axis, inverted from its z axis, towards x, rad.
    angle_rad: f64,
    /// How much of it lies in that plane: cos φ in level flight; negative
    /// inverted.
    pub(super) share: f64,
}

impl Upward {
    /// Of wings and nose level.
    pub(super) const LEVEL: Self = Self {
        angle_rad: 0.0,
        share: 1.0,
    };

    pub(super) fn of(roll_rad: f64, pitch_rad: f64) -> Self {
        let along_x = sin(pitch_rad);
        let along_z = cos(pitch_rad) * cos(roll_rad);
        let side = libm::copysign(1.0, along_z);
        Self {
            angle_rad: atan2(side * along_x, side * along_z),
            share: side * libm::hypot(along_x, along_z).max(LEAST_UPWARD),
        }
    }

    /// The angle of attack on a path of this slope (sine), without sideslip:
    /// sin γ = cos α sin θ - sin α cos φ cos θ (Stevens, Lewis and Johnson 2016,
    /// section 3.6), solved for the smaller α.
    pub(super) fn angle_of_attack_rad(self, sin_path: f64) -> f64 {
        self.angle_rad - asin(limit_abs(sin_path / self.share, 1.0))
    }

    /// The slope (sine) of the path with this angle of attack.
    pub(super) fn sin_path(self, angle_of_attack_rad: f64) -> f64 {
        self.share * sin(self.angle_rad - angle_of_attack_rad)
    }
}

/// Near the knife edge the path does not tell the angle of attack.
const LEAST_UPWARD: f64 = 0.3;

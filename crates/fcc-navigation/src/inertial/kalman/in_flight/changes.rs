//! Least squares: the rotation from sums of specific force to changes of velocity.

use nalgebra::linalg::SymmetricEigen;
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};

use super::{RECEIVER_MPS, VELOCITIES};
use crate::inertial::kalman::states::UNKNOWN_ANGLE;

/// How much the attitude that is believed weighs, m²/s²: as little as if nothing were known.
const UNSEEN: f64 = RECEIVER_MPS * RECEIVER_MPS / UNKNOWN_ANGLE;
/// Of the search for eigenvalues: a few are enough, and what is not finite has none.
const MOST_ROUNDS: usize = 100;

/// Velocities and sums of specific force, less their means.
#[derive(Clone, Copy, Debug)]
pub(super) struct Changes {
    pub(super) late_s: f64,
    pub(super) velocities: [Vector3<f64>; VELOCITIES],
    pub(super) sums: [Vector3<f64>; VELOCITIES],
    pub(super) count: usize,
}

impl Changes {
    pub(super) fn centred(mut self) -> Self {
        for all in [&mut self.velocities, &mut self.sums] {
            let all = &mut all[..self.count];
            let mean = all.iter().sum::<Vector3<f64>>() / self.count as f64;
            for one in all {
                *one -= mean;
            }
        }
        self
    }

    fn pairs(&self) -> impl Iterator<Item = (&Vector3<f64>, &Vector3<f64>)> {
        self.velocities.iter().zip(&self.sums).take(self.count)
    }

    /// The rotation of the least squares, where they do not tell the one that was believed.
    pub(super) fn attitude(&self, was: &UnitQuaternion<f64>) -> Option<UnitQuaternion<f64>> {
        let mut both = was.to_rotation_matrix().into_inner() * UNSEEN;
        for (velocity, sum) in self.pairs() {
            both += velocity * sum.transpose();
        }
        rotation(&both)
    }

    /// The mean square of what a rotation leaves, m²/s².
    pub(super) fn left(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        let squares = self
            .pairs()
            .map(|(velocity, sum)| (velocity - rotation * sum).norm_squared());
        squares.sum::<f64>() / self.count as f64
    }

    /// The mean square of the velocities, m²/s².
    pub(super) fn square(&self) -> f64 {
        let squares = self.pairs().map(|(velocity, _)| velocity.norm_squared());
        squares.sum::<f64>() / self.count as f64
    }

    /// The variance of the rotation that leaves so much, rad².
    pub(super) fn variance(
        &self,
        rotation: &UnitQuaternion<f64>,
        left: f64,
    ) -> Option<Vector3<f64>> {
        let mut information = Matrix3::identity() * (2.0 * UNSEEN);
        for (_, sum) in self.pairs() {
            let along = rotation * sum;
            information += Matrix3::identity() * along.norm_squared() - along * along.transpose();
        }
        let square = left.max(RECEIVER_MPS * RECEIVER_MPS);
        Some(information.try_inverse()?.diagonal() * square)
    }
}

/// The rotation R of the largest trace of R Bᵀ.
fn rotation(b: &Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let s = b.transpose();
    let [x, y, z] = [
        s[(1, 2)] - s[(2, 1)],
        s[(2, 0)] - s[(0, 2)],
        s[(0, 1)] - s[(1, 0)],
    ];
    let symmetric = s + b - Matrix3::identity() * s.trace();
    let mut of = Matrix4::zeros();
    of[(0, 0)] = s.trace();
    for (at, part) in [x, y, z].into_iter().enumerate() {
        of[(0, at + 1)] = part;
        of[(at + 1, 0)] = part;
    }
    of.fixed_view_mut::<3, 3>(1, 1).copy_from(&symmetric);
    let found = SymmetricEigen::try_new(of, f64::EPSILON, MOST_ROUNDS)?;
    let q = found.eigenvectors.column(found.eigenvalues.imax());
    let quaternion = Quaternion::new(q[0], q[1], q[2], q[3]);
    UnitQuaternion::try_new(quaternion, 0.5)
}

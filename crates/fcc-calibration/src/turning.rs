//! The calibration of a gyroscope by turns between positions at rest: gravity's
//! direction after a turn is the one before it, turned by the integrated rates.
//!
//! The principle and its nine unknowns, the three scales and how much of each axis
//! belongs to the others, are those of Tedaldi, Pretto and Menegatti, *A robust and
//! easy to implement method for IMU calibration without external equipments*
//! (2014), section IV-B. A turn says nothing of the part of its error about
//! gravity's direction after it: it takes turns about different axes.

use libm::sqrt;
use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

use super::Axes;
use super::fit::{SMALL, STEPS, axes, is_possible};

/// The matrix of scale and misalignment, column by column: what turning about x
/// shows in x, y and z, then what turning about y shows.
pub(super) const UNKNOWNS: usize = 9;
pub(super) type Unknowns = SVector<f64, UNKNOWNS>;
pub(super) type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type Jacobian = SMatrix<f64, 3, UNKNOWNS>;

/// Directions of gravity that differ by more after the best fit, RMS, rad: 10°.
/// That is no noise but other axes.
const LARGEST_RESIDUAL_RAD: f64 = 0.17;

/// A turn between two positions at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn<'a> {
    /// The direction up before it and after it, in the gyroscope's axes, of any
    /// length.
    pub(super) before: [f64; 3],
    pub(super) after: [f64; 3],
    /// The rotation vectors of its short steps, rad: the integrated rates without
    /// bias.
    pub(super) steps: &'a [[f64; 3]],
}

/// What was found.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct TurnFit {
    /// Scale and misalignment.
    pub(super) axes: Axes,
    /// By how much gravity's directions still differ, RMS of each of the two
    /// angles, rad.
    pub(super) residual_rad: f64,
    /// The standard deviation of the worst of the nine.
    pub(super) sigma: f64,
}

impl Turn<'_> {
    /// The direction up after the turn by a gyroscope of this shape, and how it
    /// changes with the shape.
    fn predicted(&self, shape: &Matrix3<f64>) -> (Vector3<f64>, Jacobian) {
        let mut turned = Rotation3::identity();
        // How the attitude after the turn changes, in the axes after it.
        let mut by_shape = Jacobian::zeros();
        for step in self.steps {
            let given = Vector3::from(*step);
            let angle = shape * given;
            let rotation = Rotation3::new(angle);
            turned *= rotation;
            by_shape = rotation.matrix().transpose() * by_shape;
            // The right Jacobian of a short rotation.
            let right = Matrix3::identity() - 0.5 * angle.cross_matrix();
            for (column, part) in (0..).step_by(3).zip(given.iter()) {
                let mut block = by_shape.fixed_columns_mut::<3>(column);
                block += right * *part;
            }
        }
        let up = turned.inverse() * unit(self.before);
        (up, up.cross_matrix() * by_shape)
    }

    /// Its share of the normal equations, their right side, and the square of the
    /// difference of the directions.
    pub(super) fn equations(&self, shape: &Matrix3<f64>) -> (Normal, Unknowns, f64) {
        let (up, by_shape) = self.predicted(shape);
        let difference = unit(self.after) - up;
        let transposed = by_shape.transpose();
        (
            transposed * by_shape,
            transposed * difference,
            difference.norm_squared(),
        )
    }
}

/// The scale and misalignment of a gyroscope after which the directions of
/// gravity agree: least squares, by Gauss and Newton. `None` if the turns do not
/// determine them, or nothing possible agrees with them.
pub(super) fn fit_turns<'a>(turns: &(impl Iterator<Item = Turn<'a>> + Clone)) -> Option<TurnFit> {
    let mut shape = Matrix3::identity();
    let mut inverse = Normal::zeros();
    let (mut squares, mut count) = (0.0, 0.0);
    for _ in 0..STEPS {
        let (mut normal, mut right) = (Normal::zeros(), Unknowns::zeros());
        (squares, count) = (0.0, 0.0);
        for turn in turns.clone() {
            let (one, its_right, square) = turn.equations(&shape);
            normal += one;
            right += its_right;
            squares += square;
            count += 2.0;
        }
        inverse = normal.try_inverse()?;
        let step = inverse * right;
        shape += Matrix3::from_column_slice(step.as_slice());
        if step.norm() < SMALL {
            break;
        }
    }
    let free = count - UNKNOWNS as f64;
    if free <= 0.0 {
        return None;
    }
    let variance = squares / free;
    let fit = TurnFit {
        axes: axes(&Vector3::zeros(), &shape),
        residual_rad: sqrt(squares / count),
        sigma: sqrt(variance * inverse.diagonal().max()),
    };
    (is_possible(&fit.axes) && fit.residual_rad <= LARGEST_RESIDUAL_RAD).then_some(fit)
}

fn unit(vector: [f64; 3]) -> Vector3<f64> {
    Vector3::from(vector).try_normalize(0.0).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::AxesCalibration;

    /// What is true: 2 % of scale and cross axes, which the sensor shows.
    const GIVEN: Matrix3<f64> =
        Matrix3::new(1.02, -0.02, 0.01, 0.02, 0.98, 0.015, -0.01, -0.02, 1.01);
    const ANGLE_SIGMA_RAD: f64 = 0.003;

    /// Of a standard deviation of 1: twelve uniform numbers.
    struct Noise(u64);

    impl Noise {
        fn draw(&mut self) -> f64 {
            let mut uniform = || {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            };
            (0..12).map(|_| uniform()).sum()
        }

        fn vector(&mut self) -> Vector3<f64> {
            Vector3::from_fn(|_, _| self.draw())
        }
    }

    struct Turned {
        before: Vector3<f64>,
        after: Vector3<f64>,
        steps: Vec<[f64; 3]>,
    }

    /// Twelve turns by 3 rad about drawn axes, with noise of the directions.
    fn turned(noise: &mut Noise, sigma_rad: f64) -> Vec<Turned> {
        let mut up = Vector3::z();
        (0..12)
            .map(|_| {
                let axis = noise.vector().normalize();
                let before = up;
                let step = axis * 0.1;
                up = Rotation3::new(axis * -3.0) * up;
                Turned {
                    before: before + sigma_rad * noise.vector(),
                    after: up + sigma_rad * noise.vector(),
                    steps: std::vec![(GIVEN * step).into(); 30],
                }
            })
            .collect()
    }

    fn turns(of: &[Turned]) -> impl Iterator<Item = Turn<'_>> + Clone {
        of.iter().map(|turned| Turn {
            before: turned.before.into(),
            after: turned.after.into(),
            steps: &turned.steps,
        })
    }

    fn shape(fit: &TurnFit) -> Matrix3<f64> {
        Matrix3::from(AxesCalibration::new(&fit.axes).matrix()).transpose()
    }

    #[test]
    fn a_fit_is_exact_without_noise() {
        let turned = turned(&mut Noise(1), 0.0);
        let fit = fit_turns(&turns(&turned)).unwrap();
        assert!((shape(&fit) * GIVEN - Matrix3::identity()).norm() < 1e-9);
        assert!(fit.residual_rad < 1e-9 && fit.sigma < 1e-9);
        // Two angles of four turns are fewer than nine unknowns.
        assert_eq!(fit_turns(&turns(&turned[..4])), None);
        let still: Vec<_> = turned
            .iter()
            .map(|turned| Turned {
                steps: Vec::new(),
                ..*turned
            })
            .collect();
        assert_eq!(fit_turns(&turns(&still)), None);
    }

    /// Over 50 drawn sets of turns the squares of what is left, and of the errors
    /// over their covariance, are within the 95 % bounds of χ² with 50 · (24 - 9) =
    /// 750 and 50 · 9 = 450 degrees of freedom (676 to 828, 393 to 511, by Wilson
    /// and Hilferty 1931). Each angle has the noise of two directions.
    #[test]
    fn what_is_left_and_what_is_wrong_are_as_the_noise() {
        let mut noise = Noise(7);
        let variance = 2.0 * ANGLE_SIGMA_RAD * ANGLE_SIGMA_RAD;
        let (mut left, mut wrong) = (0.0, 0.0);
        for _ in 0..50 {
            let turned = turned(&mut noise, ANGLE_SIGMA_RAD);
            let fit = fit_turns(&turns(&turned)).unwrap();
            left += 24.0 * fit.residual_rad * fit.residual_rad / variance;
            let found = shape(&fit);
            let normal: Normal = turns(&turned).map(|turn| turn.equations(&found).0).sum();
            let error = found - GIVEN.try_inverse().unwrap();
            let error = Unknowns::from_column_slice(error.as_slice());
            wrong += (error.transpose() * normal * error).x / variance;
        }
        assert!((676.0..=828.0).contains(&left), "{left}");
        assert!((393.0..=511.0).contains(&wrong), "{wrong}");
    }
}

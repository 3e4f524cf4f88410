//! The calibration of an accelerometer or a magnetometer from samples in many
//! directions: what it measures has the same strength in all of them.

use libm::sqrt;
use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

use super::{Axes, AxesCalibration};

/// Bias, and the symmetric matrix of scale and misalignment.
pub(super) const UNKNOWNS: usize = 9;
type Unknowns = SVector<f64, UNKNOWNS>;
type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Steps of a fit; from a sphere four are enough for 20 % of scale.
pub(super) const STEPS: usize = 12;
/// A step that changes nothing more ends it, of the strength.
pub(super) const SMALL: f64 = 1e-12;
/// Directions are spread evenly if each axis has a third of their squares; less
/// than this share along one does not determine its scale.
const LEAST_SPREAD: f64 = 0.15;
/// Samples without which nine unknowns are not determined well.
const LEAST_SAMPLES: usize = 12;
/// Scales beyond these, and the like of misalignments, are no sensor's.
const SCALES: core::ops::RangeInclusive<f64> = 0.5..=2.0;
const LARGEST_MISALIGNMENT: f64 = 0.5;
/// Samples that differ by more after the best fit, RMS over the strength, have no
/// strength in common: noise is a few per cent at most.
const LARGEST_RESIDUAL: f64 = 0.1;
/// A sample that differs by more from the strength that the others have, of the
/// strength and of the others' standard deviation, is an outlier.
const OUTLIER_SHARE: f64 = 0.05;
const OUTLIER_SIGMAS: f64 = 10.0;

/// A calibration found by [`fit_strength`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StrengthFit {
    /// Bias, scale and misalignment; mounting and delay are not known by this.
    pub axes: Axes,
    /// By how much the strength of the calibrated samples differs from the true
    /// one, RMS, in the sensor's unit.
    pub residual: f64,
    /// The standard deviation of each bias, in the sensor's unit.
    pub bias_sigma: [f64; 3],
    /// The least share of the directions along any axis; a third if they are
    /// spread evenly.
    pub spread: f64,
}

/// Why there is no calibration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum FitError {
    /// Fewer samples than this.
    TooFew(usize),
    /// Samples that are not finite.
    NotFinite,
    /// The strength of the samples, and the one that they should have: what another
    /// unit gives.
    OtherUnit(f64, f64),
    /// The number of a sample, from 0, that contradicts all others, and by how much
    /// its strength differs from theirs.
    Outlier(usize, f64),
    /// The directions leave one axis out: its share, and the least that is
    /// enough.
    NotSpread(f64, f64),
    /// There is no bias and no scale by which these samples have one strength.
    NoFit,
}

impl core::fmt::Display for FitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFew(least) => write!(f, "too few samples: take at least {least}"),
            Self::NotFinite => f.write_str("a sample is not finite"),
            Self::OtherUnit(given, wanted) => write!(
                f,
                "the samples have a strength of about {given:.3}, and {wanted} was given as \
                 strength: give both in one unit, such as m/s² (not g) or µT (not gauss or nT)"
            ),
            Self::Outlier(at, by) => write!(
                f,
                "sample {at}, counted from 0, contradicts the others by {by:.3}: leave it out, or \
                 take it again"
            ),
            Self::NotSpread(share, least) => write!(
                f,
                "the directions are not spread: {share:.2} of them are along one axis, {least} are \
                 needed; turn each of its sides up, and stand it on its edges"
            ),
            Self::NoFit => f.write_str(
                "there is no bias and no scale by which the samples have one strength: the sensor \
                 was moved while it was sampled, or something nearby disturbed it",
            ),
        }
    }
}

impl core::error::Error for FitError {}

/// Finds bias, scale and misalignment by which all samples have one `strength`:
/// gravity's of an accelerometer at rest, the field's of a magnetometer.
///
/// Least squares by Gauss and Newton, from the sphere that fits best. Strengths
/// tell nothing of a rotation, so the matrix of scale and misalignment is taken
/// to be symmetric: the sensor's axes are the closest right-angled ones (as in
/// Tedaldi, Pretto and Menegatti 2014 for the accelerometer, whose x axis is
/// kept instead).
///
/// ```
/// use fcc_calibration::{AxesCalibration, fit_strength};
///
/// // Gravity along each axis and between them, read with a bias of 0.3 m/s²
/// // along x, by a sensor whose z axis shows 2 % too much.
/// let mut samples = Vec::new();
/// for x in [-1.0_f64, 0.0, 1.0] {
///     for y in [-1.0_f64, 0.0, 1.0] {
///         for z in [-1.0_f64, 0.0, 1.0] {
///             let length = (x * x + y * y + z * z).sqrt();
///             if length > 0.0 {
///                 let g = 9.806_65 / length;
///                 samples.push([x * g + 0.3, y * g, z * g * 1.02]);
///             }
///         }
///     }
/// }
/// let fit = fit_strength(&samples, 9.806_65)?;
/// assert!((fit.axes.bias[0] - 0.3).abs() < 1e-9);
/// assert!((fit.axes.scale[2] - 1.0 / 1.02).abs() < 1e-9);
/// let [_, _, down] = AxesCalibration::new(&fit.axes).applied([0.3, 0.0, 9.806_65 * 1.02]);
/// assert!((down - 9.806_65).abs() < 1e-9);
/// # Ok::<(), fcc_calibration::FitError>(())
/// ```
///
/// # Errors
/// When there are too few samples, they are not finite or not spread over the
/// directions, are of another unit than the strength, one of them contradicts the
/// others, or they have no strength in common.
pub fn fit_strength(samples: &[[f64; 3]], strength: f64) -> Result<StrengthFit, FitError> {
    if samples.len() < LEAST_SAMPLES {
        return Err(FitError::TooFew(LEAST_SAMPLES));
    }
    if samples.iter().flatten().any(|part| !part.is_finite()) {
        return Err(FitError::NotFinite);
    }
    let all = Samples {
        all: samples,
        without: None,
    };
    let outlier = outlier(all, strength);
    outlier.map_or_else(|| fit(all, strength), Err)
}

/// Samples, all of them or all but one.
#[derive(Clone, Copy)]
struct Samples<'a> {
    all: &'a [[f64; 3]],
    without: Option<usize>,
}

impl<'a> Samples<'a> {
    fn each(self) -> impl Iterator<Item = (usize, Vector3<f64>)> + 'a {
        let numbered = self.all.iter().enumerate();
        numbered
            .filter(move |(at, _)| Some(*at) != self.without)
            .map(|(at, sample)| (at, Vector3::from(*sample)))
    }

    fn vectors(self) -> impl Iterator<Item = Vector3<f64>> + 'a {
        self.each().map(|(_, sample)| sample)
    }

    fn count(self) -> f64 {
        (self.all.len() - usize::from(self.without.is_some())) as f64
    }

    /// The number of the sample of which this is largest.
    fn most(self, of: impl Fn(Vector3<f64>) -> f64) -> Option<usize> {
        let each = self.each().map(|(at, sample)| (at, of(sample)));
        let most = each.max_by(|(_, a), (_, b)| a.total_cmp(b));
        most.map(|(at, _)| at)
    }
}

/// The sample without which the others fit, and which contradicts them: the one
/// farthest from the middle of all, or from the sphere through them.
fn outlier(all: Samples<'_>, strength: f64) -> Option<FitError> {
    let (centre, radius) = sphere(all.vectors())?;
    let sum: Vector3<f64> = all.each().map(|(_, sample)| sample).sum();
    let middle = sum / all.count();
    let farthest = [
        all.most(|sample| (sample - middle).norm()),
        all.most(|sample| ((sample - centre).norm() - radius).abs()),
    ];
    farthest.into_iter().flatten().find_map(|at| {
        let others = Samples {
            without: Some(at),
            ..all
        };
        let fit = fit(others, strength).ok()?;
        let calibrated = AxesCalibration::new(&fit.axes).applied(*all.all.get(at)?);
        let by = (Vector3::from(calibrated).norm() - strength).abs();
        let free = (others.count() - UNKNOWNS as f64).max(1.0);
        let sigma = fit.residual * sqrt(others.count() / free);
        let is_outlier = by > OUTLIER_SHARE * strength && by > OUTLIER_SIGMAS * sigma;
        is_outlier.then_some(FitError::Outlier(at, by))
    })
}

fn fit(samples: Samples<'_>, strength: f64) -> Result<StrengthFit, FitError> {
    let (centre, radius) = sphere(samples.vectors()).ok_or(FitError::NoFit)?;
    let spread = spread(samples, centre);
    if spread < LEAST_SPREAD {
        return Err(FitError::NotSpread(spread, LEAST_SPREAD));
    }
    if !SCALES.contains(&(strength / radius)) {
        return Err(FitError::OtherUnit(radius, strength));
    }
    let mut bias = centre;
    let mut shape = Matrix3::identity() * (strength / radius);
    let mut inverse = Normal::zeros();
    let mut squares = 0.0;
    for _ in 0..STEPS {
        let (normal, gradient, sum) = equations(samples, strength, &bias, &shape);
        squares = sum;
        inverse = normal.try_inverse().ok_or(FitError::NoFit)?;
        let step: Unknowns = inverse * gradient;
        bias -= step.fixed_rows::<3>(0);
        shape -= symmetric(&step);
        if step.norm() < SMALL * strength {
            break;
        }
    }
    let count = samples.count();
    let free = (count - UNKNOWNS as f64).max(1.0);
    let variances = inverse.diagonal() * (squares / free);
    let sigmas = variances.fixed_rows::<3>(0).map(|of| sqrt(of.max(0.0)));
    let fit = StrengthFit {
        axes: axes(&bias, &shape),
        // Of the squares of strengths over two strengths.
        residual: sqrt(squares / count),
        bias_sigma: sigmas.into(),
        spread,
    };
    if is_possible(&fit.axes) && fit.residual <= LARGEST_RESIDUAL * strength {
        Ok(fit)
    } else {
        Err(FitError::NoFit)
    }
}

/// The sphere through the samples, by linear least squares.
pub(super) fn sphere(samples: impl Iterator<Item = Vector3<f64>>) -> Option<(Vector3<f64>, f64)> {
    let mut normal = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    for sample in samples {
        let row = (2.0 * sample).push(1.0);
        normal += row * row.transpose();
        right += row * sample.norm_squared();
    }
    let found = normal.try_inverse()? * right;
    let centre = Vector3::new(found.x, found.y, found.z);
    let radius = sqrt(found.w + centre.norm_squared());
    (radius.is_finite() && radius > 0.0).then_some((centre, radius))
}

/// The least share of the samples' directions along any axis.
fn spread(samples: Samples<'_>, centre: Vector3<f64>) -> f64 {
    let mut squares = Matrix3::zeros();
    for (_, sample) in samples.each() {
        let direction = (sample - centre).try_normalize(0.0).unwrap_or_default();
        squares += direction * direction.transpose();
    }
    SymmetricEigen::new(squares / samples.count())
        .eigenvalues
        .min()
}

/// The normal equations of the differences of strengths, (|S(a - b)|² - g²) /
/// 2g, their gradient, and the sum of their squares.
fn equations(
    samples: Samples<'_>,
    strength: f64,
    bias: &Vector3<f64>,
    shape: &Matrix3<f64>,
) -> (Normal, Unknowns, f64) {
    let (mut normal, mut gradient, mut squares) = (Normal::zeros(), Unknowns::zeros(), 0.0);
    for (_, sample) in samples.each() {
        let free = sample - bias;
        let scaled = shape * free;
        let difference = (scaled.norm_squared() - strength * strength) / (2.0 * strength);
        let by_scaled = scaled / strength;
        let by_bias = -(shape * by_scaled);
        let (s, f) = (by_scaled, free);
        let row = Unknowns::from([
            by_bias.x,
            by_bias.y,
            by_bias.z,
            s.x * f.x,
            s.y * f.y,
            s.z * f.z,
            s.x * f.y + s.y * f.x,
            s.x * f.z + s.z * f.x,
            s.y * f.z + s.z * f.y,
        ]);
        normal += row * row.transpose();
        gradient += row * difference;
        squares += difference * difference;
    }
    (normal, gradient, squares)
}

/// The symmetric matrix in a step.
fn symmetric(step: &Unknowns) -> Matrix3<f64> {
    let [_, _, _, xx, yy, zz, xy, xz, yz] = step.data.0[0];
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// A bias, and the matrix of scale and misalignment.
pub(super) fn axes(bias: &Vector3<f64>, shape: &Matrix3<f64>) -> Axes {
    let [kx, ky, kz] = [shape.m11, shape.m22, shape.m33];
    Axes {
        bias: (*bias).into(),
        scale: [kx, ky, kz],
        misalignment: [
            shape.m12 / ky,
            shape.m13 / kz,
            shape.m21 / kx,
            shape.m23 / kz,
            shape.m31 / kx,
            shape.m32 / ky,
        ],
        ..Axes::default()
    }
}

/// Whether a sensor may be so.
pub(super) fn is_possible(axes: &Axes) -> bool {
    axes.bias.iter().all(|bias| bias.is_finite())
        && axes.scale.iter().all(|scale| SCALES.contains(scale))
        && axes
            .misalignment
            .iter()
            .all(|part| part.abs() <= LARGEST_MISALIGNMENT)
        && Axes::MULTIPLIES.contains(&axes.multiplies().0)
}

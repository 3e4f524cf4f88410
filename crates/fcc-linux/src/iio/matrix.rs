//! How a chip is mounted, as the board's description says.

use core::str::FromStr;

/// A mounting matrix: from the chip's axes to those of the board, as the
/// device tree has it.
///
/// ```
/// use fcc_linux::iio::Matrix;
///
/// // The chip's y axis points where the board's x axis does.
/// let turned: Matrix = "0, 1, 0; -1, 0, 0; 0, 0, 1".parse()?;
/// assert_eq!(turned.applied([1.0, 2.0, 3.0]), [2.0, -1.0, 3.0]);
/// # Ok::<(), fcc_linux::iio::MatrixError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Matrix([[f64; 3]; 3]);

/// The text is no mounting matrix: no nine numbers, or no rotation.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("no rotation as a matrix like 1, 0, 0; 0, 1, 0; 0, 0, 1")]
pub struct MatrixError;

impl Matrix {
    /// Chip and board have the same axes.
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// The vector in the board's axes.
    pub fn applied(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.0.map(|[a, b, c]| a * x + b * y + c * z)
    }
}

impl FromStr for Matrix {
    type Err = MatrixError;

    fn from_str(text: &str) -> Result<Self, MatrixError> {
        let rows = three(text.split(';').map(row));
        rows.map(Self).filter(Self::is_rotation).ok_or(MatrixError)
    }
}

/// What entries with three decimals are off at most.
const TOLERANCE: f64 = 0.01;

impl Matrix {
    /// Rows of length 1 that are at right angles, and right-handed: of a mirrored one
    /// an aircraft would roll to the other side.
    fn is_rotation(&self) -> bool {
        let [x, y, z] = self.0;
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = [
            x[1] * y[2] - x[2] * y[1],
            x[2] * y[0] - x[0] * y[2],
            x[0] * y[1] - x[1] * y[0],
        ];
        let is = |value: f64, expected: f64| (value - expected).abs() <= TOLERANCE;
        // With z as their cross product, x and y at right angles are enough.
        is(dot(x, x), 1.0)
            && is(dot(y, y), 1.0)
            && is(dot(x, y), 0.0)
            && is(dot(cross, z), 1.0)
            && is(dot(z, z), 1.0)
    }
}

fn row(text: &str) -> Option<[f64; 3]> {
    three(text.split(',').map(|entry| {
        let entry: f64 = entry.trim().parse().ok()?;
        entry.is_finite().then_some(entry)
    }))
}

/// Three, no more and no less.
fn three<T>(mut all: impl Iterator<Item = Option<T>>) -> Option<[T; 3]> {
    let three = [all.next()??, all.next()??, all.next()??];
    all.next().is_none().then_some(three)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_matrix_is_refused() {
        for text in [
            "",
            "1, 0, 0",
            "1,0;0,1",
            "1,0,0;0,1,0;0,0,x",
            "1,0,0;0,1,0;0,0,1;0,0,0",
            "1,0,0;0,1,0;0,0,inf",
            // Mirrored, of another length, and not at right angles.
            "1,0,0;0,1,0;0,0,-1",
            "0,0,0;0,0,0;0,0,0",
            "1,0,0;0,2,0;0,0,0.5",
            "1,0,0;0.5,0.866,0;0,0,1",
        ] {
            assert_eq!(text.parse::<Matrix>(), Err(MatrixError), "{text:?}");
        }
        assert_eq!("1, 0, 0; 0, 1, 0; 0, 0, 1\n".parse(), Ok(Matrix::IDENTITY));
    }
}

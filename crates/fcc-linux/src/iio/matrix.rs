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

/// The text is no mounting matrix.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("no mounting matrix like 1, 0, 0; 0, 1, 0; 0, 0, 1")]
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
        rows.map(Self).ok_or(MatrixError)
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
        ] {
            assert_eq!(text.parse::<Matrix>(), Err(MatrixError), "{text:?}");
        }
        assert_eq!("1, 0, 0; 0, 1, 0; 0, 0, 1\n".parse(), Ok(Matrix::IDENTITY));
    }
}

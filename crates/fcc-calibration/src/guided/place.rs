//! The eighteen directions in which a sensor is placed: its six faces, and the
//! twelve edges between them.

use core::fmt;

use super::unit;

/// One of the eighteen directions of a sensor's axes: along an axis, or between
/// two. Its name says which: `+x`, `-y+z`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Place([i8; 3]);

/// A direction belongs to a place if it is at most 25° from it: half of the 45°
/// between a face and an edge, and a bias of 40 mg.
const WITHIN_COSINE: f64 = 0.906;

impl Place {
    /// The faces, then the edges of x and y, of y and z, and of z and x.
    pub const ALL: [Self; 18] = [
        Self([1, 0, 0]),
        Self([-1, 0, 0]),
        Self([0, 1, 0]),
        Self([0, -1, 0]),
        Self([0, 0, 1]),
        Self([0, 0, -1]),
        Self([1, 1, 0]),
        Self([-1, 1, 0]),
        Self([-1, -1, 0]),
        Self([1, -1, 0]),
        Self([0, 1, 1]),
        Self([0, -1, 1]),
        Self([0, -1, -1]),
        Self([0, 1, -1]),
        Self([1, 0, 1]),
        Self([1, 0, -1]),
        Self([-1, 0, -1]),
        Self([-1, 0, 1]),
    ];

    /// The unit vector in the sensor's axes.
    pub fn direction(self) -> [f64; 3] {
        unit(self.0.map(f64::from))
    }

    /// The closest place to a direction.
    pub(super) fn closest(direction: [f64; 3]) -> Self {
        let [first, ..] = Self::ALL;
        Self::ALL.into_iter().fold(first, |best, other| {
            if other.cosine(direction) > best.cosine(direction) {
                other
            } else {
                best
            }
        })
    }

    /// The place that a direction belongs to, if it does to one.
    pub(super) fn of(direction: [f64; 3]) -> Option<Self> {
        let closest = Self::closest(direction);
        (closest.cosine(direction) >= WITHIN_COSINE).then_some(closest)
    }

    fn cosine(self, direction: [f64; 3]) -> f64 {
        let parts = self.direction().into_iter().zip(unit(direction));
        parts.map(|(one, other)| one * other).sum()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (part, axis) in self.0.iter().zip(["x", "y", "z"]) {
            match part {
                1 => write!(f, "+{axis}")?,
                -1 => write!(f, "-{axis}")?,
                _ => {}
            }
        }
        Ok(())
    }
}

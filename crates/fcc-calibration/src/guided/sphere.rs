//! The sphere of directions in cells of equal area, and samples spread over it.

use libm::{atan2, floor};
use nalgebra::Vector3;

use super::{difference, norm, unit};
use crate::fit;

/// Cells of each band, from the +z axis to the -z axis. Bands whose heights are
/// as their numbers of cells have cells of equal area (Archimedes).
pub const CELLS_OF_BANDS: [usize; 5] = [3, 9, 12, 9, 3];
/// Cells of the sphere.
pub const CELLS: usize = 36;
/// Samples that are kept at most: more do not fit at this distance.
const MOST_SAMPLES: usize = 256;
/// The least distance of two samples, of the strength.
const LEAST_DISTANCE: f64 = 0.2;
/// A first sphere of another size, of the strength, is not one yet.
const SIZES: core::ops::RangeInclusive<f64> = 0.5..=2.0;

/// The cell of a direction.
pub(super) fn cell_of(direction: [f64; 3]) -> usize {
    let [x, y, z] = unit(direction);
    // From the +z axis, as a number of cells.
    let depth = 0.5 * (1.0 - z) * CELLS as f64;
    let around = 0.5 + atan2(y, x) / core::f64::consts::TAU;
    let mut before = 0;
    for count in CELLS_OF_BANDS {
        if depth < (before + count) as f64 || before + count == CELLS {
            let column = floor(around * count as f64) as usize;
            return before + column.min(count - 1);
        }
        before += count;
    }
    CELLS - 1
}

/// The direction of the middle of a cell.
pub(super) fn middle_of(cell: usize) -> [f64; 3] {
    let mut before = 0;
    for count in CELLS_OF_BANDS {
        if cell < before + count {
            let depth = (before as f64 + 0.5 * count as f64) / CELLS as f64;
            let z = 1.0 - 2.0 * depth;
            let across = libm::sqrt(1.0 - z * z);
            let around = ((cell - before) as f64 + 0.5) / count as f64 - 0.5;
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * around);
            return [across * cos, across * sin, z];
        }
        before += count;
    }
    [0.0, 0.0, -1.0]
}

/// A sample, and where down was meanwhile.
pub(super) type Sample = ([f64; 3], Option<[f64; 3]>);

/// Samples that are spread over a sphere by their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpreadSamples {
    samples: [[f64; 3]; MOST_SAMPLES],
    downs: [Option<[f64; 3]>; MOST_SAMPLES],
    count: usize,
    strength: f64,
    sphere: Option<([f64; 3], f64)>,
    covered: [bool; CELLS],
}

impl SpreadSamples {
    /// For samples of about this strength.
    pub(super) const fn new(strength: f64) -> Self {
        Self {
            samples: [[0.0; 3]; MOST_SAMPLES],
            downs: [None; MOST_SAMPLES],
            count: 0,
            strength,
            sphere: None,
            covered: [false; CELLS],
        }
    }

    /// Keeps a sample that is apart from all others.
    pub(super) fn take(&mut self, (sample, down): Sample) {
        let least = LEAST_DISTANCE * self.strength;
        let is_apart = |kept: &[f64; 3]| norm(difference(*kept, sample)) >= least;
        if !self.samples().iter().all(is_apart) {
            return;
        }
        let place = (self.samples.iter_mut().zip(&mut self.downs)).nth(self.count);
        let Some((kept, kept_down)) = place else {
            return;
        };
        (*kept, *kept_down) = (sample, down);
        self.count += 1;
        self.cover();
    }

    /// The kept samples.
    pub(super) fn samples(&self) -> &[[f64; 3]] {
        self.samples.get(..self.count).unwrap_or_default()
    }

    /// The kept samples of which down is known.
    pub(super) fn pairs(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> + Clone {
        let pairs = self.samples().iter().zip(&self.downs);
        pairs.filter_map(|(sample, down)| Some(((*down)?, *sample)))
    }

    /// The cells with a sample, as seen from the middle of the sphere.
    pub(super) const fn covered(&self) -> &[bool; CELLS] {
        &self.covered
    }

    /// The middle and the radius of the sphere.
    pub(super) const fn sphere(&self) -> Option<([f64; 3], f64)> {
        self.sphere
    }

    fn cover(&mut self) {
        self.sphere = fit::sphere(self.samples().iter().map(|sample| Vector3::from(*sample)))
            .map(|(centre, radius)| (centre.into(), radius))
            .filter(|(_, radius)| SIZES.contains(&(radius / self.strength)));
        self.covered = [false; CELLS];
        let Some((centre, _)) = self.sphere else {
            return;
        };
        let mut covered = [false; CELLS];
        for sample in self.samples() {
            let cell = cell_of(difference(*sample, centre));
            if let Some(cell) = covered.get_mut(cell) {
                *cell = true;
            }
        }
        self.covered = covered;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area of a zone of the unit sphere is 2π times its height
    /// (Archimedes, *On the Sphere and Cylinder*); every cell has 4π/36.
    #[test]
    fn cells_have_equal_areas() {
        let mut counts = [0_u32; CELLS];
        let points = 200_000_u32;
        let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        for n in 0..points {
            let z = 1.0 - (2.0 * f64::from(n) + 1.0) / f64::from(points);
            let (sin, cos) = (golden * f64::from(n)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            counts[cell_of([across * cos, across * sin, z])] += 1;
        }
        let expected = f64::from(points) / CELLS as f64;
        for (cell, count) in counts.into_iter().enumerate() {
            assert!((f64::from(count) / expected - 1.0).abs() < 0.01, "{cell}");
        }
        assert_eq!(CELLS_OF_BANDS.iter().sum::<usize>(), CELLS);
    }

    #[test]
    fn the_middle_of_a_cell_is_in_it() {
        for cell in 0..CELLS {
            assert_eq!(cell_of(middle_of(cell)), cell);
        }
        assert_eq!(cell_of([0.0, 0.0, -1.0]) / 33, 1, "the last band");
    }

    #[test]
    fn samples_are_kept_apart() {
        let mut samples = SpreadSamples::new(50.0);
        for n in 0..100 {
            samples.take(([50.0, 0.1 * f64::from(n), 0.0], None));
        }
        // 0, 10 µT, ...
        assert_eq!(samples.samples().len(), 1);
        samples.take(([50.0, 10.1, 0.0], None));
        assert_eq!(samples.samples().len(), 2);
    }
}

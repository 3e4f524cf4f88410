//! Where the posts of a tile are, and a grid of the posts of several tiles.

use std::ops::Range;

use fcc_core::flight::terrain;

use crate::area::Area;
use crate::error::TerrainError;

/// How far the posts of one tile may be from those of another to be the same ones, in
/// posts.
const SAME_POST: f64 = 0.01;
/// The lowest and the highest height that is one, m: Dead Sea and Mount Everest, and room.
const LOWEST_M: f32 = -1_000.0;
const HIGHEST_M: f32 = 10_000.0;

/// The posts of a tile.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Lattice {
    pub(crate) north_deg: f64,
    pub(crate) west_deg: f64,
    pub(crate) posts_per_degree: [f64; 2],
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Lattice {
    /// By how much its longitudes are shifted into the area, if it touches it.
    pub(crate) fn shift_deg(&self, area: &Area) -> Option<f64> {
        let [per_latitude, per_longitude] = self.posts_per_degree;
        let south_deg = self.north_deg - (self.rows as f64 - 1.0) / per_latitude;
        let east_deg = self.west_deg + (self.columns as f64 - 1.0) / per_longitude;
        area.shift_deg(south_deg, self.north_deg, self.west_deg, east_deg)
    }
}

/// Heights of an area.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Grid {
    pub(crate) lattice: Lattice,
    pub(crate) heights_m: Vec<f32>,
}

/// The posts of a tile that are posts of a grid.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Overlap {
    pub(crate) rows: Range<usize>,
    pub(crate) columns: Range<usize>,
    /// The grid's row and column of the tile's first.
    offset: [i64; 2],
}

impl Grid {
    /// The posts of a tile's lattice that an area has, and one more to every side.
    pub(crate) fn lattice(tile: &Lattice, shift_deg: f64, area: &Area) -> Lattice {
        let [per_latitude, per_longitude] = tile.posts_per_degree;
        let west_deg = tile.west_deg + shift_deg;
        let above = ((area.north_deg - tile.north_deg) * per_latitude).ceil();
        let before = ((west_deg - area.west_deg) * per_longitude).ceil();
        let north_deg = tile.north_deg + above / per_latitude;
        let west_deg = west_deg - before / per_longitude;
        Lattice {
            north_deg,
            west_deg,
            posts_per_degree: tile.posts_per_degree,
            rows: ((north_deg - area.south_deg) * per_latitude) as usize + 2,
            columns: ((area.east_deg - west_deg) * per_longitude) as usize + 2,
        }
    }

    /// Nothing of it known yet.
    pub(crate) fn unknown(lattice: Lattice) -> Self {
        Self {
            lattice,
            heights_m: vec![f32::NAN; lattice.rows * lattice.columns],
        }
    }

    /// Which posts of a tile are posts of this grid; none if theirs lie between these.
    pub(crate) fn overlap(&self, tile: &Lattice, shift_deg: f64) -> Option<Overlap> {
        let offsets = [
            (self.lattice.north_deg - tile.north_deg) * tile.posts_per_degree[0],
            (tile.west_deg + shift_deg - self.lattice.west_deg) * tile.posts_per_degree[1],
        ];
        let is_same =
            |a: f64, b: f64, posts: usize| (a / b - 1.0).abs() * (posts as f64) < SAME_POST;
        let [own, other] = [self.lattice.posts_per_degree, tile.posts_per_degree];
        if !is_same(own[0], other[0], self.lattice.rows + tile.rows)
            || !is_same(own[1], other[1], self.lattice.columns + tile.columns)
            || offsets.iter().any(|at| (at - at.round()).abs() > SAME_POST)
        {
            return None;
        }
        let offset = offsets.map(|at| at.round() as i64);
        let range = |offset: i64, tile: usize, grid: usize| {
            let first = (-offset).clamp(0, tile as i64);
            let end = (grid as i64 - offset).clamp(first, tile as i64);
            first as usize..end as usize
        };
        Some(Overlap {
            rows: range(offset[0], tile.rows, self.lattice.rows),
            columns: range(offset[1], tile.columns, self.lattice.columns),
            offset,
        })
    }

    /// Takes the height of a post of a tile, unless it is known already.
    pub(crate) fn put(
        &mut self,
        overlap: &Overlap,
        row: usize,
        column: usize,
        height_m: f32,
    ) -> Result<(), String> {
        if height_m.is_nan() {
            return Ok(());
        }
        if !(LOWEST_M..=HIGHEST_M).contains(&height_m) {
            return Err(format!(
                "row {row}, column {column}: {height_m:.0} is no height in m: are the bytes in \
                 another order, the unit another one, or a void not declared?"
            ));
        }
        let [down, right] = overlap.offset;
        let (row, column) = (row as i64 + down, column as i64 + right);
        let at = usize::try_from(row * self.lattice.columns as i64 + column);
        let known = at.ok().and_then(|at| self.heights_m.get_mut(at));
        if let Some(known) = known.filter(|known| known.is_nan()) {
            *known = height_m;
        }
        Ok(())
    }

    pub(crate) fn borrowed(&self) -> terrain::Grid<'_> {
        Self::view(&self.lattice, &self.heights_m)
    }

    pub(crate) fn leak(self) -> terrain::Grid<'static> {
        Self::view(&self.lattice, self.heights_m.leak())
    }

    fn view<'a>(lattice: &Lattice, heights_m: &'a [f32]) -> terrain::Grid<'a> {
        terrain::Grid {
            north_deg: lattice.north_deg,
            west_deg: lattice.west_deg,
            posts_per_degree: lattice.posts_per_degree,
            columns: lattice.columns,
            heights_m,
        }
    }
}

/// What a grid needs, within what is left of the permitted memory, bytes.
pub(crate) fn bytes(lattice: &Lattice, left: u64, most: u64) -> Result<u64, TerrainError> {
    let posts = (lattice.rows as u64).saturating_mul(lattice.columns as u64);
    let needs = posts.saturating_mul(size_of::<f32>() as u64);
    if needs > left {
        const MB: u64 = 1_000_000;
        return Err(TerrainError::TooLarge {
            needs_mb: (most - left).saturating_add(needs).div_ceil(MB),
            most_mb: most / MB,
        });
    }
    Ok(needs)
}

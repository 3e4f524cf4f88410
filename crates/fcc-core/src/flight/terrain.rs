//! The height of the ground, from elevations that were read before the flight.
//!
//! A [`Terrain`] only looks into memory: it neither waits nor allocates, so a tick may
//! ask it.

use core::ops::RangeInclusive;

use libm::{cos, floor, round};

/// Metres in a degree of latitude where they are fewest, at the equator, and in one of
/// longitude there (WGS-84).
const LATITUDE_DEGREE_M: f64 = 110_574.0;
const LONGITUDE_DEGREE_M: f64 = 111_319.0;
/// Rounding of angles, in posts.
const ROUNDING: f64 = 1e-6;
/// Across a seam between grids, posts of both count up to this distance, in posts: where each
/// ends less than a post before a common side, they are less than two apart.
const SEAM_POSTS: f64 = 2.0;

/// Elevations at the posts of a regular grid of latitudes and longitudes on WGS-84.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Latitude of the first row, degrees; rows follow to the south.
    pub north_deg: f64,
    /// Longitude of the first column, degrees; columns follow to the east.
    pub west_deg: f64,
    /// Rows in a degree of latitude, and columns in one of longitude.
    pub posts_per_degree: [f64; 2],
    /// Posts of a row.
    pub columns: usize,
    /// Row by row, m above mean sea level; not a number where it is not known.
    pub heights_m: &'a [f32],
}

/// A whole number of posts, and the rest of the way to the next one.
fn post(at: f64, posts: usize) -> Option<(usize, f64)> {
    let last = posts.checked_sub(1)? as f64;
    if !(-ROUNDING..=last + ROUNDING).contains(&at) {
        return None;
    }
    let nearest = round(at);
    let is_post = (at - nearest).abs() <= ROUNDING;
    let at = if is_post { nearest } else { at }.clamp(0.0, last);
    let whole = floor(at);
    Some((whole as usize, at - whole))
}

impl Grid<'_> {
    const fn rows(&self) -> usize {
        match self.heights_m.len().checked_div(self.columns) {
            Some(rows) => rows,
            None => 0,
        }
    }

    /// A place in posts from the first row and column, across the date line as well.
    fn place(&self, latitude_deg: f64, longitude_deg: f64) -> (f64, f64) {
        let [per_latitude, per_longitude] = self.posts_per_degree;
        let east_deg = longitude_deg - self.west_deg;
        // A little to the west of the first column is not almost around the earth.
        let east_deg = east_deg - 360.0 * floor((east_deg + ROUNDING) / 360.0);
        (
            (self.north_deg - latitude_deg) * per_latitude,
            east_deg * per_longitude,
        )
    }

    fn height_m(&self, row: usize, column: usize) -> Option<f64> {
        let height_m = *self.heights_m.get(row * self.columns + column)?;
        height_m.is_finite().then_some(f64::from(height_m))
    }

    fn elevation_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        let (row, column) = self.place(latitude_deg, longitude_deg);
        let (row, south) = post(row, self.rows())?;
        let (column, east) = post(column, self.columns)?;
        // A post without weight need not be known.
        let height_m = |rows: usize, columns: usize, weight: f64| {
            if weight == 0.0 {
                return Some(0.0);
            }
            Some(weight * self.height_m(row + rows, column + columns)?)
        };
        Some(
            height_m(0, 0, (1.0 - south) * (1.0 - east))?
                + height_m(0, 1, (1.0 - south) * east)?
                + height_m(1, 0, south * (1.0 - east))?
                + height_m(1, 1, south * east)?,
        )
    }

    /// What is known around a place, without the rest of a cell.
    fn around(&self, latitude_deg: f64, longitude_deg: f64) -> Around {
        let (row, column) = self.place(latitude_deg, longitude_deg);
        let [per_latitude, per_longitude] = self.posts_per_degree;
        let mut around = Around::default();
        let near = |at: f64, posts: usize| {
            let first = (floor(at) - 1.0).max(0.0) as usize;
            (first..posts).take_while(move |post| *post as f64 - at < SEAM_POSTS)
        };
        for row_of_post in near(row, self.rows()) {
            for column_of_post in near(column, self.columns) {
                let Some(height_m) = self.height_m(row_of_post, column_of_post) else {
                    continue;
                };
                let (south, east) = (row_of_post as f64 - row, column_of_post as f64 - column);
                let share = |posts: f64| (1.0 - posts.abs() / SEAM_POSTS).max(0.0);
                let weight = share(south) * share(east);
                around.weight += weight;
                around.height_m += weight * height_m;
                around.south_deg += weight * south / per_latitude;
                around.east_deg += weight * east / per_longitude;
            }
        }
        around
    }

    /// The rows and columns within a distance of a place, and around them.
    fn posts(
        &self,
        latitude_deg: f64,
        longitude_deg: f64,
        reach_m: f64,
    ) -> Option<[RangeInclusive<usize>; 2]> {
        let [per_latitude, per_longitude] = self.posts_per_degree;
        let (row, column) = self.place(latitude_deg, longitude_deg);
        let rows = reach_m / LATITUDE_DEGREE_M * per_latitude;
        let parallel_m = LONGITUDE_DEGREE_M * cos(latitude_deg.to_radians()).max(1e-3);
        let columns = reach_m / parallel_m * per_longitude;
        let (first, _) = post(row - rows, self.rows())?;
        let (last, beyond) = post(row + rows, self.rows())?;
        let (left, _) = post(column - columns, self.columns)?;
        let (right, aside) = post(column + columns, self.columns)?;
        let rows = first..=last + usize::from(beyond > 0.0);
        Some([rows, left..=right + usize::from(aside > 0.0)])
    }

    /// The highest of all posts within a distance, where `unknown` tells the height at the
    /// latitude and longitude of one that is not known.
    fn highest_m(
        &self,
        latitude_deg: f64,
        longitude_deg: f64,
        reach_m: f64,
        unknown: impl Fn(f64, f64) -> Option<f64>,
    ) -> Option<f64> {
        let [rows, columns] = self.posts(latitude_deg, longitude_deg, reach_m)?;
        let [per_latitude, per_longitude] = self.posts_per_degree;
        let mut highest_m = f64::NEG_INFINITY;
        for row in rows {
            for column in columns.clone() {
                let height_m = self.height_m(row, column).or_else(|| {
                    let latitude_deg = self.north_deg - row as f64 / per_latitude;
                    unknown(latitude_deg, self.west_deg + column as f64 / per_longitude)
                });
                highest_m = highest_m.max(height_m?);
            }
        }
        Some(highest_m)
    }
}

/// Known posts around a place, by their weights.
#[derive(Clone, Copy, Default)]
struct Around {
    weight: f64,
    height_m: f64,
    /// Where they are from the place.
    south_deg: f64,
    east_deg: f64,
}

/// A mast or a building: a cylinder from the ground on.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Obstacle {
    /// Of its centre, rad.
    pub latitude_rad: f64,
    /// Of its centre, rad.
    pub longitude_rad: f64,
    /// m, positive.
    pub radius_m: f64,
    /// Of its top above mean sea level, m.
    pub top_m: f64,
}

/// The ground that is known: one grid, or several, the most preferred first.
///
/// ```
/// use fcc_core::flight::terrain::{Grid, Terrain};
///
/// // Four posts, half a degree apart: 100 and 200 m in the north, 300 and 400 m in the
/// // south.
/// let grids = [Grid {
///     north_deg: 47.5,
///     west_deg: 8.0,
///     posts_per_degree: [2.0, 2.0],
///     columns: 2,
///     heights_m: &[100.0, 200.0, 300.0, 400.0],
/// }];
/// let terrain = Terrain { grids: &grids };
/// let elevation_m = |latitude: f64, longitude: f64| {
///     terrain.elevation_m(latitude.to_radians(), longitude.to_radians())
/// };
/// assert!((elevation_m(47.25, 8.25).unwrap() - 250.0).abs() < 1e-6);
/// assert_eq!(elevation_m(46.9, 8.25), None);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Terrain<'a> {
    /// Its grids.
    pub grids: &'a [Grid<'a>],
}

/// The same elevations, not equal ones: they are compared in ticks.
impl PartialEq for Terrain<'_> {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.grids, other.grids) || self.is_empty() && other.is_empty()
    }
}

impl Terrain<'_> {
    /// Whether nothing is known.
    pub const fn is_empty(&self) -> bool {
        self.grids.is_empty()
    }

    /// The elevation of a place, at a latitude and a longitude in rad, m above mean sea
    /// level: bilinear between four posts; in the gap between two grids, of less than two
    /// posts, by the posts of both. None where they are not known.
    pub fn elevation_m(&self, latitude_rad: f64, longitude_rad: f64) -> Option<f64> {
        self.at_m(latitude_rad.to_degrees(), longitude_rad.to_degrees())
    }

    fn at_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        let mut grids = self.grids.iter();
        grids
            .find_map(|grid| grid.elevation_m(latitude_deg, longitude_deg))
            .or_else(|| self.between_m(latitude_deg, longitude_deg))
    }

    /// The elevation of a place between two grids.
    fn between_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        let (mut all, mut is_between) = (Around::default(), false);
        for grid in self.grids {
            let one = grid.around(latitude_deg, longitude_deg);
            // On the other side of the place.
            is_between |= all.south_deg * one.south_deg + all.east_deg * one.east_deg < 0.0;
            all.weight += one.weight;
            all.height_m += one.height_m;
            all.south_deg += one.south_deg;
            all.east_deg += one.east_deg;
        }
        is_between.then(|| all.height_m / all.weight)
    }

    /// The highest elevation within a distance to the north, south, east and west of a
    /// place, m above mean sea level: that of the highest of all posts around. None where
    /// one of them is not known.
    pub fn highest_m(&self, latitude_rad: f64, longitude_rad: f64, reach_m: f64) -> Option<f64> {
        let (latitude_deg, longitude_deg) = (latitude_rad.to_degrees(), longitude_rad.to_degrees());
        let highest_m = |unknown: &dyn Fn(f64, f64) -> Option<f64>| {
            let grids = self.grids.iter();
            grids
                .filter_map(|grid| grid.highest_m(latitude_deg, longitude_deg, reach_m, unknown))
                .reduce(f64::max)
        };
        let known_m = highest_m(&|_, _| None);
        if known_m.is_some() || self.grids.len() < 2 {
            return known_m;
        }
        // Across a seam the posts of each grid, and of the others where it has none.
        highest_m(&|latitude_deg, longitude_deg| self.at_m(latitude_deg, longitude_deg))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VOID: f32 = f32::NAN;
    /// 3 rows of 4, a third of a degree apart.
    const HEIGHTS: [f32; 12] = [
        10.0, 20.0, 30.0, 40.0, //
        50.0, 60.0, 70.0, 80.0, //
        90.0, 95.0, 99.0, VOID,
    ];

    fn with<T>(west_deg: f64, of: impl FnOnce(&dyn Fn(f64, f64) -> Option<f64>) -> T) -> T {
        let grids = [Grid {
            north_deg: 1.0,
            west_deg,
            posts_per_degree: [3.0, 3.0],
            columns: 4,
            heights_m: &HEIGHTS,
        }];
        let terrain = Terrain { grids: &grids };
        of(&|latitude, longitude| {
            terrain.elevation_m(f64::to_radians(latitude), f64::to_radians(longitude))
        })
    }

    fn near(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|m| (m - expected).abs() < 1e-6)
    }

    #[test]
    fn posts_have_their_heights_and_between_them_it_is_bilinear() {
        with(8.0, |at| {
            assert!(near(at(1.0, 8.0), 10.0));
            assert!(near(at(1.0, 9.0), 40.0));
            assert!(near(at(1.0 - 1.0 / 3.0, 8.0 + 2.0 / 3.0), 70.0));
            // A quarter of the way south and half of that east.
            assert!(near(at(1.0 - 0.25 / 3.0, 8.0 + 0.5 / 3.0), 25.0));
        });
    }

    #[test]
    fn a_void_is_unknown_and_so_is_all_that_it_touches() {
        with(8.0, |at| {
            let south = 1.0 - 2.0 / 3.0;
            assert_eq!(at(south, 9.0), None);
            assert_eq!(at(south + 0.1, 8.9), None);
            // On the line between two others it has no weight.
            assert!(near(at(south, 8.0 + 2.0 / 3.0), 99.0));
            assert_eq!(at(1.01, 8.5), None);
            assert_eq!(at(0.9, 7.99), None);
        });
    }

    #[test]
    fn it_goes_on_across_the_date_line() {
        with(179.5, |at| {
            assert!(near(at(1.0, 179.5), 10.0));
            assert!(near(at(1.0, -180.0), 25.0));
            assert!(near(at(1.0, -179.5), 40.0));
        });
    }

    /// At the equator a third of a degree is 36,858 m to the north.
    #[test]
    fn the_highest_post_around_is_found_and_a_void_makes_it_unknown() {
        let grids = [Grid {
            north_deg: 1.0,
            west_deg: 8.0,
            posts_per_degree: [3.0, 3.0],
            columns: 4,
            heights_m: &HEIGHTS,
        }];
        let terrain = Terrain { grids: &grids };
        let highest = |latitude: f64, longitude: f64, reach_m| {
            terrain.highest_m(latitude.to_radians(), longitude.to_radians(), reach_m)
        };
        // In a cell: its four posts.
        assert_eq!(highest(0.9, 8.1, 100.0), Some(60.0));
        // Reaching 3 km to the south, over the next row of posts.
        assert_eq!(highest(0.68, 8.1, 3_000.0), Some(95.0));
        assert_eq!(highest(0.5, 8.9, 100.0), None);
        assert_eq!(highest(0.9, 8.0, 100.0), None);
    }
}

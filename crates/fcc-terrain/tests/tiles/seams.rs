//! Tiles next to each other whose posts are not those of one lattice.

use std::path::Path;

use fcc_terrain::{Area, Elevations};

use crate::made::{MOST_BYTES, Made, at};

/// Posts of a tile: its north-west corner, how far apart they are, and how many.
struct Posts {
    north_deg: f64,
    west_deg: f64,
    south_east_deg: [f64; 2],
    rows: u32,
    columns: u32,
}

/// A plane of heights: 2 % to the north-east or so. Bilinear interpolation and weights that
/// add up keep it.
fn plane_m(latitude: f64, longitude: f64, middle: [f64; 2]) -> f64 {
    800.0 + 2_000.0 * (latitude - middle[0]) + 1_000.0 * (longitude - middle[1])
}

fn write(folder: &Path, name: &str, posts: &Posts, middle: [f64; 2]) {
    let [south_deg, east_deg] = posts.south_east_deg;
    let made = Made {
        tie: vec![0.0, 0.0, 0.0, posts.west_deg, posts.north_deg, 0.0],
        scale: vec![east_deg, south_deg, 0.0],
        size: (posts.columns, posts.rows),
        ..Made::default()
    };
    let mut heights = Vec::new();
    for row in 0..posts.rows {
        let latitude = posts.north_deg - f64::from(row) * south_deg;
        for column in 0..posts.columns {
            let longitude = posts.west_deg + f64::from(column) * east_deg;
            heights.push(plane_m(latitude, longitude, middle) as f32);
        }
    }
    std::fs::write(folder.join(name), made.f32(&heights)).unwrap();
}

fn read(folder: &Path, [latitude, longitude]: [f64; 2], reach_deg: f64) -> Elevations {
    let aside_deg = reach_deg / latitude.to_radians().cos();
    let area = Area {
        south_deg: latitude - reach_deg,
        north_deg: latitude + reach_deg,
        west_deg: longitude - aside_deg,
        east_deg: longitude + aside_deg,
    };
    Elevations::read(folder, &area, MOST_BYTES).unwrap()
}

/// Copernicus DEM, Product Handbook 3.0, table 5: posts of GLO-30 are 1\u{2033} apart in latitude,
/// and in longitude so many times as far poleward of these latitudes. Each tile has the row at
/// its north, and none at its south.
#[test]
fn over_every_seam_of_copernicus_in_both_hemispheres_the_ground_is_known() {
    let widths = [
        (50.0, 1.0, 1.5),
        (60.0, 1.5, 2.0),
        (70.0, 2.0, 3.0),
        (80.0, 3.0, 5.0),
        (85.0, 5.0, 10.0),
    ];
    for resolution in [1.0 / 3_600.0, 1.0 / 1_200.0] {
        for (latitude, equatorward, poleward) in widths {
            for side in [1.0, -1.0] {
                let seam = side * latitude;
                let [north, south] = if side > 0.0 {
                    [poleward, equatorward]
                } else {
                    [equatorward, poleward]
                };
                let middle = [seam, 8.5];
                let folder = tempfile::tempdir().unwrap();
                for (name, width, north_deg) in [
                    ("north.tif", north, seam + 30.0 * resolution),
                    ("south.tif", south, seam),
                ] {
                    let posts = Posts {
                        north_deg,
                        west_deg: 8.5 - 30.0 * resolution * width,
                        south_east_deg: [resolution, resolution * width],
                        rows: 30,
                        columns: 60,
                    };
                    write(folder.path(), name, &posts, middle);
                }
                let known = read(folder.path(), middle, 20.0 * resolution);
                for step in -40..=40 {
                    let latitude = seam + f64::from(step) * 0.25 * resolution;
                    for longitude in [8.5, 8.5 + 0.3 * resolution, 8.5 - 7.7 * resolution] {
                        let expected = plane_m(latitude, longitude, middle);
                        let found = at(&known, latitude, longitude);
                        assert!(
                            found.is_some_and(|m| (m - expected).abs() < 0.01),
                            "{latitude} {longitude}: {found:?}, {expected}"
                        );
                        // The highest post within 60 m: 2 % and the posts around it.
                        let highest = known.with(|terrain| {
                            terrain.highest_m(latitude.to_radians(), longitude.to_radians(), 60.0)
                        });
                        let is_near = |m: f64| (0.0..25.0).contains(&(m - expected));
                        assert!(
                            highest.is_some_and(is_near),
                            "{latitude}: {highest:?}, {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Two tiles that were each warped: other widths, and last columns 1.6 posts apart.
#[test]
fn over_the_seam_of_two_warped_tiles_the_ground_is_known() {
    let middle = [47.0, 8.5];
    let folder = tempfile::tempdir().unwrap();
    let widths = [1.0 / 1_200.0, 1.0 / 1_187.0];
    let tile = |west_deg: f64, width: f64| Posts {
        north_deg: 47.02 + 0.37 * width,
        west_deg,
        south_east_deg: [width, width],
        rows: 50,
        columns: 40,
    };
    write(
        folder.path(),
        "west.tif",
        &tile(8.5 - 39.8 * widths[0], widths[0]),
        middle,
    );
    write(
        folder.path(),
        "east.tif",
        &tile(8.5 + 0.8 * widths[1], widths[1]),
        middle,
    );
    let known = read(folder.path(), middle, 0.015);
    for step in -20..=20 {
        let longitude = 8.5 + f64::from(step) * 0.2 * widths[0];
        for latitude in [47.0, 47.000_31, 46.991] {
            let expected = plane_m(latitude, longitude, middle);
            let found = at(&known, latitude, longitude);
            // Half a post, 0.4 m, where the weights of both sides do not add up.
            assert!(
                found.is_some_and(|m| (m - expected).abs() < 0.5),
                "{latitude} {longitude}: {found:?}, {expected}"
            );
        }
    }
}

/// What neither of two tiles over each other knows is not known: their posts are on the same
/// side of it.
#[test]
fn the_end_of_two_tiles_over_each_other_is_no_seam() {
    let middle = [47.0, 8.5];
    let folder = tempfile::tempdir().unwrap();
    for (name, width) in [("coarse.tif", 1.0 / 1_200.0), ("fine.tif", 1.0 / 3_600.0)] {
        let posts = Posts {
            north_deg: 47.0,
            west_deg: 8.45,
            south_east_deg: [width, width],
            rows: (0.03 / width) as u32,
            columns: (0.1 / width) as u32,
        };
        write(folder.path(), name, &posts, middle);
    }
    let known = read(folder.path(), middle, 0.02);
    assert!(at(&known, 47.0, 8.5).is_some());
    assert_eq!(at(&known, 47.0 + 0.5 / 3_600.0, 8.5), None);
    assert_eq!(at(&known, 47.0 + 0.5 / 1_200.0, 8.5003), None);
}

//! SRTM's tiles. Their layout is that of USGS' "SRTM Collection User Guide" (2015): rows
//! from the north, the posts at the degrees are in both tiles.

use fcc_terrain::{Area, Elevations};
use proptest::prelude::*;

use crate::made::{MOST_BYTES, at, hgt, near, read};

#[test]
fn posts_are_where_the_name_says() {
    // 3" of arc: 1,200 posts a degree.
    let tile = hgt(|row, column| match (row, column) {
        (0, 0) => 1_000,
        (1_200, 0) => 2_000,
        (1_200, 1_200) => 2_500,
        (600, 300) => -12,
        (700, 700) => -32_768,
        _ => 300,
    });
    let elevations = read("N46E008.hgt", &tile).unwrap();
    assert!(near(at(&elevations, 47.0, 8.0), 1_000.0));
    assert!(near(at(&elevations, 46.5, 8.25), -12.0));
    // Half of the way to posts of 300 m.
    assert!(near(at(&elevations, 46.5, 8.25 + 0.5 / 1_200.0), 144.0));
    // The south is not in the area, and what is to the north has no tile.
    assert_eq!(at(&elevations, 46.0, 8.0), None);
    assert_eq!(at(&elevations, 47.1, 8.5), None);
    assert_eq!(elevations.tiles(), ["N46E008.hgt"]);
}

#[test]
fn a_void_is_unknown_and_not_sea_level() {
    let tile = hgt(|row, column| {
        if (500..510).contains(&row) && column < 10 {
            -32_768
        } else {
            0
        }
    });
    let elevations = read("N46E008.hgt", &tile).unwrap();
    let latitude = |row: f64| 47.0 - row / 1_200.0;
    assert_eq!(at(&elevations, latitude(505.0), 8.001), None);
    assert_eq!(at(&elevations, latitude(499.5), 8.001), None);
    assert!(near(at(&elevations, latitude(498.5), 8.001), 0.0));
}

/// 1 second of arc: 3,601 posts of a side, 25,934,402 bytes.
#[test]
fn a_tile_of_one_second_has_three_times_the_posts() {
    let mut tile = vec![0; 25_934_402];
    let post = 2 * (1_800 * 3_601 + 900);
    tile[post..post + 2].copy_from_slice(&[0x01, 0x02]);
    let elevations = read("N46E008.hgt", &tile).unwrap();
    assert!(near(at(&elevations, 46.5, 8.25), 258.0));
    assert!(near(at(&elevations, 46.5 + 1.0 / 3_600.0, 8.25), 0.0));
}

/// Four tiles around a corner, and those beside them that are not in the area, one of
/// which is broken.
#[test]
fn a_folder_is_one_ground() {
    let folder = tempfile::tempdir().unwrap();
    for (name, height_m) in [
        ("N46E007.hgt", 100),
        ("N46E008.hgt", 200),
        ("N47E007.hgt", 300),
        ("n47e008.hgt", 400),
    ] {
        std::fs::write(folder.path().join(name), hgt(|_, _| height_m)).unwrap();
    }
    std::fs::write(folder.path().join("N10E008.hgt"), "broken").unwrap();
    std::fs::write(folder.path().join("README.txt"), "SRTM").unwrap();
    let area = Area::around([(47.0, 8.0)], 5_000.0).unwrap();
    let elevations = Elevations::read(folder.path(), &area, MOST_BYTES).unwrap();
    assert_eq!(elevations.tiles().len(), 4);
    for (latitude, longitude, expected) in [
        (46.99, 7.99, 100.0),
        (46.99, 8.01, 200.0),
        (47.01, 7.99, 300.0),
        (47.01, 8.01, 400.0),
    ] {
        assert!(near(at(&elevations, latitude, longitude), expected));
    }
    // No gap between them.
    for step in 0..400 {
        let aside = f64::from(step) * 1e-4 - 0.02;
        assert!(
            at(&elevations, 47.0 + aside, 8.0 + aside).is_some(),
            "{aside}"
        );
    }
    // What is needed, and not whole tiles.
    let hash = elevations.hash();
    assert_eq!(hash.len(), 64);
    let again = Elevations::read(folder.path(), &area, 100_000).unwrap();
    assert_eq!(again.hash(), hash);
    let too_large = Elevations::read(folder.path(), &area, 10_000).unwrap_err();
    assert!(
        too_large
            .to_string()
            .contains("1 MB, and 0 MB are permitted")
    );
    let elsewhere = Area::around([(-3.5, -60.5)], 5_000.0).unwrap();
    let missing = Elevations::read(folder.path(), &elsewhere, MOST_BYTES).unwrap_err();
    let text = missing.to_string();
    assert!(
        text.contains("has no tile of this area: add S04W061.hgt"),
        "{text}"
    );
    std::fs::write(folder.path().join("N46E008.hgt"), "short").unwrap();
    let broken = Elevations::read(folder.path(), &area, MOST_BYTES).unwrap_err();
    let text = broken.to_string();
    assert!(
        text.contains("N46E008.hgt: has 5 bytes, and a tile"),
        "{text}"
    );
}

#[test]
fn tiles_on_both_sides_of_the_date_line_are_one_ground() {
    let folder = tempfile::tempdir().unwrap();
    for (name, height_m) in [("N00E179.hgt", 50), ("N00W180.hgt", 70)] {
        std::fs::write(folder.path().join(name), hgt(|_, _| height_m)).unwrap();
    }
    let area = Area::around([(0.5, 179.99), (0.5, -179.99)], 1_000.0).unwrap();
    let elevations = Elevations::read(folder.path(), &area, MOST_BYTES).unwrap();
    assert!(near(at(&elevations, 0.5, 179.99), 50.0));
    assert!(near(at(&elevations, 0.5, -179.99), 70.0));
    assert!(at(&elevations, 0.5, 180.0).is_some());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// A plane stays one: bilinear interpolation is exact on it. The places are more than
    /// 1 km inside the tile: a thousandth of a degree of longitude is 76 m there.
    #[test]
    fn a_plane_is_kept(latitude in 46.52..46.98_f64, longitude in 8.02..8.98_f64, slope in -1..=1_i16) {
        let tile = hgt(|row, column| 1_500 + slope * (row as i16) / 2 * 2 + column as i16 / 2 * 2);
        let elevations = read("N46E008.hgt", &tile).unwrap();
        let (row, column) = ((47.0 - latitude) * 1_200.0, (longitude - 8.0) * 1_200.0);
        let plane = 1_500.0 + f64::from(slope) * row + column;
        // Every second post is one too low.
        prop_assert!((at(&elevations, latitude, longitude).unwrap() - plane).abs() < 2.5);
        let highest = elevations.with(|terrain| {
            terrain.highest_m(latitude.to_radians(), longitude.to_radians(), 1_000.0)
        });
        prop_assert!(highest.unwrap() >= at(&elevations, latitude, longitude).unwrap());
    }

    /// Any name and content: refused, or nothing known, or heights; never a panic.
    #[test]
    fn any_file_is_read_or_refused(name in ".{0,12}", bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        for end in ["", ".hgt", ".tif"] {
            let _ = read(&format!("{name}{end}"), &bytes);
        }
    }
}

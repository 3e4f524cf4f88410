//! GeoTIFF's posts and keys (OGC 19-008r4).

use proptest::prelude::*;
use tiff::encoder::{Compression, DeflateLevel};

use crate::made::{Made, at, heights, matrix, near, read};

const HEIGHTS: fn(u32, u32) -> f32 = |row, column| (10 * row + column) as f32;

#[test]
fn posts_are_at_points_or_in_the_middle_of_pixels() {
    let points = Made::default();
    let elevations = read("a.tif", &points.f32(&heights(HEIGHTS))).unwrap();
    assert!(near(at(&elevations, 47.0, 8.0), 0.0));
    assert!(near(at(&elevations, 46.95, 8.03), 53.0));
    assert!(near(at(&elevations, 46.945, 8.035), 58.5));
    assert_eq!(at(&elevations, 47.005, 8.0), None);
    // The corner of the first pixel is at the tie point: its middle 0.005° to the south
    // and east.
    let mut areas = Made::default();
    areas.keys[1] = [1_025, 0, 1, 1];
    let elevations = read("a.TIFF", &areas.f32(&heights(HEIGHTS))).unwrap();
    assert!(near(at(&elevations, 46.995, 8.005), 0.0));
    assert!(near(at(&elevations, 46.945, 8.035), 53.0));
    // The tie point may be of any pixel.
    let tied = Made {
        tie: vec![3.0, 5.0, 0.0, 8.03, 46.95, 0.0],
        ..Made::default()
    };
    let elevations = read("a.tif", &tied.f32(&heights(HEIGHTS))).unwrap();
    assert!(near(at(&elevations, 46.95, 8.03), 53.0));
}

#[test]
fn types_compressions_and_voids() {
    let whole = |row, column| (10 * row + column) as i16;
    for compression in [
        Compression::Uncompressed,
        Compression::Lzw,
        Compression::Deflate(DeflateLevel::Fast),
        Compression::Packbits,
    ] {
        let made = Made {
            compression,
            nodata: Some("-9999"),
            ..Made::default()
        };
        let void = |row, column| {
            if (row, column) == (5, 3) {
                -9_999
            } else {
                whole(row, column)
            }
        };
        let elevations = read("a.tif", &made.i16(&heights(void))).unwrap();
        assert_eq!(at(&elevations, 46.95, 8.03), None);
        assert!(near(at(&elevations, 46.96, 8.03), 43.0));
    }
    // GDAL writes the void of 32 bits with all of its digits.
    let made = Made {
        nodata: Some("-3.40282346638529e+38 "),
        ..Made::default()
    };
    let void = |row, column| {
        if row == 0 {
            f32::MIN
        } else {
            HEIGHTS(row, column)
        }
    };
    let elevations = read("a.tif", &made.f32(&heights(void))).unwrap();
    assert_eq!(at(&elevations, 47.0, 8.03), None);
    assert!(near(at(&elevations, 46.99, 8.03), 13.0));
    let unsigned = Made::default().u16(&heights(|row, column| whole(row, column) as u16));
    assert!(near(
        at(&read("a.tif", &unsigned).unwrap(), 46.95, 8.03),
        53.0
    ));
}

/// 60 times 10 m; 60 ft are 18.288 m, by GDAL's metadata or by the keys.
#[test]
fn scale_offset_and_units_are_used() {
    let height_m = |change: &dyn Fn(&mut Made)| {
        let mut made = Made::default();
        change(&mut made);
        at(
            &read("a.tif", &made.f32(&heights(|_, _| 60.0))).unwrap(),
            46.95,
            8.03,
        )
    };
    let scale = r#"<Item name="OFFSET" sample="0" role="offset">-5</Item>
                   <Item name="SCALE" sample="0" role="scale">10</Item>"#;
    assert!(near(height_m(&|made| made.metadata = scale), 595.0));
    let feet = r#"<Item name="UNITTYPE" sample="0" role="unittype">ft</Item>"#;
    assert!(near(height_m(&|made| made.metadata = feet), 18.288));
    let key = |made: &mut Made| made.keys.push([4_099, 0, 1, 9_002]);
    assert!(near(height_m(&key), 18.288));
    assert!(near(height_m(&|_| ()), 60.0));
}

/// The same posts, the southernmost first: 10 of them from 46.91° north, at points and in the
/// middle of pixels.
#[test]
fn south_up_is_read() {
    let upside_down = |row, column| HEIGHTS(9 - row, column);
    for (raster, south, west) in [(2, 46.91, 8.0), (1, 46.905, 7.995)] {
        let mut made = Made {
            matrix: matrix([0.01, 0.0, west], [0.0, 0.01, south]),
            ..Made::default()
        };
        made.keys[1][3] = raster;
        let elevations = read("a.tif", &made.f32(&heights(upside_down))).unwrap();
        assert!(near(at(&elevations, 47.0, 8.0), 0.0), "{raster}");
        assert!(near(at(&elevations, 46.95, 8.03), 53.0));
        assert!(near(at(&elevations, 46.91, 8.19), 109.0));
        // As some write it, by a scale.
        made.tie = vec![0.0, 0.0, 0.0, west, south, 0.0];
        made.scale = vec![0.01, -0.01, 0.0];
        let by_scale = Made {
            matrix: Vec::new(),
            ..made.clone()
        };
        let elevations = read("a.tif", &by_scale.f32(&heights(upside_down))).unwrap();
        assert!(near(at(&elevations, 46.95, 8.03), 53.0), "{raster}");
        // The same with a matrix to the south.
        made.matrix = matrix([0.01, 0.0, west], [0.0, -0.01, 93.91 - south]);
        let elevations = read("a.tif", &made.f32(&heights(HEIGHTS))).unwrap();
        assert!(near(at(&elevations, 46.95, 8.03), 53.0), "{raster}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A file with bytes that are others, or cut: read or refused.
    #[test]
    fn a_damaged_file_is_read_or_refused(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let mut bytes = Made::default().f32(&heights(HEIGHTS));
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let height_m = read("a.tif", &bytes).ok().and_then(|read| at(&read, 46.95, 8.03));
        prop_assert!(height_m.is_none_or(|m| (-1_000.0..=10_000.0).contains(&m)));
    }
}

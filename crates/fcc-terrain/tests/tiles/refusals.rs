//! What is refused, and with what words.

use crate::made::{Made, heights, hgt, matrix, read};

fn refused(name: &str, bytes: &[u8]) -> String {
    read(name, bytes).unwrap_err().to_string()
}

fn geotiff(change: impl FnOnce(&mut Made)) -> String {
    let mut made = Made::default();
    change(&mut made);
    refused("a.tif", &made.i16(&heights(|_, _| 100)))
}

#[test]
fn hgt_of_another_size_name_or_byte_order() {
    let tile = hgt(|_, _| 300);
    let short = refused("N46E008.hgt", &tile[..tile.len() - 2]);
    assert_eq!(
        short,
        "N46E008.hgt: has 2884800 bytes, and a tile of 1 or 3 seconds of arc has 25934402 or \
         2884802: fetch it again"
    );
    let named = refused("alps.hgt", &tile);
    assert_eq!(
        named,
        "alps.hgt: is not named by its place: name it as N47E008.hgt"
    );
    assert_eq!(
        refused("N46E008.hgt.zip", &tile),
        "N46E008.hgt.zip: is packed: unpack it"
    );
    // 300 m, the lower byte first: 11,265 m.
    let swapped = hgt(|_, _| 300_i16.swap_bytes());
    let text = refused("N46E008.hgt", &swapped);
    assert!(
        text.contains("row 0, column 0: 11265 is no height in m"),
        "{text}"
    );
}

#[test]
fn geotiff_that_is_not_of_wgs_84_in_degrees_above_mean_sea_level() {
    let key = |n: usize, value: u16| move |made: &mut Made| made.keys[n][3] = value;
    let added = |key: u16, value: u16| move |made: &mut Made| made.keys.push([key, 0, 1, value]);
    for (text, expected) in [
        (
            geotiff(key(0, 1)),
            "is in metres of a map's projection: convert it by gdalwarp",
        ),
        (geotiff(key(0, 3)), "does not say that it is in degrees"),
        (geotiff(key(2, 4_269)), "its datum is EPSG 4269, not WGS-84"),
        (
            geotiff(key(2, 4_979)),
            "its heights are above the ellipsoid",
        ),
        (geotiff(key(1, 7)), "its raster type is 7"),
        (geotiff(added(2_054, 9_101)), "its angles are in unit 9101"),
        (
            geotiff(added(4_096, 5_703)),
            "its heights are above EPSG 5703",
        ),
        (geotiff(added(4_099, 9_036)), "its heights are in unit 9036"),
        (
            geotiff(|made| made.has_keys = false),
            "it is a TIFF, and no GeoTIFF",
        ),
        (
            geotiff(|made| made.tie.clear()),
            "does not say where it is by one tie point",
        ),
        (
            geotiff(|made| made.tie[4] = 5_000_000.0),
            "its corners are not on the earth",
        ),
        (
            geotiff(|made| made.scale[0] = 30.0),
            "its posts are 30° and 0.01° apart",
        ),
        (
            geotiff(|made| made.scale[1] = f64::NAN),
            "its posts are 0.01° and NaN° apart",
        ),
        (
            geotiff(|made| made.nodata = Some("none")),
            "its GDAL_NODATA is no number: none",
        ),
        (
            geotiff(|made| made.metadata = r#"<Item role="scale" sample="0">ten</Item>"#),
            "its scale is no number: ten",
        ),
        (
            geotiff(|made| made.metadata = r#"<Item role="scale" sample="0">0</Item>"#),
            "its scale is 0",
        ),
        // A mask, and that of an overview (TIFF 6.0).
        (
            geotiff(|made| made.second = Some(4)),
            "has voids in a mask: put them into the heights, by gdalwarp -dstnodata",
        ),
        (geotiff(|made| made.second = Some(5)), "has voids in a mask"),
        (
            geotiff(|made| made.matrix = matrix([0.01, 0.001, 8.0], [0.0, -0.01, 47.0])),
            "is rotated: convert it by gdalwarp",
        ),
        (
            geotiff(|made| made.matrix = matrix([-0.01, 0.0, 8.2], [0.0, -0.01, 47.0])),
            "its columns go to the west: convert it by gdalwarp",
        ),
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let void = refused("a.tif", &Made::default().i16(&heights(|_, _| -9_999)));
    assert!(void.contains("-9999 is no height in m"), "{void}");
    let with_overview = Made {
        second: Some(1),
        ..Made::default()
    };
    read("a.tif", &with_overview.i16(&heights(|_, _| 100))).unwrap();
    assert!(refused("a.tif.msk", b"").contains("has voids in a mask"));
    let cut = Made::default().i16(&heights(|_, _| 100));
    let text = refused("a.tif", &cut[..cut.len() / 2]);
    assert!(text.contains("can be read: failed"), "{text}");
    assert!(refused("a.tif", b"II*\0").contains("is no TIFF that can be read"));
}

/// The tag of the compression, 259, is one `SHORT`; codes of GDAL's `GTiff` driver.
#[test]
fn a_compression_that_is_not_read_is_named() {
    let made = Made::default().i16(&heights(|_, _| 100));
    let entry = |code: u16| {
        let [kind, count] = [
            [3_u16, 1].map(u16::to_ne_bytes),
            [0, code].map(u16::to_ne_bytes),
        ];
        [259_u16.to_ne_bytes(), kind[0], kind[1], count[0], count[1]].concat()
    };
    let plain = entry(1);
    let at = made
        .windows(plain.len())
        .position(|bytes| bytes == plain)
        .unwrap();
    for (code, name) in [
        (50_000, "ZSTD"),
        (34_887, "LERC"),
        (50_001, "WebP"),
        (9, "method 9"),
    ] {
        let mut other = made.clone();
        other[at..at + plain.len()].copy_from_slice(&entry(code));
        let text = refused("a.tif", &other);
        let expected = format!(
            "a.tif: is compressed by {name}, which is not read: convert it by gdal_translate -co \
             COMPRESS=DEFLATE"
        );
        assert_eq!(text, expected);
    }
}

//! Elevation tiles, GeoTIFF and SRTM's: any bytes are refused, or give heights that are
//! ones. `.hgt` of their sizes are too large for this; others are refused.
#![no_main]

use std::io::Cursor;

use fcc_terrain::{Area, Elevations};

const AREA: Area = Area {
    south_deg: 46.0,
    north_deg: 47.5,
    west_deg: 7.5,
    east_deg: 9.0,
};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Elevations::of_tile("N46E008.hgt", Cursor::new(bytes), &AREA, 10_000_000);
    let Ok(elevations) = Elevations::of_tile("a.tif", Cursor::new(bytes), &AREA, 10_000_000) else {
        return;
    };
    elevations.with(|terrain| {
        for step in 0..50 {
            let at = f64::from(step) * 0.01;
            let (latitude, longitude) = ((46.8 - at).to_radians(), (8.0 + at).to_radians());
            let height_m = terrain.elevation_m(latitude, longitude);
            assert!(height_m.is_none_or(|m| (-1_000.0..=10_000.0).contains(&m)));
            let highest_m = terrain.highest_m(latitude, longitude, 200.0);
            assert!(highest_m.is_none_or(|m| (-1_000.0..=10_000.0).contains(&m)));
        }
    });
});

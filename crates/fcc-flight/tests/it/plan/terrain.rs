//! Terrain that is made here, as SRTM's tiles of 3 seconds of arc.

use std::fmt::Write as _;
use std::path::Path;

use fcc_flight::config::Config;
use tempfile::TempDir;

/// The four tiles around home, with the height of a place in degrees.
pub(crate) fn tiles(height_m: impl Fn(f64, f64) -> f64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (south, west) in [(46, 7), (46, 8), (47, 7), (47, 8)] {
        let mut bytes = Vec::with_capacity(2 * 1_201 * 1_201);
        for row in 0..1_201 {
            let latitude = f64::from(south) + 1.0 - f64::from(row) / 1_200.0;
            for column in 0..1_201 {
                let longitude = f64::from(west) + f64::from(column) / 1_200.0;
                bytes.extend((height_m(latitude, longitude) as i16).to_be_bytes());
            }
        }
        let name = format!("N{south}E00{west}.hgt");
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// A ridge of 1,000 m from west to east, 5.6 km north of home, over ground of 400 m.
pub(crate) fn ridge(latitude: f64, _: f64) -> f64 {
    if (latitude - 47.05).abs() < 0.002 {
        1_000.0
    } else {
        400.0
    }
}

/// To the north and back, at altitudes in a frame of MAVLink.
fn plan(frame: u8, altitude_m: f64) -> String {
    let mut text = String::from("QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 400 1\n");
    for (n, (latitude, longitude)) in [(47.1, 8.0), (47.1, 8.1)].into_iter().enumerate() {
        let number = n + 1;
        writeln!(
            text,
            "{number} 0 {frame} 16 0 0 0 0 {latitude} {longitude} {altitude_m} 1"
        )
        .unwrap();
    }
    text
}

fn loaded(text: &str, tiles: Option<&Path>) -> Result<Config, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.waypoints");
    std::fs::write(&file, text).unwrap();
    let mut keys = format!("[built-in]\n[guidance]\nmode = \"plan\"\n[plan]\nfile = {file:?}\n");
    if let Some(tiles) = tiles {
        writeln!(keys, "[terrain]\nfolder = {tiles:?}\nmargin_m = 100").unwrap();
    }
    let mut config = Config::parse(&keys, "test").unwrap();
    config.load_plan(5).map_err(|error| error.to_string())?;
    Ok(config)
}

#[test]
fn a_plan_into_a_ridge_is_refused() {
    let tiles = tiles(ridge);
    let over = loaded(&plan(0, 1_100.0), Some(tiles.path())).unwrap();
    assert!(over.plan.route().is_some());
    let into = loaded(&plan(0, 1_050.0), Some(tiles.path())).unwrap_err();
    let expected = "it is at 1050 m over ground of 1000 m";
    assert!(
        into.contains("item 1: terrain: ") && into.contains(expected),
        "{into}"
    );
    assert!(
        into.contains("with 100 m to be kept: fly 50 m higher there"),
        "{into}"
    );
    // Without tiles nothing is known of it.
    assert!(loaded(&plan(0, 1_050.0), None).is_ok());
    // Elsewhere than the tiles are.
    let away = plan(0, 1_100.0).replace("47.1 8.1", "48.5 8.1");
    let away = loaded(&away, Some(tiles.path())).unwrap_err();
    assert!(
        away.contains("along the leg no elevation is known at 47.99"),
        "{away}"
    );
}

/// Altitudes above terrain are those above mean sea level of the content that is flown and
/// recorded, so that a replay needs no tiles for them.
#[test]
fn altitudes_above_terrain_need_tiles() {
    for frame in [10, 11] {
        let without = loaded(&plan(frame, 700.0), None).unwrap_err();
        assert!(
            without.contains("item 1: altitude: is above terrain"),
            "{without}"
        );
        assert!(without.contains("set terrain.folder"), "{without}");
        let tiles = tiles(ridge);
        let config = loaded(&plan(frame, 700.0), Some(tiles.path())).unwrap();
        let same = loaded(&plan(0, 1_100.0), Some(tiles.path())).unwrap();
        assert_eq!(config.plan.identity(), same.plan.identity());
        assert_eq!(config.plan.content, same.plan.content);
    }
}

#[test]
fn tiles_that_are_broken_or_elsewhere_are_named() {
    let tiles = tiles(ridge);
    std::fs::write(tiles.path().join("N47E008.hgt"), [0; 10]).unwrap();
    let broken = loaded(&plan(0, 1_100.0), Some(tiles.path())).unwrap_err();
    assert!(broken.contains("N47E008.hgt: has 10 bytes"), "{broken}");
    let empty = tempfile::tempdir().unwrap();
    let missing = loaded(&plan(0, 1_100.0), Some(empty.path())).unwrap_err();
    assert!(
        missing.contains("has no tile of this area: add N47E008.hgt"),
        "{missing}"
    );
    let nowhere = loaded(&plan(0, 1_100.0), Some(Path::new("/nowhere"))).unwrap_err();
    assert!(
        nowhere.contains("terrain.folder: /nowhere: cannot be read"),
        "{nowhere}"
    );
}

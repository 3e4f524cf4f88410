//! Terrain ahead in flight, over tiles that are made here; the built-in aircraft crashes
//! on the same.

use fcc_conformance::allocator_calls;
use fcc_core::framework::State;
use fcc_fixed_wing::Contingency;
use fcc_guidance::Mode;

use crate::plan::contingency::{fenced, go_to};
use crate::plan::flight::{ALTITUDE_M, Flight, HOME};
use crate::plan::terrain::tiles;

const CLIMBS: &str = "terrain is ahead: climbing";
const PASSED: &str = "the terrain that was ahead is passed";
const TURNS: &str = "terrain is ahead: turning away: returning";
/// From home to the place behind the ridge.
const FAR_M: f64 = 14_000.0;

/// Ground of 400 m, and a ridge from west to east 6.7 km north of home, so high over it.
fn ground_m(latitude: f64, ridge_m: f64) -> f64 {
    let off = (latitude - 47.06) / 0.008;
    400.0 + ridge_m * (-off * off).exp()
}

/// How near a flight came to the ground, m, whether it came to its place behind the ridge,
/// and how much of the allocator it used in its ticks.
struct Over {
    nearest_m: f64,
    arrives: bool,
    allocations: u64,
    flight: Flight,
}

/// From home towards a place behind the ridge, 3,000 ft high.
fn fly(ridge_m: f64, keys: &str, seconds: usize) -> Over {
    let tiles = tiles(|latitude, _| ground_m(latitude, ridge_m));
    let keys = format!(
        "[terrain]\nfolder = {:?}\n[contingency]\n{keys}",
        tiles.path()
    );
    let mut flight = Flight::new(&fenced(&[], 50_000.0), &keys);
    flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
    let to = HOME.ahead(0.0, FAR_M);
    flight.command(go_to(to));
    let (mut nearest_m, mut arrives, mut allocations) = (f64::INFINITY, false, 0);
    for _ in 0..seconds * 40 {
        let (_, calls) = allocator_calls(|| flight.machine.step());
        allocations += calls;
        flight.receive();
        let below_m = ground_m(flight.place().latitude_deg, ridge_m);
        nearest_m = nearest_m.min(flight.truth.get().altitude_m - below_m);
        arrives |= flight.distance_m(to) < 1_000.0;
    }
    Over {
        nearest_m,
        arrives,
        allocations,
        flight,
    }
}

/// A ridge of 1,000 m is 86 m higher than what was commanded: it is climbed over, and the
/// flight goes on as commanded behind it, with 20 kt from behind.
#[test]
fn a_ridge_is_climbed_over() {
    let over = fly(
        600.0,
        "[built-in]\nwind_kt = 20\nwind_from_deg = 180\n",
        300,
    );
    println!("{:.1} m over the ground", over.nearest_m);
    let events = &over.flight.events;
    assert!(
        over.flight.happened(CLIMBS) && over.flight.happened(PASSED),
        "{events:#?}"
    );
    assert!(over.arrives && !over.flight.happened(TURNS), "{events:#?}");
    // The margin, 30 m, less what the climb lags behind.
    assert!((15.0..80.0).contains(&over.nearest_m), "{}", over.nearest_m);
    assert_eq!(over.flight.mode(), Mode::GoTo);
    let contingency = over.flight.record.setpoints.contingency;
    assert_eq!(contingency, Contingency::None);
    let off_m = over.flight.truth.get().altitude_m - ALTITUDE_M;
    assert!(off_m.abs() < 10.0, "{off_m}");
    assert_eq!(over.allocations, 0);
}

/// One of 1,900 m cannot be climbed over within a minute: it is turned away from, and the
/// aircraft returns. Not watched, it is flown into.
#[test]
fn a_wall_is_turned_away_from() {
    let away = fly(
        1_500.0,
        "[built-in]\nwind_kt = 20\nwind_from_deg = 180\n",
        400,
    );
    println!("{:.1} m over the ground", away.nearest_m);
    let events = &away.flight.events;
    assert!(away.flight.happened(TURNS) && !away.arrives, "{events:#?}");
    assert!(away.nearest_m > 30.0, "{}", away.nearest_m);
    assert_eq!(away.flight.mode(), Mode::Return);
    let contingency = away.flight.record.setpoints.contingency;
    assert_eq!(contingency, Contingency::Terrain, "until it is commanded");
    assert_eq!(away.allocations, 0);
    let into = fly(1_500.0, "terrain = \"continue\"\n[built-in]\n", 200);
    // It is held where it hit the ground, which is between posts a little lower or higher.
    assert!((-3.0..3.0).contains(&into.nearest_m), "{}", into.nearest_m);
    assert!(!into.arrives && !into.flight.happened(TURNS));
}

/// A plan that circles at home, and an obstacle of 600 m around a place 6 km north of it.
fn with_mast(top_m: f64) -> String {
    let at = HOME.ahead(0.0, 6_000.0);
    format!(
        r#"{{"fileType": "Plan", "version": 1, "groundStation": "test",
        "mission": {{"version": 2, "plannedHomePosition": [47.0, 8.0, 400], "items": [
            {{"type": "SimpleItem", "command": 17, "frame": 0, "autoContinue": true,
              "params": [0, 0, 1000, 0, 47.0, 8.0, 914.4]}}]}},
        "geoFence": {{"version": 2, "polygons": [], "circles": []}},
        "rallyPoints": {{"version": 2, "points": []}},
        "fccd": {{"version": 1, "obstacles": [
            {{"center": [{}, {}], "radius": 600, "top": {top_m}}}]}}}}"#,
        at.latitude_deg, at.longitude_deg
    )
}

/// The obstacles of a plan are watched without tiles, too.
#[test]
fn obstacles_are_climbed_over_or_turned_away_from() {
    let mast = HOME.ahead(0.0, 6_000.0);
    for (top_m, expected) in [(950.0, CLIMBS), (2_500.0, TURNS)] {
        let mut flight = Flight::new(&with_mast(top_m), "[built-in]\n");
        flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
        flight.command(go_to(HOME.ahead(0.0, FAR_M)));
        let (mut nearest_m, mut lowest_m) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..200 * 40 {
            flight.tick();
            let away_m = flight.distance_m(mast);
            nearest_m = nearest_m.min(away_m);
            if away_m < 600.0 {
                lowest_m = lowest_m.min(flight.truth.get().altitude_m);
            }
        }
        println!("top {top_m} m: {nearest_m:.0} m, {lowest_m:.0} m high");
        assert!(flight.happened(expected), "{:#?}", flight.events);
        assert!(lowest_m > top_m, "{lowest_m}");
        assert_eq!(nearest_m < 600.0, expected == CLIMBS, "{nearest_m}");
    }
}

/// Ridges of any height in moderate gusts and 20 kt from anywhere: of the table in the
/// documentation.
#[test]
#[ignore = "20 flights"]
fn no_ridge_is_flown_into() {
    let (mut over, mut away, mut least_m) = (0, 0, f64::INFINITY);
    for seed in 101..=120 {
        let ridge_m = 400.0 + 80.0 * f64::from(seed - 101);
        let wind_from_deg = seed * 97 % 360;
        let keys = format!(
            "[built-in]\ngusts = \"moderate\"\nseed = {seed}\nwind_kt = 20\n\
             wind_from_deg = {wind_from_deg}\n"
        );
        let flown = fly(ridge_m, &keys, 500);
        let nearest_m = flown.nearest_m;
        println!("{seed}: ridge {ridge_m} m, wind from {wind_from_deg}: {nearest_m:.1} m");
        over += usize::from(flown.arrives);
        away += usize::from(flown.flight.happened(TURNS));
        least_m = least_m.min(nearest_m);
        assert!(nearest_m > 0.0, "{:#?}", flown.flight.events);
    }
    println!("{over} climbed over, {away} turned away, at least {least_m:.1} m over the ground");
}

//! Plans over terrain that is made here: 3 seconds of arc, 500 m high but for what a test
//! puts onto it.

use fcc_core::flight::terrain::{Grid, Terrain};
use fcc_plan::{
    Altitude, AltitudeDatum, Conditions, Home, Item, Loiter, LoiterEnd, Place, Plan, check,
    resolve, terrain_problems,
};
use proptest::prelude::*;

use crate::place;

const KT: f64 = 1_852.0 / 3_600.0;
const PER_DEGREE: f64 = 1_200.0;
const NORTH_DEG: f64 = 60.2;
const WEST_DEG: f64 = 7.8;
const ROWS: usize = 361;
const COLUMNS: usize = 721;
const MARGIN_M: f64 = 60.0;

struct Ground(Vec<f32>);

impl Ground {
    fn flat(height_m: f32) -> Self {
        Self(vec![height_m; ROWS * COLUMNS])
    }

    fn post(at: Place) -> (usize, usize) {
        let row = (NORTH_DEG - at.latitude_deg) * PER_DEGREE;
        let column = (at.longitude_deg - WEST_DEG) * PER_DEGREE;
        (row.round() as usize, column.round() as usize)
    }

    /// The post that is nearest to a place.
    fn with(mut self, at: Place, height_m: f32) -> Self {
        let (row, column) = Self::post(at);
        self.0[row * COLUMNS + column] = height_m;
        self
    }

    fn of<T>(&self, of: impl FnOnce(&Terrain<'_>) -> T) -> T {
        let grids = [Grid {
            north_deg: NORTH_DEG,
            west_deg: WEST_DEG,
            posts_per_degree: [PER_DEGREE; 2],
            columns: COLUMNS,
            heights_m: &self.0,
        }];
        of(&Terrain { grids: &grids })
    }

    fn said(&self, plan: &Plan, wind_kt: f64) -> Vec<String> {
        let problems =
            self.of(|terrain| terrain_problems(plan, &conditions(wind_kt), terrain, MARGIN_M));
        problems.iter().map(ToString::to_string).collect()
    }
}

fn conditions(wind_kt: f64) -> Conditions {
    Conditions {
        airspeed_mps: 100.0 * KT,
        slowest_mps: 78.0 * KT,
        fastest_mps: 120.0 * KT,
        wind_mps: wind_kt * KT,
        bank_rad: 30.0_f64.to_radians(),
        climb_mps: 3.5,
        descent_mps: 5.0,
        loiter_radius_m: 1_000.0,
        final_m: 1_000.0,
        fence_margin_m: None,
    }
}

const fn above(m: f64, above: AltitudeDatum) -> Altitude {
    Altitude { m, above }
}

fn waypoint(latitude_deg: f64, longitude_deg: f64, altitude: Altitude) -> Item {
    Item::Waypoint {
        place: place(latitude_deg, longitude_deg),
        altitude,
        radius_m: None,
    }
}

/// North, and then east, 1,000 m high.
fn plan() -> Plan {
    let level = above(1_000.0, AltitudeDatum::SeaLevel);
    Plan {
        home: Some(Home {
            place: place(60.0, 8.0),
            altitude_m: 1_000.0,
        }),
        items: vec![
            waypoint(60.1, 8.0, level),
            waypoint(60.1, 8.2, level),
            waypoint(60.0, 8.2, level),
        ],
        ..Plan::default()
    }
}

/// 0.05° of latitude are 5,570.6 m there (WGS-84: 111,412 m for a degree at 60°). 990 m
/// and 60 m are 50 m more than 1,000 m.
#[test]
fn a_ridge_across_a_leg_is_found_with_its_place_and_heights() {
    assert_eq!(
        Ground::flat(939.0).said(&plan(), 20.0),
        Vec::<String>::new()
    );
    let mut ridge = Ground::flat(500.0);
    for step in 0..100 {
        ridge = ridge.with(place(60.05, 7.96 + f64::from(step) / PER_DEGREE), 990.0);
    }
    let said = ridge.said(&plan(), 20.0);
    assert_eq!(said.len(), 1, "{said:?}");
    let along_m: f64 = said[0]
        .strip_prefix("item 1: terrain: ")
        .and_then(|rest| rest.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap();
    // The piece from which the row of posts is seen first.
    assert!((along_m - 5_570.6).abs() < 60.0 + 93.0 + 30.0, "{said:?}");
    let heights = "along the leg it is at 1000 m over ground of 990 m";
    assert!(said[0].contains(heights), "{said:?}");
    assert!(said[0].contains("with 60 m to be kept: fly 50 m higher there"));
    let below = Ground::flat(1_840.0).said(&plan(), 20.0);
    let heights = "it is at 1000 m, 840 m below ground of 1840 m";
    assert!(below[0].contains(heights), "{below:?}");
}

#[test]
fn turns_circles_and_jumps_are_parts_of_the_path() {
    // The arc of 841 m around the corner passes it 841 (√2 - 1) = 348 m to the south-east.
    let corner = place(60.1, 8.0);
    let arc = Ground::flat(500.0).with(corner.ahead(135.0, 348.0), 990.0);
    let said = arc.said(&plan(), 20.0);
    assert!(
        said[0].starts_with("item 1: terrain: in the turn behind it"),
        "{said:?}"
    );
    let inside = Ground::flat(500.0).with(corner.ahead(135.0, 1_200.0), 2_000.0);
    assert_eq!(inside.said(&plan(), 20.0), Vec::<String>::new());

    let centre = place(60.05, 8.2);
    let mut circling = plan();
    circling.items.push(Item::Loiter(Loiter {
        place: Some(centre),
        altitude: above(1_000.0, AltitudeDatum::SeaLevel),
        radius_m: Some(2_000.0),
        clockwise: true,
        end: LoiterEnd::Turns(1.0),
        leave_towards_next: false,
    }));
    for course_deg in [0.0, 70.0, 200.0] {
        let beside = Ground::flat(500.0).with(centre.ahead(course_deg, 2_000.0), 990.0);
        let said = beside.said(&circling, 20.0);
        assert!(
            said.iter().any(|line| line.contains("on the circle")),
            "{said:?}"
        );
    }
    // The peak around which it circles. The leg to it is flown along a tangent.
    let peak = Ground::flat(500.0).with(centre, 2_000.0);
    let mut around = circling.clone();
    around.items.remove(1);
    around.items.remove(1);
    assert_eq!(peak.said(&around, 20.0), Vec::<String>::new());

    // Back from the last place to the first item, over the middle.
    let mut again = plan();
    again.items.push(Item::Jump {
        to: 1,
        times: Some(1),
    });
    let (length_m, course_deg, _) = place(60.0, 8.2).to(place(60.1, 8.0));
    let middle = place(60.0, 8.2).ahead(course_deg, 0.5 * length_m);
    let hill = Ground::flat(500.0).with(middle, 990.0);
    let said = hill.said(&again, 20.0);
    assert!(said[0].starts_with("item 4: terrain:"), "{said:?}");
    // After the last item it circles there.
    let end = Ground::flat(500.0).with(place(60.0, 8.2).ahead(100.0, 1_000.0), 990.0);
    let said = end.said(&plan(), 20.0);
    assert!(
        said[0].starts_with("item 3: terrain: on the circle"),
        "{said:?}"
    );
}

/// A take-off from 1,000 m over ground of 1,000 m to 1,200 m within 5.6 km, and a landing.
#[test]
fn near_the_runway_the_margin_grows_with_the_height_over_it() {
    let level = above(1_200.0, AltitudeDatum::SeaLevel);
    let mut circuit = plan();
    circuit.items = vec![
        Item::Takeoff {
            place: Some(place(60.05, 8.0)),
            altitude: level,
            pitch_deg: None,
        },
        waypoint(60.1, 8.0, level),
        waypoint(60.1, 8.2, level),
        waypoint(60.05, 8.2, level),
        Item::Land {
            place: Some(place(60.0, 8.2)),
            altitude: above(1_000.0, AltitudeDatum::SeaLevel),
            abort_altitude_m: None,
        },
    ];
    let flat = Ground::flat(1_000.0);
    assert_eq!(flat.said(&circuit, 20.0), Vec::<String>::new());
    // 1 km behind its begin the path is 36 m high: a hill of 20 m leaves 16 m, of which 2 m
    // are to be kept; one of 50 m is flown into. The same before the landing.
    for (from, item) in [
        (place(60.0, 8.0), "item 1: "),
        (place(60.0, 8.2), "item 5: "),
    ] {
        let low = Ground::flat(1_000.0).with(from.ahead(0.0, 1_000.0), 1_020.0);
        assert_eq!(low.said(&circuit, 20.0), Vec::<String>::new());
        let high = Ground::flat(1_000.0).with(from.ahead(0.0, 1_000.0), 1_050.0);
        let said = high.said(&circuit, 20.0);
        assert!(said.len() == 1 && said[0].starts_with(item), "{said:?}");
    }
}

#[test]
fn what_is_not_known_is_a_problem_and_not_sea_level() {
    let hole = Ground::flat(500.0).with(place(60.05, 8.0), f32::NAN);
    let said = hole.said(&plan(), 20.0);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].contains("along the leg no elevation is known at 60.0"),
        "{said:?}"
    );
    let nothing = terrain_problems(&plan(), &conditions(0.0), &Terrain::default(), MARGIN_M);
    assert_eq!(nothing.len(), 3);
}

/// Heights of a tile with known posts: above it a waypoint, a circle where the plan is, and
/// a change of altitude.
#[test]
fn altitudes_above_terrain_are_resolved() {
    let high = above(100.0, AltitudeDatum::Terrain);
    let mut plan = plan();
    plan.items[0] = waypoint(60.1, 8.0, high);
    plan.items
        .insert(1, Item::ChangeAltitude { altitude: high });
    plan.items[2] = waypoint(60.1, 8.2, high);
    let ground = Ground::flat(500.0)
        .with(place(60.1, 8.0), 620.0)
        .with(place(60.1, 8.2), -3.0);
    let resolved = ground.of(|terrain| resolve(&plan, terrain)).unwrap();
    let altitudes_m: Vec<_> = resolved
        .items
        .iter()
        .map(|item| item.altitude().unwrap())
        .collect();
    let sea_level = |m: f64| above(m, AltitudeDatum::SeaLevel);
    for (found, expected_m) in altitudes_m.iter().zip([720.0, 720.0, 97.0, 1_000.0]) {
        assert_eq!(found.above, AltitudeDatum::SeaLevel);
        assert!((found.m - expected_m).abs() < 1e-6, "{altitudes_m:?}");
    }
    assert_eq!(resolved.items[3].altitude(), Some(sea_level(1_000.0)));
    assert_ne!(resolved.hash(), plan.hash());
    let unknown = resolve(&plan, &Terrain::default()).unwrap_err();
    let text = unknown[0].to_string();
    assert!(
        text.starts_with("item 1: altitude: is above terrain, and no elevation is known at 60.1"),
        "{text}"
    );
    let without = check(&plan, &conditions(0.0)).unwrap_err();
    let text = without[0].to_string();
    assert!(
        text.contains("set terrain.folder in the configuration"),
        "{text}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// No post is missed: a single one that is too high, anywhere along a leg and up to 60 m
    /// beside it, is found; one that is 300 m beside it is not.
    #[test]
    fn a_single_post_is_found(along in 0.05..0.95_f64, aside_m in 0.0..60.0_f64, course_deg in 0.0..360.0_f64) {
        let start = place(60.05, 8.1);
        let end = start.ahead(course_deg, 5_000.0);
        let level = above(1_000.0, AltitudeDatum::SeaLevel);
        let plan = Plan {
            home: Some(Home { place: start, altitude_m: 1_000.0 }),
            items: vec![waypoint(end.latitude_deg, end.longitude_deg, level), Item::Return],
            ..Plan::default()
        };
        let on_leg = start.ahead(course_deg, along * 5_000.0);
        let (row, column) = Ground::post(on_leg.ahead(course_deg + 90.0, aside_m));
        let post = place(NORTH_DEG - row as f64 / PER_DEGREE, WEST_DEG + column as f64 / PER_DEGREE);
        // How far the nearest post is beside the leg.
        let (away_m, bearing_deg, _) = start.to(post);
        let beside_m = (away_m * (bearing_deg - course_deg).to_radians().sin()).abs();
        let said = Ground::flat(500.0).with(post, 990.0).said(&plan, 20.0);
        if beside_m <= 60.0 {
            prop_assert!(!said.is_empty());
        }
        let far = Ground::flat(500.0).with(on_leg.ahead(course_deg + 90.0, 300.0), 990.0);
        prop_assert!(far.said(&plan, 20.0).is_empty());
    }
}

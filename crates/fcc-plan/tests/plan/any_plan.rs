//! Any plan that can be in a file.

use fcc_plan::{
    Altitude, AltitudeDatum, Circle, Fence, Home, Item, Loiter, LoiterEnd, Obstacle, Place, Plan,
    Polygon, RallyPoint, Speed,
};
use proptest::array::uniform7;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

/// Anywhere, the date line and the poles included, but for the place that
/// MAVLink takes for "here".
pub(crate) fn any_place() -> impl Strategy<Value = Place> {
    let latitude = prop_oneof![
        8 => -90.0..=90.0,
        1 => Just(90.0),
        1 => Just(-90.0),
    ];
    let longitude = prop_oneof![
        8 => -180.0..=180.0,
        1 => Just(180.0),
        1 => Just(-180.0),
    ];
    (latitude, longitude)
        .prop_filter("here", |place| *place != (0.0, 0.0))
        .prop_map(|(latitude_deg, longitude_deg)| Place {
            latitude_deg,
            longitude_deg,
        })
}

fn any_altitude() -> impl Strategy<Value = Altitude> {
    let above = prop_oneof![
        Just(AltitudeDatum::SeaLevel),
        Just(AltitudeDatum::Home),
        Just(AltitudeDatum::Terrain),
    ];
    (-1_000.0..=20_000.0, above).prop_map(|(m, above)| Altitude { m, above })
}

fn any_loiter() -> impl Strategy<Value = Loiter> {
    let end = prop_oneof![
        Just(LoiterEnd::Never),
        (1e-3..=1_000.0).prop_map(LoiterEnd::Turns),
        (0.0..=604_800.0).prop_map(LoiterEnd::Seconds),
        Just(LoiterEnd::Altitude),
    ];
    (
        option::of(any_place()),
        any_altitude(),
        option::of(1e-3..=100_000.0),
        any::<bool>(),
        end,
        any::<bool>(),
    )
        .prop_map(
            |(place, altitude, radius_m, clockwise, end, leave)| Loiter {
                place,
                altitude,
                radius_m,
                clockwise,
                end,
                leave_towards_next: leave && end != LoiterEnd::Never,
            },
        )
}

/// `items` is how many the plan has, for jumps.
pub(crate) fn any_item(items: usize) -> impl Strategy<Value = Item> {
    let speed = prop_oneof![
        (1.0..=350.0).prop_map(Speed::AirspeedMps),
        (1.0..=350.0).prop_map(Speed::GroundSpeedMps),
    ];
    prop_oneof![
        4 => (any_place(), any_altitude(), option::of(1e-3..=100_000.0)).prop_map(
            |(place, altitude, radius_m)| Item::Waypoint { place, altitude, radius_m }
        ),
        2 => any_loiter().prop_map(Item::Loiter),
        1 => Just(Item::Return),
        1 => (option::of(any_place()), any_altitude(), option::of(1e-3..=20_000.0)).prop_map(
            |(place, altitude, abort_altitude_m)| Item::Land { place, altitude, abort_altitude_m }
        ),
        1 => (option::of(any_place()), any_altitude(), option::of(2.0..=45.0)).prop_map(
            |(place, altitude, pitch_deg)| Item::Takeoff { place, altitude, pitch_deg }
        ),
        1 => (0.0..=604_800.0).prop_map(|seconds| Item::Delay { seconds }),
        1 => (0.0..=1e6).prop_map(|distance_m| Item::UntilDistance { distance_m }),
        1 => any_altitude().prop_map(|altitude| Item::ChangeAltitude { altitude }),
        1 => (option::of(speed), option::of(0.0..=100.0)).prop_map(
            |(speed, throttle_percent)| Item::ChangeSpeed { speed, throttle_percent }
        ),
        1 => (1..=items, option::of(0..=65_535_u32)).prop_map(
            |(to, times)| Item::Jump { to, times }
        ),
        1 => option::of(any_place()).prop_map(|place| Item::LandStart { place }),
        1 => (
            prop_oneof![Just(201_u16), Just(206), Just(530), Just(1_000), Just(2_000), Just(2_501)],
            uniform7(option::of(-1e9..=1e9)),
        )
            .prop_map(|(command, parameters)| Item::Camera { command, frame: 2, parameters }),
    ]
}

pub(crate) fn any_fence() -> impl Strategy<Value = Fence> {
    // A zone to stay outside of has no group.
    let rule = || {
        (any::<bool>(), 0..=3_u16)
            .prop_map(|(inside, group)| (inside, if inside { group } else { 0 }))
    };
    let polygon =
        (vec(any_place(), 3..8), rule()).prop_map(|(corners, (inclusion, group))| Polygon {
            corners,
            inclusion,
            group,
        });
    let circle = (any_place(), 1e-3..=100_000.0, rule()).prop_map(
        |(centre, radius_m, (inclusion, group))| Circle {
            centre,
            radius_m,
            inclusion,
            group,
        },
    );
    (
        vec(polygon, 0..4),
        vec(circle, 0..4),
        option::of(-1_000.0..=20_000.0),
        option::of(-1_000.0..=20_000.0),
        option::of((any_place(), -1_000.0..=20_000.0)),
    )
        .prop_map(
            |(polygons, circles, floor_m, ceiling_m, return_point)| Fence {
                polygons,
                circles,
                floor_m,
                ceiling_m,
                return_point,
            },
        )
}

pub(crate) fn any_plan() -> impl Strategy<Value = Plan> {
    let height = || -1_000.0..=20_000.0_f64;
    let home = (any_place(), height()).prop_map(|(place, altitude_m)| Home { place, altitude_m });
    let rally =
        (any_place(), height()).prop_map(|(place, altitude_m)| RallyPoint { place, altitude_m });
    let obstacle =
        (any_place(), 1e-3..=100_000.0, height()).prop_map(|(centre, radius_m, top_m)| Obstacle {
            centre,
            radius_m,
            top_m,
        });
    let items = (1_usize..30).prop_flat_map(|items| vec(any_item(items), items));
    (
        option::of(home),
        option::of(1.0..=350.0),
        items,
        any_fence(),
        vec(rally, 0..4),
        vec(obstacle, 0..4),
    )
        .prop_map(|(home, cruise_mps, items, fence, rally, obstacles)| Plan {
            home,
            cruise_mps,
            items,
            fence,
            rally,
            obstacles,
        })
}

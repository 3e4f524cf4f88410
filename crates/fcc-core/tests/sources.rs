//! Which of several sensors a reading is taken from, tick by tick.

use std::time::Duration;

use fcc_core::framework::{Flags, Preference, Reading, Readings, SourceChange, Sources, Time};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Boat {
    depth_m: Reading<f64>,
    speed_mps: Reading<f64>,
    heading_rad: Reading<f64>,
}

fcc_core::readings!(Boat {
    depth_m: "depth",
    speed_mps: "speed",
    heading_rad: "heading"
});

/// Milliseconds on the loop's clock.
const fn at(millis: i64) -> Time {
    Time::from_nanos(millis * 1_000_000)
}

/// A reading that is as deep as it was taken late, so that it tells by itself.
fn taken(millis: i64) -> Reading<f64> {
    Reading::new(millis as f64, at(millis))
}

const FRESH_FOR: [Duration; 3] = [
    Duration::from_millis(100),
    Duration::from_millis(100),
    Duration::from_secs(2),
];

/// The sensor and the time that are chosen at 10 s, of readings that each of
/// three sensors took so many milliseconds before; none never took any.
fn chosen(ages: [Option<i64>; 3]) -> (u8, Time) {
    let own = ages.map(|age| Boat {
        depth_m: age.map_or_else(Reading::default, |age| taken(10_000 - age)),
        ..Boat::default()
    });
    let by = Preference {
        now: at(10_000),
        fresh_for: &FRESH_FOR,
    };
    let mut boat = own[0];
    boat.choose(&own[1], 1, &by);
    boat.choose(&own[2], 2, &by);
    assert_eq!(boat.speed_mps, Reading::default(), "nobody measures it");
    (boat.depth_m.source, boat.depth_m.taken)
}

#[test]
fn the_first_that_is_fresh_is_taken() {
    assert_eq!(chosen([Some(0), Some(0), Some(0)]), (0, at(10_000)));
    assert_eq!(chosen([Some(100), Some(0), Some(0)]), (0, at(9_900)));
    assert_eq!(chosen([Some(101), Some(99), Some(0)]), (1, at(9_901)));
    assert_eq!(chosen([Some(101), Some(101), Some(1_999)]), (2, at(8_001)));
    assert_eq!(chosen([None, None, Some(5)]), (2, at(9_995)));
}

#[test]
fn where_none_is_fresh_the_youngest_is_taken_and_then_the_first() {
    assert_eq!(chosen([Some(500), Some(400), Some(3_000)]), (1, at(9_600)));
    assert_eq!(chosen([Some(400), Some(400), None]), (0, at(9_600)));
    assert_eq!(chosen([Some(500), None, Some(2_001)]), (0, at(9_500)));
    assert_eq!(chosen([None, None, None]), (0, Time::NEVER));
}

#[test]
fn a_reading_of_the_future_is_taken_before_none_only() {
    assert_eq!(chosen([Some(-1), Some(50), None]), (1, at(9_950)));
    assert_eq!(chosen([Some(-1), Some(5_000), None]), (1, at(5_000)));
    assert_eq!(chosen([Some(500), Some(-1), None]), (0, at(9_500)));
    assert_eq!(chosen([Some(-1), None, None]), (0, at(10_001)));
}

#[test]
fn each_reading_is_chosen_for_itself() {
    let mut boat = Boat {
        depth_m: taken(9_990),
        speed_mps: taken(9_000),
        heading_rad: Reading::default(),
    };
    let other = Boat {
        depth_m: taken(10_000),
        speed_mps: taken(10_000),
        heading_rad: taken(10_000),
    };
    let by = Preference {
        now: at(10_000),
        fresh_for: &FRESH_FOR,
    };
    boat.choose(&other, 1, &by);
    let sources = [boat.depth_m, boat.speed_mps, boat.heading_rad].map(|reading| reading.source);
    assert_eq!(sources, [0, 1, 1]);
    assert_eq!(boat.depth_m.value, 9_990.0);
}

fn watched(sources: &mut Sources, from: [Option<u8>; 3]) -> Vec<(u32, u8, u8)> {
    let reading = |source: Option<u8>| {
        source.map_or_else(Reading::default, |source| Reading { source, ..taken(1) })
    };
    let [depth_m, speed_mps, heading_rad] = from.map(reading);
    let boat = Boat {
        depth_m,
        speed_mps,
        heading_rad,
    };
    let mut changes = Vec::new();
    sources.watch(&boat, |SourceChange { readings, from, to }| {
        changes.push((readings.bits(), from, to));
    });
    changes
}

#[test]
fn changes_are_told_once_and_together() {
    let mut sources = Sources::default();
    let (a, b, c) = (Some(0), Some(1), Some(2));
    assert_eq!(watched(&mut sources, [None, a, a]), [], "the first is none");
    assert_eq!(watched(&mut sources, [b, a, a]), [], "the first is none");
    assert_eq!(watched(&mut sources, [b, b, b]), [(0b110, 0, 1)]);
    assert_eq!(watched(&mut sources, [b, b, b]), []);
    assert_eq!(
        watched(&mut sources, [a, c, a]),
        [(0b101, 1, 0), (0b010, 1, 2)]
    );
    assert_eq!(Flags::from_bits(0b101).iter().collect::<Vec<_>>(), [0, 2]);
}

//! The sensor from which each reading is taken, tick by tick.

use std::time::Duration;

use fcc_core::framework::{
    Preference, Preferred, Reading, ReadingSet, Readings, SourceChange, Sources, Time,
};

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

/// A reading whose value is its time, so that it can be identified.
fn taken(millis: i64) -> Reading<f64> {
    Reading::new(millis as f64, at(millis))
}

const fn fresh_for(millis: u64) -> Preferred {
    Preferred {
        fresh_for: Duration::from_millis(millis),
        plausible: ReadingSet::ALL,
    }
}

const SENSORS: [Preferred; 3] = [fresh_for(100), fresh_for(100), fresh_for(2_000)];

const fn at_ten_seconds(sensors: &[Preferred; 3]) -> Preference<'_> {
    Preference {
        now: at(10_000),
        sensors,
        reading: 0,
        of_one_sensor: ReadingSet::NONE,
    }
}

/// The sensor and the time that are chosen at 10 s, of readings that each of
/// three sensors took this many milliseconds before; none if it never took any.
fn chosen(ages: [Option<i64>; 3]) -> (u8, Time) {
    let own = ages.map(|age| Boat {
        depth_m: age.map_or_else(Reading::default, |age| taken(10_000 - age)),
        ..Boat::default()
    });
    let by = at_ten_seconds(&SENSORS);
    let mut boat = own[0];
    boat.choose(&own[1], 1, &by);
    boat.choose(&own[2], 2, &by);
    assert_eq!(boat.speed_mps, Reading::default(), "nobody measures it");
    (boat.depth_m.source, boat.depth_m.taken)
}

#[test]
fn the_first_fresh_reading_is_taken() {
    assert_eq!(chosen([Some(0), Some(0), Some(0)]), (0, at(10_000)));
    assert_eq!(chosen([Some(100), Some(0), Some(0)]), (0, at(9_900)));
    assert_eq!(chosen([Some(101), Some(99), Some(0)]), (1, at(9_901)));
    assert_eq!(chosen([Some(101), Some(101), Some(1_999)]), (2, at(8_001)));
    assert_eq!(chosen([None, None, Some(5)]), (2, at(9_995)));
}

#[test]
fn a_reading_of_one_sensor_is_the_first_ones_that_has_ever_delivered_it() {
    let by = Preference {
        of_one_sensor: ReadingSet::one(0),
        ..at_ten_seconds(&SENSORS)
    };
    let mut boat = Boat::default();
    let mut choose = |reading, sensor| {
        let own = Boat {
            depth_m: reading,
            speed_mps: reading,
            heading_rad: reading,
        };
        boat.choose(&own, sensor, &by);
        (boat.depth_m.source, boat.speed_mps.source)
    };
    assert_eq!(choose(Reading::default(), 0), (0, 0));
    // The second has it, old as it is; the third's is fresh.
    assert_eq!(choose(taken(7_000), 1), (1, 1));
    assert_eq!(choose(taken(10_000), 2), (1, 2));
}

#[test]
fn without_a_fresh_reading_the_youngest_is_taken_then_the_first() {
    assert_eq!(chosen([Some(500), Some(400), Some(3_000)]), (1, at(9_600)));
    assert_eq!(chosen([Some(400), Some(400), None]), (0, at(9_600)));
    assert_eq!(chosen([Some(500), None, Some(2_001)]), (0, at(9_500)));
    assert_eq!(chosen([None, None, None]), (0, Time::NEVER));
}

#[test]
fn a_reading_from_the_future_is_preferred_only_to_none() {
    assert_eq!(chosen([Some(-1), Some(50), None]), (1, at(9_950)));
    assert_eq!(chosen([Some(-1), Some(5_000), None]), (1, at(5_000)));
    assert_eq!(chosen([Some(500), Some(-1), None]), (0, at(9_500)));
    assert_eq!(chosen([Some(-1), None, None]), (0, at(10_001)));
}

#[test]
fn each_reading_is_chosen_separately() {
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
    let by = at_ten_seconds(&SENSORS);
    boat.choose(&other, 1, &by);
    let sources = [boat.depth_m, boat.speed_mps, boat.heading_rad].map(|reading| reading.source);
    assert_eq!(sources, [0, 1, 1]);
    assert_eq!(boat.depth_m.value, 9_990.0);
}

#[test]
fn an_implausible_reading_is_taken_only_if_no_fresh_one_is_plausible() {
    let chosen = |ages: [i64; 2], plausible: [u64; 2]| {
        let mut sensors = SENSORS;
        for (sensor, bits) in sensors.iter_mut().zip(plausible) {
            sensor.plausible = ReadingSet::from_bits(bits);
        }
        let [mut boat, other] = ages.map(|age| Boat {
            depth_m: taken(10_000 - age),
            speed_mps: taken(10_000 - age),
            heading_rad: taken(10_000 - age),
        });
        boat.choose(&other, 1, &at_ten_seconds(&sensors));
        [boat.depth_m, boat.speed_mps, boat.heading_rad].map(|reading| reading.source)
    };
    // The second reading of the first sensor is impossible.
    assert_eq!(chosen([0, 0], [0b101, 0b111]), [0, 1, 0]);
    assert_eq!(chosen([0, 0], [0b101, 0b101]), [0, 0, 0], "both");
    assert_eq!(chosen([0, 101], [0b101, 0b111]), [0, 0, 0], "too old");
    assert_eq!(chosen([0, 0], [0b111, 0b000]), [0, 0, 0]);
}

fn watched(sources: &mut Sources, from: [Option<u8>; 3]) -> Vec<(u64, u8, u8)> {
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
fn changes_are_reported_once_and_together() {
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
    assert_eq!(
        ReadingSet::from_bits(0b101).iter().collect::<Vec<_>>(),
        [0, 2]
    );
}

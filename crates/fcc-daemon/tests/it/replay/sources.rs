//! Flights with several sensors: a second one changes nothing while the first
//! is valid, replaces it when it is silent, and a replay reproduces which was
//! used.

use std::ops::RangeInclusive;

use fcc_core::framework::{EventKind, Message, ReadingSet, SourceChange, State};
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{Config, NavigationMethod, RawSensorsChoice};
use fcc_flight::replay::replay;
use fcc_replay::run;
use fcc_telemetry::FlightMessage;

use super::assert_identical;
use super::flights::{Happenings, fly, records, rough};

fn flown(seconded: bool, silent: bool) -> Vec<FlightMessage> {
    flown_with(seconded, silent.then_some(SILENT))
}

/// 0.9 s: less than a switch may be silent.
const SILENT: RangeInclusive<u64> = 1_001..=1_036;

fn flown_with(seconded: bool, silent: Option<RangeInclusive<u64>>) -> Vec<FlightMessage> {
    let happenings = Happenings {
        seconded,
        silent: silent.into_iter().collect(),
        steps: 2_000,
        ..Happenings::default()
    };
    fly(&rough(), &happenings)
}

/// The changes of the sensor, each with its tick.
fn changes(messages: &[FlightMessage]) -> Vec<(u64, SourceChange)> {
    messages
        .iter()
        .filter_map(|message| match message {
            Message::Event(event) => match event.kind {
                EventKind::SourceChanged(change) => Some((event.tick, change)),
                _ => None,
            },
            Message::Tick(_) => None,
        })
        .collect()
}

#[test]
fn a_second_sensor_that_is_not_needed_changes_no_bit() {
    let (one, two) = (flown(false, false), flown(true, false));
    assert_eq!(records(&one), records(&two));
    assert_eq!(changes(&two), []);
}

/// Silent for 0.9 s: with one sensor that is failsafe after 250 ms, with two a
/// change after 100 ms and another when it is back.
#[test]
fn a_loss_that_is_failsafe_with_one_sensor_is_flown_through_with_two() {
    let one = flown(false, true);
    let one = records(&one);
    let mut states = one.iter().map(|record| record.state.state());
    assert!(states.any(|state| matches!(state, State::Failsafe(_))));

    let two = flown(true, true);
    let states = assert_identical(&rough(), &two);
    assert_eq!(states, [State::Standby, State::Engaged]);
    // The first twelve readings but the switch, which is of one sensor, weight on wheels,
    // engine speed and battery.
    let all = ReadingSet::from_bits(0b1011_1111_1111 | 0b111 << 22);
    let (to, back) = ((0, 1), (1, 0));
    let change = |(from, to)| SourceChange {
        readings: all,
        from,
        to,
    };
    assert_eq!(changes(&two), [(1_005, change(to)), (1_037, change(back))]);
    for record in records(&two) {
        let source = u8::from((1_005..=1_036).contains(&record.tick.number));
        assert_eq!(record.measurements.airspeed_mps.source, source);
    }
}

/// Silent for 2 s: nobody can switch off any more, whatever the second's switch says.
#[test]
fn without_the_switch_that_engaged_for_a_second_it_is_failsafe() {
    let messages = flown_with(true, Some(1_001..=1_080));
    assert_identical(&rough(), &messages);
    let records = records(&messages);
    let is_failsafe = |tick: u64| {
        let record = records.iter().find(|record| record.tick.number == tick);
        record.is_some_and(|record| matches!(record.state.state(), State::Failsafe(_)))
    };
    // The last reading is of tick 1,000 or, with the built-in aircraft's delay, of some before.
    assert!(!is_failsafe(1_030));
    assert!(is_failsafe(1_042));
    let moved = changes(&messages);
    let switch = ReadingSet::one(10);
    assert!(
        moved
            .iter()
            .all(|(_, change)| !change.readings.contains(switch))
    );
}

#[test]
fn a_replay_reproduces_which_sensor_was_used() {
    let messages = flown(true, true);
    let mut used = 0;
    run(
        &mut replay(&rough()).unwrap(),
        messages.iter().copied(),
        |recorded, again| {
            assert_eq!(recorded.measurements, again.measurements);
            used += u32::from(again.measurements.attitude.source == 1);
        },
    );
    assert_eq!(used, 32);
}

/// By raw sensors, of which the first set's gyroscope fails: it is named, left with its
/// accelerometer, and no other reading changes its sensor.
#[test]
fn a_replay_reproduces_that_an_inertial_unit_was_left() {
    let mut config = rough();
    config.navigation.method = NavigationMethod::Kalman;
    if let Some(section) = &mut config.built_in {
        section.raw_sensors = RawSensorsChoice::Board;
        section.delay_ms = 0;
    }
    let happenings = Happenings {
        seconded: true,
        biased_from: Some(1_200),
        steps: 2_000,
        ..Happenings::default()
    };
    let messages = fly(&config, &happenings);
    let states = assert_identical(&config, &messages);
    // Doubted by the magnetic field it is a failsafe, until the next one is used.
    assert_eq!(states.last(), Some(&State::Engaged));
    let &[(left_at, change)] = &changes(&messages)[..] else {
        panic!("{:?}", changes(&messages))
    };
    // Raw acceleration and raw body rates.
    assert_eq!(change.readings, ReadingSet::from_bits(0b11 << 14));
    assert_eq!((change.from, change.to), (0, 1));
    assert!((1_200..1_400).contains(&left_at), "{left_at}");
    let events = messages.iter().filter_map(|message| match message {
        Message::Event(event) => Some(event.kind.description::<Autopilot>().to_string()),
        Message::Tick(_) => None,
    });
    let events: Vec<_> = events.collect();
    for text in [
        "inertial unit of sensor 1 is not used again: ",
        "an inertial unit was wrong or silent and is not used again",
    ] {
        let is_told = events.iter().any(|event| event.contains(text));
        assert!(is_told, "{text}: {events:#?}");
    }
}

/// Configured: an X-Plane that never answers is preferred, and all measurements
/// come from the built-in aircraft.
#[test]
fn the_simulator_stands_in_for_a_sensor_that_never_answers() {
    let text = "[built-in]\n[[sensor]]\nkind = \"x-plane\"\nsimulator = \"127.0.0.1:9\"\n";
    let listed = Config::parse(text, "test").unwrap();
    let alone = Config::parse("[built-in]\n", "test").unwrap();
    let happenings = Happenings {
        steps: 1_000,
        ..Happenings::default()
    };
    let (listed, alone) = (fly(&listed, &happenings), fly(&alone, &happenings));
    let (listed, alone) = (records(&listed), records(&alone));
    assert_eq!(listed.len(), 1_000);
    for (listed, alone) in listed.iter().zip(&alone) {
        assert_eq!(listed.outputs, alone.outputs);
        assert_eq!(listed.state, alone.state);
        assert_eq!(listed.measurements.heading_rad.source, 1);
        assert_eq!(alone.measurements.heading_rad.source, 0);
    }
    assert!(listed.iter().any(|record| record.sent));
}

//! A flight that was interrupted, and the aircraft moved since.

use fcc_core::flight::{Plant, Position};

use super::*;

/// A tick at this time of the plant, at this latitude, of these sensors.
fn at(tick: &FlightMessage, second: i64, plant: (f64, u8), latitude: (f64, u8)) -> FlightMessage {
    let Message::Tick(record) = tick else {
        panic!("no tick")
    };
    let now = Time::from_nanos(second * 1_000_000_000);
    let mut measurements = record.measurements;
    let is = Plant {
        time_s: plant.0,
        ..Plant::default()
    };
    measurements.plant = Reading::new(is, now);
    measurements.plant.source = plant.1;
    let is = Position {
        latitude_rad: latitude.0.to_radians(),
        ..Position::default()
    };
    measurements.position = Reading::new(is, now);
    measurements.position.source = latitude.1;
    let tick = Tick {
        woke: now,
        ..record.tick
    };
    Message::Tick(Record {
        tick,
        measurements,
        ..*record
    })
}

/// Sensor 0 of this daemon showed 100 s at 47° before the interruption.
#[test]
fn a_flight_is_not_continued_elsewhere() {
    let folder = Folder::new(RestartMode::Warm);
    let (restart, _) = Restart::begin(folder.request.clone());
    let mut restart = restart.unwrap();
    restart.take(&at(&engaged(&FLOWN), 1, (100.0, 0), (47.0, 0)));
    restart.take(&event(EventKind::Panicked));
    restart.end();
    let saved = state_file::read(&folder.request.path).unwrap().unwrap();

    let standby = Message::Tick(Record::new(Tick::default(), State::Standby));
    // 0.001° are 111 m, and 0.1° are 11 km; the test takes much less than 10 s.
    let cases = [
        ((101.0, 0), [(47.0, 0), (47.001, 0)], "command"),
        ((99.5, 0), [(47.0, 0), (47.0, 0)], "command"),
        ((98.9, 0), [(47.0, 0), (47.0, 0)], "clock was set back"),
        ((3.0, 1), [(47.0, 0), (47.0, 0)], "command"),
        ((101.0, 0), [(47.1, 0), (47.1, 0)], "aircraft was moved"),
        ((101.0, 0), [(47.1, 0), (47.0, 0)], "command"),
        ((101.0, 0), [(47.0, 0), (47.1, 0)], "wait"),
        ((101.0, 0), [(47.1, 1), (47.1, 1)], "command"),
        (
            (101.0, 0),
            [(f64::NAN, 0), (f64::NAN, 0)],
            "aircraft was moved",
        ),
    ];
    for (plant, latitudes, expected) in cases {
        let mut recovery = Recovery::new(saved.clone(), None);
        for (second, latitude) in (1..).zip(latitudes) {
            recovery.take(&at(&standby, second, plant, latitude));
        }
        let is = match recovery.next(BootInstant::now(), Duration::from_secs(60)) {
            Next::Command(_) => "command".to_owned(),
            Next::Wait => "wait".to_owned(),
            Next::NotRecovered(why) | Next::Recovered(why) => why,
        };
        assert!(is.contains(expected), "{is}: {plant:?}, {latitudes:?}");
    }
    // Neither has arrived yet.
    let mut recovery = Recovery::new(saved, None);
    recovery.take(&standby);
    let next = recovery.next(BootInstant::now(), Duration::from_secs(60));
    assert!(matches!(next, Next::Wait));
}

//! A warm-up before each tick changes nothing: not what is measured, not what
//! the simulator receives, not what is counted.

use std::fmt::Write as _;

use crate::support::{FLIGHT_TIME, FakeXPlane, Ticks};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor};
use fcc_xplane::{Output, XPlane};

const TICKS: u32 = 400;

/// Everything that is observable of a flight from outside, tick by tick, as
/// text, which distinguishes every bit of a number.
fn flown(output: Output, warm_up: bool) -> String {
    let mut simulator = FakeXPlane::new();
    let mut config = simulator.config();
    config.output = output;
    let (mut sensor, mut actuator) = XPlane::open(&config).unwrap();
    let status = sensor.status();
    let mut ticks = Ticks::new();
    let mut measurements = Measurements::default();
    let mut seen = String::new();
    for number in 0..TICKS {
        let outputs = Surfaces {
            elevator: (f64::from(number) * 0.01).sin(),
            ..Surfaces::default()
        };
        // Sending, silent, set back, corrupted, overtaken.
        if !(150..200).contains(&number) {
            simulator.live(0.025);
        }
        if number == 250 {
            simulator.values.insert(FLIGHT_TIME.to_owned(), 3.0);
        }
        if number % 50 == 7 {
            simulator.send(b"RREF,cut");
            simulator.send(b"what is this");
        }
        let tick = ticks.next();
        if warm_up {
            sensor.warm_up(&tick);
            actuator.warm_up(&tick, &outputs);
        }
        let sampled = sensor.sample(&tick, &mut measurements);
        let applied = if (20..300).contains(&number) {
            actuator.apply(&tick, &outputs)
        } else {
            actuator.release()
        };
        simulator.listen();
        writeln!(
            seen,
            "{number} {sampled:?} {applied:?} {measurements:?} {:?} {:?} {:?} {} {:?}",
            status.counts(),
            status.state(),
            status.control(),
            simulator.requests,
            simulator.writes,
        )
        .unwrap();
        simulator.writes.clear();
    }
    seen
}

#[test]
fn warm_up_does_not_change_a_flight() {
    for output in [Output::Dref, Output::Data] {
        let without = flown(output, false);
        let with = flown(output, true);
        assert!(without.contains("Held"), "it takes control in between");
        for (without, with) in without.lines().zip(with.lines()) {
            assert_eq!(without, with);
        }
    }
}

//! Readings that are lost or wrong in a take-off, and just before a touch-down.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;

use crate::plan::battery::there_and_back;
use crate::plan::flight::Flight;

/// Of the plan's home, m.
const ELEVATION_M: f64 = 120.0;
/// What a landing gear has to withstand at least, 10 ft/s (14 CFR 23.473).
const GEAR_MPS: f64 = 10.0 * 0.304_8;

/// How a measurement is falsified: by the present one and the last good one.
type Falsify = fn(&mut Measurements, &Measurements);

/// A sensor that is falsified while it is asked for.
struct Falsified {
    sensor: Box<dyn Sensor<Measurements>>,
    good: Measurements,
    is_asked: Arc<AtomicBool>,
    falsify: Falsify,
}

impl Sensor<Measurements> for Falsified {
    fn name(&self) -> &str {
        self.sensor.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        self.sensor.sample(tick, measurements)?;
        if self.is_asked.load(Ordering::Relaxed) {
            (self.falsify)(measurements, &self.good);
        } else {
            self.good = *measurements;
        }
        Ok(())
    }
}

/// A flight with calm air and a retractable gear, and what falsifies it.
fn flight(falsify: Falsify) -> (Flight, Arc<AtomicBool>) {
    let is_asked = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&is_asked);
    let keys = "[autopilot.runway]\nretractable_gear = true\n[built-in]\nnoise = false\n";
    let flight = Flight::with(&there_and_back(), keys, |sensor| {
        Box::new(Falsified {
            sensor,
            good: Measurements::default(),
            is_asked: Arc::clone(&asked),
            falsify,
        })
    });
    (flight, is_asked)
}

fn height_m(flight: &Flight) -> f64 {
    flight.truth.get().altitude_m - ELEVATION_M
}

/// The item of the plan that begins it.
const LANDING_SEQUENCE: u16 = 4;

const LOST: [(&str, Falsify); 4] = [
    ("altitude", |now, good| now.altitude_m = good.altitude_m),
    ("acceleration", |now, good| {
        now.specific_force = good.specific_force;
    }),
    ("airspeed", |now, good| now.airspeed_mps = good.airspeed_mps),
    ("heading", |now, good| now.heading_rad = good.heading_rad),
];

/// Pitch and power of level flight are not known before it was flown: the throttle was
/// closed 25 m above the ground.
#[test]
fn what_is_lost_in_the_climb_of_a_take_off_ends_no_climb() {
    for (name, falsify) in LOST {
        for lost_m in [4.0, 25.0, 100.0] {
            let (mut flight, is_asked) = flight(falsify);
            flight.fly_until(120.0, |flight| height_m(flight) > lost_m);
            assert_eq!(flight.mode(), Mode::Takeoff);
            is_asked.store(true, Ordering::Relaxed);
            // It has gone up above 30 m, and is as it was then.
            let gear = if lost_m > 31.0 { 0.0 } else { 1.0 };
            assert_eq!(flight.record.outputs.gear, Some(gear));
            let mut highest_m = lost_m;
            for tick in 0..120 * 40 {
                flight.tick();
                let now_m = height_m(&flight);
                highest_m = highest_m.max(now_m);
                let what = format!("{name} at {lost_m} m, {tick} ticks later: {now_m} m");
                assert!(now_m > 0.9 * lost_m, "{what} {:#?}", flight.events);
                // No lower than 30 m below where it was.
                assert!(now_m > highest_m - 30.0, "{what}, from {highest_m} m");
            }
            assert!(matches!(flight.record.state.state(), State::Failsafe(_)));
            assert_eq!(flight.record.outputs.gear, None);
            assert!(
                highest_m > lost_m + 60.0,
                "{name} at {lost_m} m: {highest_m} m"
            );
        }
    }
}

/// It goes on with the climb when all is good again.
#[test]
fn a_short_loss_in_a_take_off_is_climbed_through() {
    for (name, falsify) in LOST {
        let (mut flight, is_asked) = flight(falsify);
        flight.fly_until(120.0, |flight| height_m(flight) > 10.0);
        is_asked.store(true, Ordering::Relaxed);
        let mut before_m = 0.0;
        for _ in 0..5 * 40 {
            flight.tick();
            let now_m = height_m(&flight);
            assert!(
                now_m > before_m - 0.5,
                "{name}: {now_m} m after {before_m} m"
            );
            before_m = before_m.max(now_m);
        }
        is_asked.store(false, Ordering::Relaxed);
        flight.fly_until(120.0, |flight| flight.mode() == Mode::Plan);
        assert_eq!(flight.record.state.state(), State::Engaged);
    }
}

/// In the flare, and for good: it lands, and stands.
#[test]
fn what_is_lost_in_the_flare_ends_on_the_runway() {
    for (name, falsify) in LOST {
        let (mut flight, is_asked) = flight(falsify);
        flight.fly_until(120.0, |flight| flight.mode() == Mode::Plan);
        // Not far away first, and back.
        flight.command(AutopilotCommand::Plan(LANDING_SEQUENCE));
        flight.fly_until(600.0, |flight| flight.mode() == Mode::Land);
        flight.fly_until(400.0, |flight| height_m(flight) < 4.0);
        is_asked.store(true, Ordering::Relaxed);
        let mut touches_mps = 0.0;
        flight.fly_until(90.0, |flight| {
            let (on_wheels, truth) = (
                flight.record.measurements.weight_on_wheels.value > 0.5,
                flight.truth.get(),
            );
            if !on_wheels {
                touches_mps = truth.velocity.down_mps;
            }
            on_wheels && truth.velocity.north_mps.abs() < 0.1
        });
        assert!(flight.truth.impact().is_none(), "{name}");
        assert!(touches_mps < GEAR_MPS, "{name}: {touches_mps} m/s");
        assert_eq!(flight.record.outputs.gear, Some(1.0), "{name}");
    }
}

/// A cover on the pitot tube: 18 kt, whatever the wheels tell.
#[test]
fn a_take_off_without_an_airspeed_is_given_up_in_time() {
    let (mut flight, is_asked) = flight(|now, _| now.airspeed_mps.value = 9.3);
    is_asked.store(true, Ordering::Relaxed);
    let mut fastest_mps = 0.0;
    let given_up = |flight: &Flight| {
        let told = "the take-off is given up: the airspeed stays more than 15 kt below";
        flight.events.iter().any(|event| event.starts_with(told))
    };
    flight.fly_until(120.0, |flight| {
        let now = flight.truth.get().velocity;
        fastest_mps = now.north_mps.abs().max(fastest_mps);
        assert!(height_m(flight) < 3.0);
        given_up(flight) && now.north_mps.abs() < 0.1
    });
    // 18 kt with a tail wind of 15 kt, and what it gains while that is certain and the
    // throttle is closed.
    assert!(
        fastest_mps < (18.0 + 15.0 + 20.0) * 0.514_444,
        "{fastest_mps}"
    );
}

/// The switch of the wheels says that they carry the aircraft, throughout.
#[test]
fn a_take_off_ends_with_a_wrong_switch_of_the_wheels() {
    let (mut flight, is_asked) =
        flight(|now, good| now.weight_on_wheels.value = good.weight_on_wheels.value);
    flight.fly_until(60.0, |flight| {
        flight.truth.get().velocity.north_mps.abs() > 10.0
    });
    is_asked.store(true, Ordering::Relaxed);
    flight.fly_until(120.0, |flight| flight.mode() == Mode::Plan);
    assert!((height_m(&flight) - 150.0).abs() < 10.0);
}

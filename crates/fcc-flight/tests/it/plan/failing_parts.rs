//! Parts that fail in a take-off or a landing: each of these
//! flights ended in a crash, or far off the runway.

use std::sync::{Arc, OnceLock};

use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, Sensor, SensorFault, Tick};
use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;
use fcc_sim::{Truth, TruthHandle};

use crate::plan::battery::there_and_back;
use crate::plan::flight::Flight;

/// Of the plan's home and of its runway, m.
const ELEVATION_M: f64 = 120.0;
/// What a landing gear has to withstand at least, 10 ft/s (14 CFR 23.473).
const GEAR_MPS: f64 = 10.0 * 0.304_8;
/// Half the width of a small runway, 23 m (ICAO Annex 14, table 3-1, code 2C: 30 m), and the
/// length of one.
const BESIDE_M: f64 = 15.0;
const RUNWAY_M: f64 = 1_000.0;

/// Changes what was measured, by what is true.
type Change = Box<dyn FnMut(&Truth, &mut Measurements) + Send>;

struct Failing {
    sensor: Box<dyn Sensor<Measurements>>,
    truth: Arc<OnceLock<TruthHandle>>,
    change: Change,
}

impl Sensor<Measurements> for Failing {
    fn name(&self) -> &str {
        self.sensor.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        self.sensor.sample(tick, measurements)?;
        if let Some(truth) = self.truth.get() {
            (self.change)(&truth.get(), measurements);
        }
        Ok(())
    }
}

fn above_m(truth: &Truth) -> f64 {
    truth.altitude_m - ELEVATION_M
}

/// On the approach, or beyond: the take-off is long over.
fn lands(truth: &Truth) -> bool {
    truth.time_s > 200.0 && truth.velocity.north_mps > 10.0 && truth.north_m > -6_000.0
}

/// A flight with a part that fails.
fn flight(plan: &str, keys: &str, change: impl Fn() -> Change) -> Flight {
    let truth = Arc::new(OnceLock::new());
    let flight = Flight::with(plan, &format!("[built-in]\n{keys}"), |sensor| {
        Box::new(Failing {
            sensor,
            truth: Arc::clone(&truth),
            change: change(),
        })
    });
    assert!(truth.set(flight.truth.clone()).is_ok());
    flight
}

/// Flies to the landing, and stands: m/s down at the touch, and m beside the centre line and
/// from the place aimed at.
fn land(flight: &mut Flight) -> (f64, f64, f64) {
    flight.fly_until(300.0, |flight| flight.mode() == Mode::Plan);
    flight.command(AutopilotCommand::Plan(5));
    flight.fly_until(900.0, |flight| flight.mode() == Mode::Land);
    let mut sink_mps = 0.0;
    flight.fly_until(1_500.0, |flight| {
        let now = flight.truth.get();
        assert!(flight.truth.impact().is_none(), "{:#?}", flight.events);
        if above_m(&now) > 1.5 {
            sink_mps = now.velocity.down_mps;
        }
        above_m(&now) < 1.5 && now.velocity.north_mps.hypot(now.velocity.east_mps) < 0.1
    });
    let stands = flight.truth.get();
    (sink_mps, stands.east_m, stands.north_m)
}

fn assert_on_runway(flight: &mut Flight) {
    let (sink_mps, east_m, north_m) = land(flight);
    let told = &flight.events;
    assert!(sink_mps < GEAR_MPS, "{sink_mps} m/s: {told:#?}");
    assert!(east_m.abs() < BESIDE_M, "{east_m} m: {told:#?}");
    assert!((0.0..RUNWAY_M).contains(&north_m), "{north_m} m: {told:#?}");
}

/// The receiver, or its velocity alone, is silent from the touch on, in 10 kt across: before,
/// 16 of 16 turned off the runway, by 82 to 111 m.
#[test]
fn without_a_receiver_it_rolls_out_along_the_runway() {
    for velocity_only in [false, true] {
        let mut flight = flight(
            &there_and_back(),
            "seed = 2\nwind_kt = 10\nwind_from_deg = 90\n",
            || {
                let mut is_lost = false;
                Box::new(move |now, measured| {
                    is_lost |= lands(now) && now.north_m > 0.0 && above_m(now) < 1.5;
                    if is_lost {
                        measured.velocity = Reading::default();
                    }
                    if is_lost && !velocity_only {
                        measured.position = Reading::default();
                    }
                })
            },
        );
        assert_on_runway(&mut flight);
        // Standing, dead reckoning does not say how the brakes are.
        for _ in 0..60 * 40 {
            flight.tick();
        }
        let told = &flight.events;
        assert!(
            !told.iter().any(|text| text.contains("brakes")),
            "{told:#?}"
        );
    }
}

/// Position and velocity stay what they were from 60 m on: before, 15 of 16 stood 50 to 640 m
/// off, since the place was used again with the touch.
#[test]
fn a_place_that_is_frozen_on_the_glide_path_is_not_used_on_the_wheels() {
    let mut flight = flight(&there_and_back(), "seed = 2\n", || {
        let mut frozen = None;
        Box::new(move |now, measured| {
            if frozen.is_some() || lands(now) && above_m(now) < 60.0 {
                let (place, velocity) =
                    *frozen.get_or_insert((measured.position.value, measured.velocity.value));
                measured.position.value = place;
                measured.velocity.value = velocity;
            }
        })
    });
    assert_on_runway(&mut flight);
}

/// The switch shows weight from 15 m on, with a sound range finder: before, that was left,
/// and 11 of 22 touched with 430 ft/min and more, three by raw sensors with more than 600.
#[test]
fn weight_that_is_shown_in_the_air_does_not_end_the_use_of_the_range_finder() {
    let mut flight = flight(&there_and_back(), "seed = 2\n", || {
        Box::new(|now, measured| {
            if lands(now) && above_m(now) < 15.0 {
                measured.weight_on_wheels.value = 1.0;
            }
        })
    });
    assert_on_runway(&mut flight);
    let left = "the range finder does not show height_on_wheels_m on the wheels: it is not used";
    assert!(!flight.happened(left));
}

/// The airspeed reads 40 % low from 100 m on, and is doubted: before, 24 of 28 rolled for
/// 1,100 to 1,500 m, since it braked by the airspeed without the sensor, which stays.
#[test]
fn with_a_doubted_airspeed_it_brakes() {
    let mut flight = flight(&there_and_back(), "seed = 1\n", || {
        Box::new(|now, measured| {
            if lands(now) && above_m(now) < 100.0 {
                measured.airspeed_mps.value *= 0.6;
            }
        })
    });
    assert_on_runway(&mut flight);
}

/// The airspeed stays at 28 m/s from the take-off roll on: before, 15 of 16 crashed, or rolled
/// on for 60 to 100 km with the nose pushed down.
#[test]
fn a_tube_blocked_in_the_take_off_roll_does_not_end_the_climb() {
    for seed in 1..=4 {
        let mut flight = flight(&there_and_back(), &format!("seed = {seed}\n"), || {
            Box::new(|_, measured| {
                let shown_mps = &mut measured.airspeed_mps.value;
                *shown_mps = shown_mps.min(28.0 + 1e-3 * (*shown_mps % 1.0));
            })
        });
        flight.fly_until(120.0, |flight| {
            assert!(flight.truth.impact().is_none(), "{:#?}", flight.events);
            flight.mode() == Mode::Plan
        });
        assert!(above_m(&flight.truth.get()) > 100.0);
    }
}

/// The airspeed stays what it is from 200 m on, which takes the approach off its glide path.
/// Before, 2 of 18 flew into the ground as they went around with full throttle: the nose went
/// down for a speed that did not change.
#[test]
fn an_airspeed_that_stands_still_does_not_end_a_go_around() {
    let plan = include_str!("../../../../../config/plans/circuit.waypoints");
    for seed in [2, 3] {
        let keys = format!("seed = {seed}\ngusts = {:?}\n", ["none", "light"][seed % 2]);
        let mut flight = flight(plan, &keys, || {
            let (mut stuck, mut ticks) = (None, 0_u32);
            Box::new(move |now, measured| {
                ticks += 1;
                if stuck.is_some() || lands(now) && now.time_s > 490.0 && above_m(now) < 200.0 {
                    let stuck_mps = *stuck.get_or_insert(measured.airspeed_mps.value);
                    // Noise that repeats nothing.
                    let noise_mps = 0.05 * f64::from(ticks).sin().abs();
                    measured.airspeed_mps.value = stuck_mps + noise_mps;
                }
            })
        });
        flight.fly_until(480.0, |flight| flight.truth.get().time_s > 470.0);
        let mut slowest_mps = f64::INFINITY;
        flight.fly_until(900.0, |flight| {
            let now = flight.truth.get();
            assert!(
                flight.truth.impact().is_none(),
                "{seed}: {:#?}",
                flight.events
            );
            if above_m(&now) > 10.0 {
                slowest_mps = slowest_mps.min(now.indicated_airspeed_mps);
            }
            now.velocity.north_mps.hypot(now.velocity.east_mps) < 0.1
        });
        assert!(slowest_mps > 24.0, "{slowest_mps}");
    }
}

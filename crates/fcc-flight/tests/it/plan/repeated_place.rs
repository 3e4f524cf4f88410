//! A receiver or a simulator that repeats its place in flight, or jumps, is not believed.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use fcc_core::flight::{Measurements, Position, Velocity};
use fcc_core::framework::{Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;
use fcc_plan::Place;

use crate::plan::contingency::fenced;
use crate::plan::flight::{Flight, HOME, legs};

const RATE: u64 = 40;

const REPEATS: &str = "now: satellite navigation repeats its position in motion and is not used";
const MOVES: &str =
    "now: satellite navigation gives an impossible position or velocity and is not used";

/// What a receiver does; its times go on.
const PLACE_REPEATED: u8 = 1;
const ALL_REPEATED: u8 = 2;
const REPEATED_AT_REST: u8 = 3;
const WITHOUT_VELOCITY: u8 = 4;
const NOISY_PLACE: u8 = 5;
/// Its velocity is wrong, and its place right: north and east are swapped.
const SWAPPED: u8 = 6;

struct Receiver {
    sensor: Box<dyn Sensor<Measurements>>,
    does: Arc<AtomicU8>,
    before: (Position, Velocity),
}

impl Sensor<Measurements> for Receiver {
    fn name(&self) -> &str {
        self.sensor.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        let velocity = measurements.velocity;
        let sampled = self.sensor.sample(tick, measurements);
        let (place, speed) = &mut self.before;
        let read = measurements;
        match self.does.load(Ordering::Relaxed) {
            PLACE_REPEATED => read.position.value = *place,
            ALL_REPEATED => (read.position.value, read.velocity.value) = (*place, *speed),
            REPEATED_AT_REST => {
                (read.position.value, read.velocity.value) = (*place, Velocity::default());
            }
            WITHOUT_VELOCITY => (read.position.value, read.velocity) = (*place, velocity),
            NOISY_PLACE => {
                read.position.value = *place;
                // Some 0.6 m, another one in each tick.
                let noise = f64::from(u32::try_from(tick.number % 7).unwrap_or(0)) * 1e-7;
                read.position.value.latitude_rad += noise;
            }
            SWAPPED => {
                let Velocity {
                    north_mps,
                    east_mps,
                    down_mps,
                } = read.velocity.value;
                read.velocity.value = Velocity {
                    north_mps: east_mps,
                    east_mps: north_mps,
                    down_mps,
                };
            }
            _ => self.before = (read.position.value, read.velocity.value),
        }
        sampled
    }
}

fn off_m(flight: &Flight) -> f64 {
    let estimate = &flight.record.estimate;
    flight.distance_m(Place {
        latitude_deg: estimate.latitude_rad.to_degrees(),
        longitude_deg: estimate.longitude_rad.to_degrees(),
    })
}

/// In 20 kt, after the first turn.
fn flying(keys: &str) -> (Flight, Arc<AtomicU8>) {
    let does = Arc::new(AtomicU8::new(0));
    let receiver = Arc::clone(&does);
    let keys = format!(
        "[contingency]\nposition_lost_after_s = 30\n[built-in]\nwind_from_deg = 250\nwind_kt = \
         20\n{keys}"
    );
    let plan = legs(&[0.0, 60.0, 150.0], 5_000.0, 0.0);
    let mut flight = Flight::with(&plan, &keys, |sensor| {
        Box::new(Receiver {
            sensor,
            does: Arc::clone(&receiver),
            before: (Position::default(), Velocity::default()),
        })
    });
    flight.fly_until(200.0, |flight| flight.record.setpoints.guidance.item == 2);
    for _ in 0..20 * RATE {
        flight.tick();
    }
    assert_eq!(flight.record.state.state(), State::Engaged);
    (flight, does)
}

/// Believed, it was off by 51 m/s of its way, 48 km at last, and no contingency acted.
#[test]
fn a_place_that_is_repeated_is_not_believed_and_another_one_is_again() {
    for (does, told) in [
        (PLACE_REPEATED, REPEATS),
        (ALL_REPEATED, REPEATS),
        (REPEATED_AT_REST, REPEATS),
        (WITHOUT_VELOCITY, REPEATS),
        (NOISY_PLACE, MOVES),
    ] {
        let (mut flight, receiver) = flying("");
        receiver.store(does, Ordering::Relaxed);
        flight.fly_until(8.0, |flight| flight.happened(told));
        flight.fly_until(35.0, |flight| flight.mode() == Mode::Return);
        let mut worst_m = 0.0_f64;
        for _ in 0..60 * RATE {
            flight.tick();
            worst_m = worst_m.max(off_m(&flight));
        }
        println!("{does}: {worst_m:.0} m off");
        // Twice what is stated, 2.5 m/s for 95 s.
        assert!(worst_m < 475.0, "{does}: {worst_m}");
        receiver.store(0, Ordering::Relaxed);
        flight.fly_until(15.0, |flight| {
            flight.happened("there is a position again: flying on")
        });
        for _ in 0..5 * RATE {
            flight.tick();
        }
        assert!(off_m(&flight) < 10.0, "{does}: {}", off_m(&flight));
        assert_eq!(flight.mode(), Mode::Plan);
        assert_eq!(flight.record.state.state(), State::Engaged);
    }
}

/// The place is right: airspeed and heading say so.
#[test]
fn a_wrong_velocity_is_not_held_against_the_place() {
    let (mut flight, receiver) = flying("");
    receiver.store(SWAPPED, Ordering::Relaxed);
    for _ in 0..60 * RATE {
        flight.tick();
        assert_eq!(flight.mode(), Mode::Plan);
    }
    let told = |event: &String| event.contains("satellite navigation");
    assert!(!flight.events.iter().any(told), "{:#?}", flight.events);
}

/// The fence is kept by dead reckoning: 5 km around home, with a margin of 30 m, as the
/// receiver stops 2 km from home.
#[test]
fn a_fence_is_kept_although_the_place_is_repeated() {
    for does in [PLACE_REPEATED, ALL_REPEATED] {
        let receiver = Arc::new(AtomicU8::new(0));
        let mut flight = Flight::with(&fenced(&[], 5_000.0), "[built-in]\n", |sensor| {
            Box::new(Receiver {
                sensor,
                does: Arc::clone(&receiver),
                before: (Position::default(), Velocity::default()),
            })
        });
        flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
        flight.command(AutopilotCommand::Heading(0.0));
        flight.fly_until(200.0, |flight| flight.distance_m(HOME) > 2_000.0);
        receiver.store(does, Ordering::Relaxed);
        let mut most_m = 0.0_f64;
        for _ in 0..300 * RATE {
            flight.tick();
            most_m = most_m.max(flight.distance_m(HOME));
        }
        println!("{does}: {:.0} m inside of the fence", 5_000.0 - most_m);
        assert!(most_m < 5_000.0, "{does}: {most_m}");
        assert!(flight.happened("the fence is near: turning away: returning"));
    }
}

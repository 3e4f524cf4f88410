//! Without the engine: a glide to a runway or a field that is reached, and the landing.

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_conformance::allocator_calls;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::{AutopilotCommand, Contingency, Resume};
use fcc_guidance::{Mode, Progress};
use fcc_plan::Place;
use fcc_runtime::Message;

use crate::plan::flight::{Flight, HOME, Without};

/// Ticks of a second.
const RATE: u64 = 40;
const FT: f64 = 0.304_8;
/// Of a propeller that the air turns, below the limit of these flights.
const WINDMILLS_RPM: f64 = 200.0;
const DOUBTED: &str =
    "the engine's speed fell to nothing at once: not believed, the thrust decides";

/// A sensor with an engine of 2,400 revolutions per minute, and what it shows once stopped.
struct Engine(Box<dyn Sensor<Measurements>>, Arc<AtomicBool>, f64);

impl Sensor<Measurements> for Engine {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        self.0.sample(tick, measurements)?;
        let rpm = if self.1.load(Ordering::Relaxed) {
            self.2
        } else {
            2_400.0
        };
        let radps = rpm * core::f64::consts::TAU / 60.0;
        measurements.engine_speed_radps = Reading::new(radps, tick.woke);
        Ok(())
    }
}

/// Controls whose throttle has no effect when the engine has stopped.
struct Throttle(Box<dyn Actuator<Surfaces>>, Arc<AtomicBool>);

impl Actuator<Surfaces> for Throttle {
    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        let throttle = if self.1.load(Ordering::Relaxed) {
            0.0
        } else {
            outputs.throttle
        };
        let outputs = Surfaces {
            throttle,
            ..*outputs
        };
        self.0.apply(tick, &outputs)
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.release()
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}

const RETRACTABLE: &str = "[autopilot.runway]\nretractable_gear = true\n";

/// A flight with an engine, and what stops it; its gear is retractable.
fn with_engine(plan: &str, keys: &str) -> (Flight, Arc<AtomicBool>) {
    let stops = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stops);
    let keys = format!(
        "[contingency]
engine_out_below_rpm = 300
{RETRACTABLE}{keys}"
    );
    let flight = Flight::warmed_up(plan, &keys, |sensor| {
        Box::new(Engine(sensor, Arc::clone(&stopped), WINDMILLS_RPM))
    });
    (flight, stops)
}

/// From home, 3,000 ft high, far to a course; a runway to the north begins at home, its aim
/// 300 m behind, 3,000 ft below.
fn away_from_runway(course_deg: f64) -> String {
    let mut text = String::from("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 0 1\n");
    let far = HOME.ahead(course_deg, 20_000.0);
    let before = HOME.ahead(180.0, 6_000.0);
    let aim = HOME.ahead(0.0, 300.0);
    for (number, command, at, altitude_m) in [
        (1, 16, far, 914.4),
        (2, 16, before, 300.0),
        (3, 21, aim, 0.0),
    ] {
        let (latitude, longitude) = (at.latitude_deg, at.longitude_deg);
        writeln!(
            text,
            "{number} 0 0 {command} 0 0 0 0 {latitude:.9} {longitude:.9} {altitude_m} 1"
        )
        .unwrap();
    }
    text
}

fn stands(flight: &Flight) -> bool {
    let velocity = flight.truth.get().velocity;
    flight.truth.get().altitude_m < 3.0 && velocity.north_mps.hypot(velocity.east_mps) < 0.3
}

/// Lets the engine stop after a time, s; the sink rate at the touch, ft/min, and the height
/// at which the gear was lowered, m.
fn glide_down(flight: &mut Flight, stops: &AtomicBool, after_s: u64) -> (f64, f64) {
    for _ in 0..after_s * RATE {
        flight.tick();
    }
    stops.store(true, Ordering::Relaxed);
    let from = flight.record.tick.number;
    flight.fly_until(5.0, |flight| flight.mode() == Mode::Glide);
    // 2 s, and a tick.
    let after_s = (flight.record.tick.number - from) as f64 / RATE as f64;
    assert!((2.0..2.2).contains(&after_s), "{after_s}");
    let (mut sink_fpm, mut falling_fpm, mut lowered) = (None, 0.0, None);
    flight.fly_until(1_000.0, |flight| {
        assert_eq!(flight.mode(), Mode::Glide);
        assert_eq!(flight.record.setpoints.contingency, Contingency::EngineOut);
        let gear = flight.record.outputs.gear;
        assert_ne!(gear, Some(0.0));
        if gear == Some(1.0) {
            lowered.get_or_insert(flight.truth.get());
        }
        if flight.record.measurements.weight_on_wheels.value >= 0.5 {
            sink_fpm.get_or_insert(falling_fpm);
            assert_eq!(gear, Some(1.0));
        }
        falling_fpm = flight.truth.get().velocity.down_mps / FT * 60.0;
        stands(flight)
    });
    assert!(flight.truth.impact().is_none());
    let lowered = lowered.expect("the gear was lowered");
    (sink_fpm.expect("it has touched"), lowered.altitude_m)
}

/// From 3,000 ft, on any course from the runway, in wind from any side of 10 kt: on the
/// runway, within 15 m of its middle, and no more than 300 m before and 500 m behind the
/// aim; at 500 ft/min at most.
#[test]
fn without_the_engine_it_lands_on_the_runway() {
    for (course_deg, wind_from_deg, wind_kt, after_s) in [
        (0.0, 0.0, 0.0, 60),
        (90.0, 0.0, 10.0, 60),
        (180.0, 270.0, 10.0, 90),
        (270.0, 45.0, 10.0, 30),
        (20.0, 300.0, 10.0, 50),
    ] {
        let keys = format!(
            "[built-in]\nnoise = false\nwind_from_deg = {wind_from_deg}\nwind_kt = {wind_kt}\n"
        );
        let (mut flight, stops) = with_engine(&away_from_runway(course_deg), &keys);
        let (sink_fpm, lowered_m) = glide_down(&mut flight, &stops, after_s);
        assert!(flight.happened("the engine is out: gliding"));
        let truth = flight.truth.get();
        println!(
            "course {course_deg}, wind {wind_kt} kt from {wind_from_deg}: stands {:.0} m north, \
             {:.1} m east, sink {sink_fpm:.0} ft/min, gear lowered {lowered_m:.0} m high",
            truth.north_m, truth.east_m
        );
        // A quarter of a circle of 290 m and a final of 400 m cost 95 m at a ratio of 9;
        // not before: it began 914 m high.
        assert!((80.0..450.0).contains(&lowered_m), "{lowered_m}");
        assert!(sink_fpm < 500.0, "{sink_fpm}");
        assert!(truth.east_m.abs() < 15.0, "{truth:?}");
        assert!((0.0..1_100.0).contains(&truth.north_m), "{truth:?}");
    }
}

/// In 12 kt from behind it lands on the same runway the other way, 800 m of which begin 300 m
/// before the aim.
#[test]
fn in_a_tail_wind_it_lands_against_the_runway_s_direction() {
    let keys = "[built-in]\nnoise = false\nwind_from_deg = 180\nwind_kt = 12\n";
    let (mut flight, stops) = with_engine(&away_from_runway(60.0), keys);
    let (sink_fpm, lowered_m) = glide_down(&mut flight, &stops, 40);
    let truth = flight.truth.get();
    assert!((80.0..450.0).contains(&lowered_m), "{lowered_m}");
    println!(
        "stands {:.0} m north, {:.1} m east, sink {sink_fpm:.0} ft/min",
        truth.north_m, truth.east_m
    );
    assert!(truth.heading_rad.cos() < -0.99, "{truth:?}");
    assert!(sink_fpm < 500.0, "{sink_fpm}");
    assert!(truth.east_m.abs() < 15.0, "{truth:?}");
    assert!((0.0..800.0).contains(&truth.north_m), "{truth:?}");
}

/// 20 km from everything: into the wind, and down.
#[test]
fn where_nothing_is_reached_it_lands_into_the_wind() {
    let keys = "[built-in]\nnoise = false\nwind_from_deg = 60\nwind_kt = 15\n";
    let (mut flight, stops) = with_engine(&away_from_runway(200.0), keys);
    let (sink_fpm, lowered_m) = glide_down(&mut flight, &stops, 340);
    // As soon as it is known that no final follows.
    assert!(lowered_m > 900.0, "{lowered_m}");
    assert!(flight.distance_m(HOME) > 10_000.0);
    let heading_deg = flight
        .truth
        .get()
        .heading_rad
        .to_degrees()
        .rem_euclid(360.0);
    println!("heading {heading_deg:.1}°, sink {sink_fpm:.0} ft/min");
    assert!((heading_deg - 60.0).abs() < 5.0, "{heading_deg}");
    assert!(sink_fpm < 500.0, "{sink_fpm}");
}

/// 5 s after the engine runs again the plan is flown where it was left; a command ends a
/// glide as well, and it is not begun again for the same failure.
#[test]
fn an_engine_that_runs_again_continues_the_plan() {
    let (mut flight, stops) = with_engine(&away_from_runway(0.0), "[built-in]\nnoise = false\n");
    for _ in 0..40 * RATE {
        flight.tick();
    }
    stops.store(true, Ordering::Relaxed);
    flight.fly_until(3.0, |flight| flight.mode() == Mode::Glide);
    for _ in 0..40 * RATE {
        flight.tick();
    }
    assert!(flight.record.outputs.throttle < 1e-9);
    let airspeed_kt = flight.record.estimate.airspeed_mps * 3.6 / 1.852;
    assert!((airspeed_kt - 65.0).abs() < 2.0, "{airspeed_kt}");
    stops.store(false, Ordering::Relaxed);
    let from = flight.record.tick.number;
    flight.fly_until(6.0, |flight| flight.mode() == Mode::Plan);
    let after_s = (flight.record.tick.number - from) as f64 / RATE as f64;
    assert!((5.0..5.2).contains(&after_s), "{after_s}");
    flight.fly_until(1.0, |flight| {
        flight.happened("the engine runs again: flying on")
    });
    assert_eq!(flight.record.setpoints.contingency, Contingency::None);
    flight.fly_until(120.0, |flight| {
        flight.truth.get().altitude_m > 890.0 && flight.record.outputs.throttle > 0.3
    });
    // Commanded, it does not glide again.
    stops.store(true, Ordering::Relaxed);
    flight.fly_until(3.0, |flight| flight.mode() == Mode::Glide);
    flight.command(AutopilotCommand::Pause);
    for _ in 0..10 * RATE {
        flight.tick();
    }
    assert_eq!(flight.mode(), Mode::Loiter);
}

/// The engine of the built-in aircraft, which stops after a minute: what is not configured
/// is not watched, and neither is what is not measured.
#[test]
fn an_engine_that_stops_is_missed_if_it_is_watched() {
    let plan = away_from_runway(0.0);
    let below = "engine_out_below_rpm = 600";
    for (keys, is_measured, mode) in [
        ("", true, Mode::Plan),
        (below, true, Mode::Glide),
        (below, false, Mode::Plan),
    ] {
        let keys =
            format!("[contingency]\n{keys}\n[built-in]\nnoise = false\nengine_stops_at_s = 60\n");
        let mut flight = Flight::with(&plan, &keys, |sensor| {
            if is_measured {
                return sensor;
            }
            Box::new(Without(sensor, |into| {
                into.engine_speed_radps = Reading::default();
            }))
        });
        for _ in 0..60 * RATE {
            flight.tick();
            assert_eq!(flight.record.setpoints.contingency, Contingency::None);
        }
        // It slows down, and with it the propeller.
        for _ in 0..15 * RATE {
            flight.tick();
        }
        assert_eq!(flight.mode(), mode, "{keys}");
    }
}

/// Where the engine's speed is not measured: not in gusts, a climb and a descent with power;
/// without, within the time that the autopilot needs to open the throttle by half, and 4 s.
#[test]
fn an_engine_that_is_not_measured_is_missed_by_its_thrust() {
    let stops = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stops);
    let keys = "[contingency]\nengine_out_by_thrust = true\nengine_out_after_s = 4\n[built-in]\n\
                gusts = \"moderate\"\n";
    let mut flight = Flight::between(
        &away_from_runway(0.0),
        keys,
        |sensor| sensor,
        |actuator| Box::new(Throttle(actuator, Arc::clone(&stopped))),
    );
    for (altitude_m, seconds) in [(914.4, 40), (1_100.0, 90), (800.0, 120)] {
        flight.command(AutopilotCommand::Altitude(altitude_m));
        for _ in 0..seconds * RATE {
            flight.tick();
            assert_ne!(flight.mode(), Mode::Glide);
        }
    }
    flight.command(AutopilotCommand::Plan(0));
    stops.store(true, Ordering::Relaxed);
    flight.fly_until(20.0, |flight| flight.happened("the engine is out: gliding"));
    assert_eq!(flight.mode(), Mode::Glide);
}

/// In flight no engine stops from one tick to the next: the speed of a sensor whose wire has
/// broken is not believed. Then the thrust tells of the engine, as where it is not measured.
#[test]
fn a_speed_that_is_nothing_at_once_does_not_stop_a_healthy_engine() {
    let breaks = Arc::new(AtomicBool::new(false));
    let stops = Arc::new(AtomicBool::new(false));
    let (broken, stopped) = (Arc::clone(&breaks), Arc::clone(&stops));
    let mut flight = Flight::between(
        &away_from_runway(0.0),
        "[contingency]\nengine_out_below_rpm = 300\n[built-in]\ngusts = \"moderate\"\n",
        |sensor| Box::new(Engine(sensor, Arc::clone(&broken), 0.0)),
        |actuator| Box::new(Throttle(actuator, Arc::clone(&stopped))),
    );
    for _ in 0..40 * RATE {
        flight.tick();
    }
    breaks.store(true, Ordering::Relaxed);
    flight.fly_until(0.5, |flight| flight.happened(DOUBTED));
    for _ in 0..120 * RATE {
        flight.tick();
        assert_eq!(flight.mode(), Mode::Plan);
    }
    stops.store(true, Ordering::Relaxed);
    flight.fly_until(20.0, |flight| flight.happened("the engine is out: gliding"));
    assert_eq!(flight.mode(), Mode::Glide);
    // Once tried, the engine gives thrust again.
    stops.store(false, Ordering::Relaxed);
    flight.fly_until(120.0, |flight| {
        flight.happened("the engine runs again: flying on")
    });
}

/// Resumed after a restart it glides, and acts on no other engine failure than this.
#[test]
fn a_glide_goes_on_after_a_restart() {
    let (mut flight, stops) = with_engine(&away_from_runway(0.0), "[built-in]\nnoise = false\n");
    flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
    stops.store(true, Ordering::Relaxed);
    flight.command(AutopilotCommand::Resume(Resume {
        progress: Progress {
            mode: Mode::Glide,
            ..flight.record.setpoints.guidance
        },
        ..Resume::default()
    }));
    flight.fly_until(0.1, |flight| flight.mode() == Mode::Glide);
    let contingency = flight.record.setpoints.contingency;
    assert_eq!(contingency, Contingency::EngineOut);
    let glides = "the engine is out: gliding";
    for _ in 0..20 * RATE {
        flight.tick();
    }
    let told = flight.events.iter().filter(|event| *event == glides);
    assert_eq!(told.count(), 1);
    assert_eq!(flight.mode(), Mode::Glide);
}

/// The whole glide, from the choice to the stop.
#[test]
fn a_glide_does_not_allocate() {
    let (mut flight, stops) = with_engine(
        &away_from_runway(90.0),
        "[built-in]\nnoise = false\nwind_kt = 5\n",
    );
    for _ in 0..40 * RATE {
        flight.tick();
    }
    stops.store(true, Ordering::Relaxed);
    let mut last = flight.record;
    let ((), calls) = allocator_calls(|| {
        for _ in 0..400 * RATE {
            let _ = flight.machine.step();
            while let Some(message) = flight.link.messages.receive() {
                if let Message::Tick(record) = message {
                    last = record;
                }
            }
        }
    });
    assert_eq!(calls, 0);
    assert_eq!(last.state.state(), State::Engaged);
    assert_eq!(last.setpoints.guidance.mode, Mode::Glide);
    flight.record = last;
    assert!(stands(&flight));
    let home: Place = HOME;
    assert!(flight.distance_m(home) < 1_500.0);
}

//! The built-in aircraft is thrown, flies a circuit and lands where it was, without brakes
//! and without a switch for its weight; without a call of the allocator.
//!
//! A process of its own: what another test initialises first would not allocate here.
#![cfg(test)]

use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::Config;
use fcc_flight::flight::assemble;
use fcc_guidance::Mode;
use fcc_runtime::{Machine, Message, Parts};
use fcc_sim::{SimConfig, SimSensor, Simulation, Truth};
use fcc_telemetry::FlightRecord;
use fcc_timer::ManualTimer;

/// Straight ahead to 150 m, two places in the north-east, back.
const PLAN: &str = "QGC WPL 110\n\
    0 0 0 16 0 0 0 0 47 8 120 1\n\
    1 0 3 22 8 0 0 0 0 0 150 1\n\
    2 0 2 178 0 46 -1 0 0 0 0 1\n\
    3 0 3 16 0 0 0 0 47.02 8.045 250 1\n\
    4 0 3 16 0 0 0 0 47.0 8.12 300 1\n\
    5 0 3 21 0 0 0 0 0 0 0 1\n";
const HEADING_RAD: f64 = 0.5;
const ELEVATION_M: f64 = 120.0;
const RATE: f64 = 40.0;
/// Of a knock, and of the throw: when it begins, how long it takes, and how strong it is.
const KNOCK: (f64, f64, f64) = (8.0, 0.05, 30.0);
const THROW: (f64, f64, f64) = (12.0, 1.5, 20.0);

/// The built-in aircraft without a switch for weight on wheels, with a catapult.
struct Thrown(SimSensor);

impl Sensor<Measurements> for Thrown {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        let now_s = tick.number as f64 / RATE;
        let pushes = |(at_s, for_s, mps2): (f64, f64, f64)| {
            let is_on = (at_s - 0.01..at_s + for_s - 0.01).contains(&now_s);
            if is_on { mps2 } else { 0.0 }
        };
        // A knock moves it hardly: only the throw does.
        let mut state = *self.0.aircraft().state();
        state.velocity_mps.x += pushes(THROW) / RATE * HEADING_RAD.cos();
        state.velocity_mps.y += pushes(THROW) / RATE * HEADING_RAD.sin();
        self.0.aircraft_mut().set_state(state);
        self.0.sample(tick, measurements)?;
        measurements.specific_force.value.x_mps2 += pushes(THROW) + pushes(KNOCK);
        measurements.weight_on_wheels = Reading::default();
        Ok(())
    }
}

fn machine() -> (
    Machine<Autopilot>,
    fcc_runtime::Link<Autopilot>,
    fcc_sim::TruthHandle,
) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.waypoints");
    std::fs::write(&file, PLAN).unwrap();
    let text = format!(
        "[guidance]\nmode = \"plan\"\n[plan]\nfile = {:?}\n[autopilot.runway]\nlaunch_g = 1.5\n\
         brake = 0\n[built-in]\nnoise = false\n",
        file.to_str().unwrap()
    );
    let mut config = Config::parse(&text, "test").unwrap();
    config.load_plan(1_790_000_000).unwrap();
    let assembly = assemble(&config).unwrap();
    let aircraft = Simulation::new(&SimConfig {
        on_runway: true,
        ground_m: ELEVATION_M,
        heading_rad: HEADING_RAD,
        latitude_rad: 47.0_f64.to_radians(),
        longitude_rad: 8.0_f64.to_radians(),
        ..SimConfig::default()
    })
    .unwrap();
    let parts = Parts {
        timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
        sensors: vec![Box::new(Thrown(aircraft.sensor))],
        controller: Autopilot::new(*assembly.autopilot.config()),
        actuators: vec![Box::new(aircraft.actuator)],
    };
    let (mut machine, link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();
    (machine, link, aircraft.truth)
}

/// A nose held up by 45° shows 0.7 g.
#[test]
fn a_launch_that_a_hand_shows_is_refused() {
    let text = "[built-in]\n[autopilot.runway]\nlaunch_g = 0.5\n";
    let error = Config::parse(text, "test").unwrap_err().to_string();
    let wrong = "test:3: autopilot.runway.launch_g: is 0.5: choose at least 0.8, or 0";
    assert!(error.starts_with(wrong), "{error}");
    Config::parse(&text.replace("0.5", "0.8"), "test").unwrap();
}

#[test]
fn thrown_it_climbs_straight_ahead_and_lands_there_without_brakes() {
    let (mut machine, mut link, truth) = machine();
    let start = truth.get();
    let (mut record, mut touch) = (FlightRecord::default(), Truth::default());
    let (mut most_bank_rad, mut opened_s, mut most_brake) = (0.0_f64, None, 0.0_f64);
    let mut modes = Vec::with_capacity(20);
    let mut stood = false;
    let ((), calls) = allocator_calls(|| {
        for _ in 0..80_000 {
            let _ = machine.step();
            while let Some(message) = link.messages.receive() {
                if let Message::Tick(tick) = message {
                    record = tick;
                }
            }
            let now_s = record.tick.number as f64 / RATE;
            let (outputs, now) = (record.outputs, truth.get());
            let mode = record.setpoints.guidance.mode;
            if modes.last() != Some(&mode) {
                modes.push(mode);
            }
            if record.state.state() == State::Engaged && outputs.throttle > 0.0 {
                opened_s = opened_s.or(Some(now_s));
            }
            let height_m = now.altitude_m - ELEVATION_M;
            if height_m < 15.0 {
                most_bank_rad = most_bank_rad.max(now.roll_rad.abs());
            }
            most_brake = most_brake.max(outputs.left_brake.unwrap_or(0.0));
            if mode == Mode::Land && height_m > 1.5 {
                touch = now;
            }
            if mode == Mode::Land && now.velocity.north_mps.abs() < 0.05 {
                stood = true;
                break;
            }
        }
    });
    assert_eq!(calls, 0);
    assert!(stood, "{modes:?} {:?}", truth.get());
    assert_eq!(modes, [Mode::None, Mode::Takeoff, Mode::Plan, Mode::Land]);
    // 0.1 s after the begin of the throw, and not by the knock.
    let opened_s = opened_s.unwrap();
    assert!((12.0..12.2).contains(&opened_s), "{opened_s}");
    assert!(most_bank_rad < 10.0_f64.to_radians(), "{most_bank_rad}");
    assert_eq!(most_brake, 0.0);
    assert_eq!(record.outputs.throttle, 0.0);
    let (north, east) = (touch.north_m - start.north_m, touch.east_m - start.east_m);
    let (sin, cos) = HEADING_RAD.sin_cos();
    let (along_m, off_m) = (north * cos + east * sin, east * cos - north * sin);
    assert!((-100.0..300.0).contains(&along_m), "{along_m}");
    assert!(off_m.abs() < 5.0, "{off_m}");
    assert!(
        touch.velocity.down_mps < 200.0 * 0.304_8 / 60.0,
        "{touch:?}"
    );
    assert!(truth.impact().is_none());
}

//! The built-in aircraft takes off, flies a circuit and lands, in lockstep, scored from
//! its truth; without a call of the allocator.
//!
//! A process of its own: what another test initialises first would not allocate here.
#![cfg(test)]

use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::framework::State;
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::Config;
use fcc_flight::flight::assemble;
use fcc_guidance::Mode;
use fcc_runtime::{Machine, Message, Parts};
use fcc_sim::Truth;
use fcc_telemetry::FlightRecord;
use fcc_timer::ManualTimer;

/// Take-off to the north, a circuit to the left, landing to the north: the file that
/// `make fly-plan PLAN=` names.
const CIRCUIT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../config/plans/circuit.waypoints"
);
/// Of its home, m above mean sea level.
const ELEVATION_M: f64 = 120.0;
/// Where it aims, m behind its home: 0.0026995° of latitude, each 111.13 km at 45°.
const AIMED_M: f64 = 300.0;

/// What the truth and the record show of a flight.
struct Flown {
    /// North and east of home in m, sink rate in m/s, heading in rad: as the wheels touch.
    touch: Truth,
    end: Truth,
    /// The largest distance from the centre line on the wheels, m.
    off_m: f64,
    modes: Vec<Mode>,
    /// The gear that is written, whenever it changes, and the truth then.
    gear: Vec<(Option<f64>, Mode, Truth)>,
    record: FlightRecord,
}

fn fly(keys: &str) -> Flown {
    fly_plan(CIRCUIT, keys)
}

fn fly_plan(file: &str, keys: &str) -> Flown {
    let plan = format!("[guidance]\nmode = \"plan\"\n[plan]\nfile = {file:?}\n[built-in]\n{keys}");
    let mut config = Config::parse(&plan, "test").unwrap();
    config.load_plan(1_790_000_000).unwrap();
    let assembly = assemble(&config).unwrap();
    let truth = assembly.true_now.unwrap();
    let parts = Parts {
        timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
        sensors: assembly.sensors,
        controller: Autopilot::new(*assembly.autopilot.config()),
        actuators: assembly.actuators,
    };
    let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();
    let mut flown = Flown {
        touch: Truth::default(),
        end: Truth::default(),
        off_m: 0.0,
        modes: Vec::with_capacity(100),
        gear: Vec::with_capacity(100),
        record: FlightRecord::default(),
    };
    let ((), calls) = allocator_calls(|| {
        for _ in 0..60_000 {
            let before = truth.get();
            let _ = machine.step();
            while let Some(message) = link.messages.receive() {
                if let Message::Tick(record) = message {
                    flown.record = record;
                }
            }
            let mode = flown.record.setpoints.guidance.mode;
            if flown.modes.last() != Some(&mode) {
                flown.modes.push(mode);
            }
            let on_wheels = flown.record.measurements.weight_on_wheels.value > 0.5;
            let now = truth.get();
            let gear = flown.record.outputs.gear;
            if flown.gear.last().is_none_or(|(before, ..)| *before != gear) {
                flown.gear.push((gear, mode, now));
            }
            if on_wheels {
                flown.off_m = flown.off_m.max(now.east_m.abs());
            } else if now.altitude_m < ELEVATION_M + 20.0 {
                flown.touch = before;
            }
            flown.end = now;
            let stands = now.velocity.north_mps.abs() < 0.05 && mode == Mode::Land;
            if stands && on_wheels {
                break;
            }
        }
    });
    assert_eq!(calls, 0);
    assert!(truth.impact().is_none(), "{:?}", truth.impact());
    flown
}

/// A fixed gear is not written. Another one is down from the roll to 30 m, up in the climb,
/// and down from the approach to the end, as the runway's is the last leg.
fn assert_gear(flown: &Flown, is_retractable: bool) {
    let written: Vec<_> = flown.gear.iter().map(|(gear, ..)| *gear).collect();
    if !is_retractable {
        assert_eq!(written, [None]);
        return;
    }
    let [
        _,
        (_, first, stands),
        (_, second, climbs),
        _,
        (_, last, begins),
    ] = flown.gear[..]
    else {
        panic!("{written:?}");
    };
    assert_eq!(written, [None, Some(1.0), Some(0.0), None, Some(1.0)]);
    assert_eq!(
        [first, second, last],
        [Mode::Takeoff, Mode::Takeoff, Mode::Land]
    );
    assert!(stands.velocity.north_mps.abs() < 0.1, "{stands:?}");
    let height_m = climbs.altitude_m - ELEVATION_M;
    assert!((30.0..36.0).contains(&height_m), "{height_m}");
    assert!(climbs.velocity.down_mps < -0.5, "{climbs:?}");
    // Before the glide path of 3° is met.
    let (above_m, before_m) = (begins.altitude_m - ELEVATION_M, AIMED_M - begins.north_m);
    assert!(
        above_m / before_m < 3.0_f64.to_radians().tan(),
        "{above_m} {before_m}"
    );
}

/// The limits: 30 m of runway, ±5 m, 200 ft/min, 5°.
#[test]
fn takes_off_and_lands_in_8_kt_across_from_either_side() {
    for (from_deg, is_retractable) in [(90, false), (270, true)] {
        let flown = fly(&format!(
            "noise = false\nwind_kt = 8\nwind_from_deg = {from_deg}\n[autopilot.runway]\n\
             retractable_gear = {is_retractable}\n"
        ));
        assert_gear(&flown, is_retractable);
        let modes = [Mode::None, Mode::Takeoff, Mode::Plan, Mode::Land];
        assert_eq!(flown.modes, modes);
        assert_eq!(flown.record.state.state(), State::Engaged);
        let touch = flown.touch;
        let along_m = touch.north_m - AIMED_M;
        let heading_deg = (touch.heading_rad.to_degrees() + 180.0) % 360.0 - 180.0;
        assert!(touch.east_m.abs() < 5.0, "{touch:?}");
        assert!((-150.0..300.0).contains(&along_m), "{along_m}");
        assert!(
            touch.velocity.down_mps < 200.0 * 0.304_8 / 60.0,
            "{touch:?}"
        );
        assert!(heading_deg.abs() < 5.0, "{heading_deg}");
        assert!(flown.off_m < 5.0, "{}", flown.off_m);
        assert!(flown.end.north_m - touch.north_m < 800.0, "{:?}", flown.end);
    }
}

/// The circuit with a waypoint for its take-off begins in the air. A QNH of 1013 hPa for one of 1008 is
/// 43 m off (0.12 hPa a metre): without a range finder nothing else shows where the ground
/// is but the satellite receiver.
#[test]
fn a_landing_that_begins_in_the_air_needs_an_altimeter_that_is_set() {
    let circuit = std::fs::read_to_string(CIRCUIT).unwrap();
    let air = circuit.replace("1\t0\t3\t22\t8\t", "1\t0\t3\t16\t0\t");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("air.waypoints");
    std::fs::write(&file, air).unwrap();
    let file = file.to_str().unwrap();
    let flown = fly_plan(file, "noise = false\n");
    assert_eq!(flown.modes, [Mode::None, Mode::Plan, Mode::Land]);
    assert!(flown.touch.velocity.down_mps < 200.0 * 0.304_8 / 60.0);
    let flown = fly_plan(file, "noise = false\n[altimeter]\nsetting_hpa = 1008.25\n");
    let landings = flown.modes.iter().filter(|mode| **mode == Mode::Land);
    assert_eq!(landings.count(), 3, "{:?}", flown.modes);
    assert_eq!(flown.modes.last(), Some(&Mode::Plan), "it circles");
    assert!(flown.end.altitude_m > ELEVATION_M + 50.0);
}

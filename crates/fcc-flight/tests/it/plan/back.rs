//! The aircraft lands where it took off, in the same direction: by an item without a place,
//! and by a command.

use std::fmt::Write as _;

use fcc_core::framework::State;
use fcc_fixed_wing::{AutopilotCommand, Resume};
use fcc_guidance::route::TookOff;
use fcc_guidance::{Mode, Progress};
use fcc_sim::Truth;

use crate::plan::flight::{Flight, HOME, legs};

/// 200 ft/min.
const MOST_SINK_MPS: f64 = 200.0 * 0.304_8 / 60.0;

/// Take-off straight ahead to 150 m, two places in the east, and more items.
fn circuit(more: &str) -> String {
    let mut text = String::from(
        "QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 120 1\n1 0 3 22 8 0 0 0 0 0 150 1\n\
         2 0 2 178 0 46 -1 0 0 0 0 1\n",
    );
    for (number, course_deg, away_m, above_m) in [(3, 60.0, 4_000.0, 250), (4, 90.0, 9_000.0, 300)]
    {
        let at = HOME.ahead(course_deg, away_m);
        let (latitude, longitude) = (at.latitude_deg, at.longitude_deg);
        writeln!(
            text,
            "{number} 0 3 16 0 0 0 0 {latitude:.9} {longitude:.9} {above_m} 1"
        )
        .unwrap();
    }
    text + more
}

/// How far a place is ahead of another one in a direction, and to the right of it, m.
fn from(start: &Truth, course_rad: f64, now: &Truth) -> (f64, f64) {
    let (north, east) = (now.north_m - start.north_m, now.east_m - start.east_m);
    let (sin, cos) = course_rad.sin_cos();
    (north * cos + east * sin, east * cos - north * sin)
}

/// Flies until it stands, and asserts where and how the wheels touch.
fn lands_back(flight: &mut Flight, start: &Truth) {
    let mut touch = flight.truth.get();
    flight.fly_until(1_800.0, |flight| {
        let on_wheels = flight.record.measurements.weight_on_wheels.value > 0.5;
        if !on_wheels {
            touch = flight.truth.get();
        }
        on_wheels && flight.truth.get().velocity.north_mps.abs() < 0.05
    });
    let (along_m, off_m) = from(start, start.heading_rad, &touch);
    assert!((-100.0..300.0).contains(&along_m), "{along_m}");
    assert!(off_m.abs() < 5.0, "{off_m}");
    assert!(touch.velocity.down_mps < MOST_SINK_MPS, "{touch:?}");
    assert_eq!(flight.record.state.state(), State::Engaged);
    assert!(flight.truth.impact().is_none());
}

fn takes_off(plan: &str, wind: &str) -> (Flight, Truth) {
    let keys = format!("[built-in]\nnoise = false\nheading_deg = 30\n{wind}");
    let mut flight = Flight::new(plan, &keys);
    flight.tick();
    let start = flight.truth.get();
    flight.fly_until(120.0, |flight| flight.mode() == Mode::Plan);
    (flight, start)
}

#[test]
fn an_item_without_a_place_is_where_it_took_off() {
    let plan = circuit("5 0 3 21 0 0 0 0 0 0 0 1\n");
    let (mut flight, start) = takes_off(&plan, "wind_kt = 8\nwind_from_deg = 120\n");
    lands_back(&mut flight, &start);
    let reached = |text: &String| text == "item 5 of the plan is reached";
    let told = flight.events.iter().filter(|event| reached(event)).count();
    assert_eq!(told, 1, "{:#?}", flight.events);
}

/// In a plan without a landing.
#[test]
fn a_command_lands_where_it_took_off() {
    let (mut flight, start) = takes_off(&circuit(""), "wind_kt = 8\nwind_from_deg = 300\n");
    flight.command(AutopilotCommand::Land);
    // On its way there, too: it is kept over a restart.
    flight.fly_until(1.0, |flight| flight.mode() == Mode::Land);
    assert_eq!(flight.record.setpoints.guidance.item, 0);
    lands_back(&mut flight, &start);
}

/// It did not see a take-off.
#[test]
fn without_a_take_off_it_is_not_carried_out() {
    let mut flight = Flight::new(&legs(&[0.0], 20_000.0, 0.0), "[built-in]\n");
    flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
    flight.command(AutopilotCommand::Land);
    let refused = "not carried out: the plan has no landing, and the aircraft was not seen to \
                   take off";
    flight.fly_until(1.0, |flight| flight.happened(refused));
    assert_eq!(flight.mode(), Mode::Plan);
}

/// As a restart in flight does: with what the record of the flight before has, in another
/// autopilot, which has seen no take-off. The ground is 120 m high (393.7 ft).
#[test]
fn after_a_restart_it_lands_where_it_took_off() {
    let (before, start) = takes_off(&circuit(""), "");
    let resume = |mode, item, took_off| {
        AutopilotCommand::Resume(Resume {
            progress: Progress {
                mode,
                item,
                ..before.record.setpoints.guidance
            },
            took_off,
            ..Resume::default()
        })
    };
    let took_off = before.record.setpoints.took_off;
    for (resumed, commanded) in [
        (
            resume(Mode::Plan, 1, took_off),
            Some(AutopilotCommand::Land),
        ),
        // It was on its way back.
        (resume(Mode::Land, 0, took_off), None),
    ] {
        let keys = "[built-in]\nnoise = false\nground_ft = 393.7\n";
        let mut flight = Flight::new(&legs(&[30.0, 60.0], 9_000.0, 0.0), keys);
        flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
        assert_eq!(flight.record.setpoints.took_off, TookOff::default());
        flight.command(resumed);
        flight.tick();
        assert_eq!(flight.record.setpoints.took_off, took_off);
        if let Some(command) = commanded {
            flight.command(command);
        }
        lands_back(&mut flight, &start);
    }
    // Not known, it returns.
    let mut flight = Flight::new(&legs(&[30.0], 9_000.0, 0.0), "[built-in]\n");
    flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
    flight.command(resume(Mode::Land, 0, TookOff::default()));
    flight.fly_until(0.1, |flight| flight.mode() == Mode::Return);
}

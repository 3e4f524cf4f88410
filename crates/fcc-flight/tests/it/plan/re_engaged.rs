//! Disengaged on the wheels after a landing, and engaged again, by a plan that begins with
//! a take-off.

use fcc_core::framework::{LoopCommand, State};
use fcc_guidance::Mode;

use crate::plan::flight::Flight;

/// The plan of `make fly-plan`: its take-off begins at its home, its landing aims 300 m behind.
const CIRCUIT: &str = include_str!("../../../../../config/plans/circuit.waypoints");
const REFUSED: &str = "not engaged: airspeed is below the floor: fly faster than \
                       envelope.min_airspeed_kt; a take-off begins standing, where its runway \
                       begins";

fn speed_mps(flight: &Flight) -> f64 {
    let velocity = flight.truth.get().velocity;
    velocity.north_mps.hypot(velocity.east_mps)
}

fn send(flight: &mut Flight, command: LoopCommand<fcc_fixed_wing::AutopilotCommand>) {
    flight.link.commands.send(command).unwrap();
    flight.tick();
    flight.tick();
}

/// Landed, and disengaged in the roll-out below this speed over the ground.
fn disengaged_below(most_mps: f64, seed: u64) -> Flight {
    let keys = format!("[built-in]\nwind_kt = 8\nwind_from_deg = 270\nseed = {seed}\n");
    let mut flight = Flight::new(CIRCUIT, &keys);
    flight.fly_until(1_200.0, |flight| {
        let on_wheels = flight.record.measurements.weight_on_wheels.value > 0.5;
        flight.mode() == Mode::Land && on_wheels && speed_mps(flight) < most_mps
    });
    send(&mut flight, LoopCommand::Disengage);
    assert_eq!(flight.record.state.state(), State::Standby);
    flight
}

#[test]
fn in_the_roll_out_and_where_it_ends_no_take_off_begins() {
    for (most_mps, seed) in [(28.0, 31), (20.0, 32), (8.0, 33), (0.1, 34)] {
        let mut flight = disengaged_below(most_mps, seed);
        send(&mut flight, LoopCommand::Engage);
        let stays = flight.record.state.state();
        assert_eq!(stays, State::Standby, "{most_mps} m/s");
        assert!(flight.happened(REFUSED), "{:#?}", flight.events);
    }
}

/// Given up as it begins, it has not moved: it may begin again.
#[test]
fn where_it_began_a_take_off_begins_again() {
    let mut flight = Flight::new(CIRCUIT, "[built-in]\nseed = 35\n");
    flight.fly_until(60.0, |flight| flight.mode() == Mode::Takeoff);
    send(&mut flight, LoopCommand::Disengage);
    flight.fly_until(60.0, |flight| speed_mps(flight) < 0.1);
    send(&mut flight, LoopCommand::Engage);
    assert_eq!(flight.record.state.state(), State::Engaged);
    flight.fly_until(120.0, |flight| flight.mode() == Mode::Plan);
}

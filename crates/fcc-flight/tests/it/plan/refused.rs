//! Commands that are not carried out: their sender is told why.

use fcc_core::framework::State;
use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;

use crate::plan::flight::{Flight, legs};

/// Engaged on the circuit's runway, or in the air.
fn engaged(plan: &str, keys: &str) -> Flight {
    let mut flight = Flight::new(plan, keys);
    flight.fly_until(60.0, |flight| flight.record.state.state() == State::Engaged);
    flight
}

/// Commands it; what is told within a second.
fn told(flight: &mut Flight, command: AutopilotCommand) -> Vec<String> {
    let before = flight.events.len();
    flight.command(command);
    for _ in 0..40 {
        flight.tick();
    }
    let events = flight.events.iter().skip(before);
    let refusals = events.filter(|event| event.starts_with("not carried out: "));
    refusals.cloned().collect()
}

#[test]
fn in_the_air_it_is_what_the_plan_and_the_landing_lack() {
    let mut flight = engaged(&legs(&[0.0, 60.0], 20_000.0, 0.0), "[built-in]\n");
    let no_item = "not carried out: the plan has no such item";
    assert_eq!(told(&mut flight, AutopilotCommand::Plan(7)), [no_item]);
    let not_landing = "not carried out: the aircraft is not landing, or is on its wheels";
    assert_eq!(told(&mut flight, AutopilotCommand::GoAround), [not_landing]);
    assert_eq!(flight.mode(), Mode::Plan);
    assert!(told(&mut flight, AutopilotCommand::Pause).is_empty());
    assert_eq!(flight.mode(), Mode::Loiter);
}

/// The plan of `make fly-plan`: its runway's elevation is 120 m.
#[test]
fn over_the_runway_it_is_the_height() {
    let circuit = include_str!("../../../../../config/plans/circuit.waypoints");
    let mut flight = engaged(circuit, "[built-in]\n");
    let on_wheels =
        "not carried out: the aircraft rolls or stands on its runway; disengaging is possible";
    assert_eq!(told(&mut flight, AutopilotCommand::Pause), [on_wheels]);
    assert_eq!(flight.mode(), Mode::Takeoff);
    let is_low = |flight: &Flight| {
        flight.mode() == Mode::Land && flight.truth.get().altitude_m < 120.0 + 25.0
    };
    flight.fly_until(900.0, is_low);
    let low = "not carried out: the aircraft is too low over the runway: it climbs first, command \
               it again then";
    let heading = AutopilotCommand::Heading(1.0);
    assert_eq!(told(&mut flight, heading), [low]);
    assert_eq!(flight.mode(), Mode::GoAround);
    flight.fly_until(60.0, |flight| flight.truth.get().altitude_m > 120.0 + 60.0);
    assert!(told(&mut flight, heading).is_empty());
    assert_eq!(flight.mode(), Mode::Hold);
}

/// Set to 1040 hPa in the roll, the aircraft had the take-off's altitude at once, and flew
/// into the ground at 989 ft/min.
#[test]
fn the_altimeter_is_not_set_in_the_roll() {
    let circuit = include_str!("../../../../../config/plans/circuit.waypoints");
    let mut flight = engaged(circuit, "[built-in]\n");
    let rolls = |flight: &Flight| flight.record.measurements.airspeed_mps.value > 20.0;
    flight.fly_until(30.0, rolls);
    let setting = AutopilotCommand::AltimeterSetting(101_400.0);
    let low = "not carried out: the height over the runway is measured by the altimeter: set it \
               while the aircraft stands, or above autopilot.runway.decision_height_ft over the \
               runway";
    assert_eq!(told(&mut flight, setting), [low]);
    assert_eq!(flight.mode(), Mode::Takeoff);
    flight.fly_until(60.0, |flight| flight.truth.get().altitude_m > 120.0 + 65.0);
    assert!(flight.truth.impact().is_none());
    assert!(told(&mut flight, setting).is_empty());
    // On final, 27 m too low: it flared that much too high.
    let is_low = |flight: &Flight| {
        flight.mode() == Mode::Land && flight.truth.get().altitude_m < 120.0 + 40.0
    };
    flight.fly_until(900.0, is_low);
    let setting = AutopilotCommand::AltimeterSetting(101_000.0);
    assert_eq!(told(&mut flight, setting), [low]);
}

/// The true setting is 1013.25 hPa; 8.3 m a hectopascal. Set to 1060 in cruise, or to 1031
/// before the roll, the circuit led into the ground though the receiver showed it.
#[test]
fn the_setting_of_another_place_is_refused_where_a_receiver_shows_the_altitude() {
    let circuit = include_str!("../../../../../config/plans/circuit.waypoints");
    let mut flight = engaged(circuit, "[built-in]\n");
    let off = "not carried out: the altimeter would be further off the satellite receiver's \
               altitude, by more than cold air explains: is it the setting of this place?";
    let set = |hpa: f64| AutopilotCommand::AltimeterSetting(hpa * 100.0);
    assert_eq!(told(&mut flight, set(1_031.0)), [off]);
    assert!(told(&mut flight, set(1_014.0)).is_empty());
    flight.fly_until(300.0, |flight| {
        flight.truth.get().altitude_m > 120.0 + 250.0
    });
    for hpa in [1_060.0, 1_031.0, 995.0] {
        assert_eq!(told(&mut flight, set(hpa)), [off], "{hpa}");
    }
    // As far off as in air that is 20 K colder than the standard, and back.
    assert!(told(&mut flight, set(1_016.0)).is_empty());
    assert!(told(&mut flight, set(1_013.25)).is_empty());
}

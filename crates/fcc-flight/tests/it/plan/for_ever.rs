//! A jump for ever, as the missions of `ArduPlane` end, with a landing sequence behind it.

use std::fmt::Write as _;

use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;

use crate::plan::flight::{Flight, HOME};

/// Take-off to the north, a triangle that is flown for ever, and a landing from the south.
fn triangle() -> String {
    let mut text = String::from("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 120 1\n");
    for (n, (command, first, course_deg, away_m, above_m)) in [
        (22, 8.0, 0.0, 3_000.0, 150.0),
        (16, 0.0, 0.0, 6_000.0, 250.0),
        (16, 0.0, 50.0, 8_500.0, 300.0),
        (16, 0.0, 75.0, 6_500.0, 300.0),
        (177, 2.0, 0.0, 0.0, 0.0),
        (189, 0.0, 180.0, 8_000.0, 250.0),
        (16, 0.0, 180.0, 8_000.0, 300.0),
        (16, 0.0, 180.0, 6_000.0, 250.0),
        (21, 200.0, 0.0, 300.0, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let at = HOME.ahead(course_deg, away_m);
        let (latitude, longitude) = (at.latitude_deg, at.longitude_deg);
        let second = if command == 177 { -1 } else { 0 };
        writeln!(
            text,
            "{} 0 3 {command} {first} {second} 0 0 {latitude:.9} {longitude:.9} {above_m} 1",
            n + 1
        )
        .unwrap();
    }
    text
}

/// Three rounds of it, and the command leads to the landing behind the jump.
#[test]
fn it_is_flown_until_a_command_leads_to_the_landing_behind_it() {
    let mut flight = Flight::new(&triangle(), "[built-in]\nwind_kt = 8\n");
    let rounds = |flight: &Flight| {
        let reached = |event: &&String| event.starts_with("item 4 of the plan is reached");
        flight.events.iter().filter(reached).count()
    };
    flight.fly_until(2_400.0, |flight| rounds(flight) == 3);
    flight.fly_until(120.0, |flight| flight.record.setpoints.guidance.item == 2);
    assert_eq!(flight.mode(), Mode::Plan);
    assert!(!flight.happened("item 7 of the plan is reached"));
    flight.command(AutopilotCommand::Land);
    flight.fly_until(1_800.0, |flight| {
        flight.happened("item 9 of the plan is reached")
    });
    assert_eq!(rounds(&flight), 3);
    assert_eq!(flight.mode(), Mode::Land);
    assert!(flight.truth.impact().is_none());
    assert!(
        flight.truth.get().east_m.abs() < 5.0,
        "{:?}",
        flight.truth.get()
    );
}

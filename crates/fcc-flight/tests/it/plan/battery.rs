//! The battery: a low one prevents a take-off, and ends a flight with a landing or at home.

use std::fmt::Write as _;

use fcc_core::framework::{Reading, State};
use fcc_fixed_wing::{AutopilotCommand, Contingency};
use fcc_guidance::Mode;

use crate::plan::contingency::{fenced, go_to};
use crate::plan::flight::{Flight, HOME, Without, legs};

/// Ticks of a second.
const RATE: u64 = 40;

/// What the built-in aircraft takes, A.
const LOAD_A: f64 = 15.0;

/// A flight whose alternator does not feed, with a battery of which this share is used in
/// each second. The keys end with those of `[built-in]`.
fn draining(plan: &str, keys: &str, per_s: f64) -> Flight {
    let capacity_ah = LOAD_A / (3_600.0 * per_s);
    let keys = format!("{keys}alternator_stops_at_s = 0\nbattery_capacity_ah = {capacity_ah}\n");
    Flight::new(plan, &keys)
}

/// Take-off to the north, 25 km there, and a landing sequence from 6 km in the south.
pub(crate) fn there_and_back() -> String {
    let mut text = String::from("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 120 1\n");
    for (number, (command, first, north_m, above_m)) in [
        (22, 8.0, 3_000.0, 150.0),
        (16, 0.0, 5_000.0, 250.0),
        (16, 0.0, 25_000.0, 300.0),
        (189, 0.0, -8_000.0, 250.0),
        (16, 0.0, -8_000.0, 300.0),
        (16, 0.0, -6_000.0, 250.0),
        (21, 200.0, 300.0, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let course_deg = if north_m < 0.0 { 180.0 } else { 0.0 };
        let at = HOME.ahead(course_deg, f64::abs(north_m));
        let number = number + 1;
        let (latitude, longitude) = (at.latitude_deg, at.longitude_deg);
        writeln!(
            text,
            "{number} 0 3 {command} {first} 0 0 0 {latitude:.9} {longitude:.9} {above_m} 1"
        )
        .unwrap();
    }
    text
}

/// 70 % are left after 300 s; 10 s later it flies the landing sequence, from far away in
/// the north, and stands where the plan lands.
#[test]
fn with_a_low_battery_it_lands_before_the_plan_does() {
    let keys = "[contingency]\nbattery_low = \"land\"\nbattery_charge_percent = 70\n\
                battery_low_after_s = 10\n[built-in]\nnoise = false\n";
    let mut flight = draining(&there_and_back(), keys, 0.001);
    let told = "the battery is low: landing";
    flight.fly_until(320.0, |flight| flight.happened(told));
    let at_s = flight.record.tick.number as f64 / RATE as f64;
    assert!((310.0..310.2).contains(&at_s), "{at_s}");
    assert_eq!(flight.record.setpoints.contingency, Contingency::BatteryLow);
    assert!(!flight.happened("item 3 of the plan is reached"));
    assert!(flight.distance_m(HOME) > 8_000.0, "far away");
    flight.fly_until(1_200.0, |flight| {
        flight.happened("item 7 of the plan is reached")
    });
    assert!(flight.happened("item 6 of the plan is reached"));
    // It aims 300 m behind home, and needs less than 800 m.
    let truth = flight.truth.get();
    assert!(flight.truth.impact().is_none());
    assert!((150.0..1_400.0).contains(&truth.north_m), "{truth:?}");
    assert!(truth.east_m.abs() < 5.0, "{truth:?}");
    assert!(truth.velocity.north_mps.abs() < 0.5, "{truth:?}");
    assert_eq!(flight.mode(), Mode::Land);
}

/// Low, or limited and not measured.
#[test]
fn nothing_takes_off_with_a_low_battery() {
    let keys = |limit: &str| format!("[contingency]\n{limit}\n[built-in]\nnoise = false\n");
    for (limit, per_s, engages) in [
        ("battery_charge_percent = 100", Some(0.000_005), false),
        ("battery_voltage_v = 25.4", Some(0.000_005), false),
        ("battery_charge_percent = 25", None, false),
        ("battery_charge_percent = 25", Some(0.000_005), true),
        ("", None, true),
    ] {
        let (plan, keys) = (there_and_back(), keys(limit));
        let mut flight = match per_s {
            Some(per_s) => draining(&plan, &keys, per_s),
            None => Flight::with(&plan, &keys, |sensor| {
                Box::new(Without(sensor, |into| into.battery = Reading::default()))
            }),
        };
        for _ in 0..30 * RATE {
            flight.tick();
        }
        let state = flight.record.state.state();
        assert_eq!(state == State::Engaged, engages, "{limit}: {state}");
        let why = "the battery is low, or what limits it in [contingency] is not measured";
        let is_told = flight.events.iter().any(|event| event.contains(why));
        assert_eq!(is_told, !engages, "{limit}: {:#?}", flight.events);
    }
}

/// The battery is worse than a lost commander. Seven eighths of its charge are left after
/// 25 s: 12 cells of 2.10 V, less 0.3 V at the load.
#[test]
fn the_worst_acts_and_a_command_ends_it() {
    let keys = "[contingency]\ncommander_lost = \"loiter\"\nbattery_voltage_v = 24.9\n\
                battery_low_after_s = 5\n[built-in]\n";
    let plan = legs(&[0.0, 60.0], 20_000.0, 0.0);
    let mut flight = draining(&plan, keys, 0.005);
    flight.fly_until(20.0, |flight| flight.record.state.state() == State::Engaged);
    flight.command(AutopilotCommand::Heartbeat(2.0));
    let lost = "command link lost, no heartbeat in time: circling";
    flight.fly_until(10.0, |flight| flight.happened(lost));
    let low = "the battery is low: returning";
    flight.fly_until(60.0, |flight| flight.happened(low));
    let at_s = flight.record.tick.number as f64 / RATE as f64;
    assert!((30.0..30.2).contains(&at_s), "{at_s}");
    assert_eq!(flight.mode(), Mode::Return);
    // A lesser one does not act.
    flight.command(AutopilotCommand::Heartbeat(1.0));
    for _ in 0..5 * RATE {
        flight.tick();
    }
    assert_eq!(flight.mode(), Mode::Return);
    assert_eq!(flight.record.setpoints.contingency, Contingency::BatteryLow);
    flight.command(AutopilotCommand::Heartbeat(0.0));
    flight.command(AutopilotCommand::Plan(0));
    for _ in 0..60 * RATE {
        flight.tick();
    }
    assert_eq!(flight.mode(), Mode::Plan);
    assert_eq!(flight.record.setpoints.contingency, Contingency::None);
}

/// Commanded against the fence with a low battery it turns away, and then the battery acts
/// again.
#[test]
fn the_fence_comes_before_the_battery() {
    let keys = "[contingency]\nbattery_charge_percent = 90\nbattery_low_after_s = 1\n\
                battery_low = \"land\"\n[built-in]\nwind_kt = 20\n";
    let mut flight = draining(&fenced(&[], 4_000.0), keys, 0.005);
    // There is no landing in the plan.
    flight.fly_until(30.0, |flight| {
        flight.happened("the battery is low: returning")
    });
    flight.command(go_to(HOME.ahead(180.0, 20_000.0)));
    let mut farthest_m = 0.0_f64;
    flight.fly_until(400.0, |flight| {
        farthest_m = farthest_m.max(flight.distance_m(HOME));
        flight.record.setpoints.contingency == Contingency::Fence
    });
    flight.fly_until(600.0, |flight| {
        farthest_m = farthest_m.max(flight.distance_m(HOME));
        flight.record.setpoints.contingency == Contingency::BatteryLow
            && (flight.distance_m(HOME) - 800.0).abs() < 30.0
    });
    assert!(farthest_m < 4_000.0, "{farthest_m}");
    assert_eq!(flight.mode(), Mode::Return);
}

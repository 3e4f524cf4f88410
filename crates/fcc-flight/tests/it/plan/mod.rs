//! The built-in aircraft flies plans in wind, in lockstep, scored from its truth by
//! geodesics; without a call of the allocator.

mod back;
mod battery;
mod contingency;
mod drawn_fences;
mod failing_parts;
mod flight;
mod for_ever;
mod glide;
mod lost_low;
mod range_jumps;
mod re_engaged;
mod refused;
mod repeated_place;
mod replacing;
mod terrain;
mod terrain_ahead;

use fcc_conformance::allocator_calls;
use fcc_core::flight::Position;
use fcc_core::framework::State;
use fcc_fixed_wing::AutopilotCommand;
use fcc_guidance::Mode;
use fcc_runtime::Message;
use fcc_telemetry::FlightRecord;

use flight::{ALTITUDE_M, Flight, HOME, legs, line, place_of};

/// How far the aircraft is off the geodesic to an item from the one before, m.
fn cross_track_m(flight: &Flight, number: usize) -> f64 {
    let (from, to) = (
        place_of(&flight.plan, number - 1),
        place_of(&flight.plan, number),
    );
    let (_, back_deg, _) = to.to(from);
    let (away_m, here_deg, _) = to.to(flight.place());
    away_m * (here_deg - back_deg).to_radians().sin()
}

/// Issue: on legs at most 5 m RMS in calm air, and 10 m in 20 kt from any side, with
/// turns of 30° to 150°; from the end of a turn, where the path has the course of the
/// leg, to the begin of the next.
#[test]
fn legs_are_flown_in_wind() {
    let plan = legs(&[10.0, 40.0, 310.0, 70.0, 220.0], 4_000.0, 0.0);
    for (wind_from_deg, wind_kt, most_m) in
        [(0.0, 0.0, 5.0), (120.0, 20.0, 10.0), (270.0, 20.0, 10.0)]
    {
        let keys = format!("[built-in]\nwind_from_deg = {wind_from_deg}\nwind_kt = {wind_kt}\n");
        let mut flight = Flight::new(&plan, &keys);
        let mut squares = [(0.0, 0.0); 5];
        let mut worst_ft = 0.0_f64;
        flight.fly_until(700.0, |flight| {
            let setpoints = &flight.record.setpoints;
            let item = setpoints.guidance.item as usize;
            if flight.record.state.state() == State::Engaged && item >= 2 {
                let (from, to) = (
                    place_of(&flight.plan, item - 1),
                    place_of(&flight.plan, item),
                );
                let (_, _, course_deg) = from.to(to);
                let off_rad = setpoints.course_rad - course_deg.to_radians();
                if off_rad.sin().abs() < 0.01 && off_rad.cos() > 0.0 {
                    let off_m = cross_track_m(flight, item);
                    let sum = &mut squares[item - 1];
                    *sum = (sum.0 + off_m * off_m, sum.1 + 1.0);
                    let low_m = flight.truth.get().altitude_m - ALTITUDE_M;
                    worst_ft = worst_ft.max(low_m.abs() / 0.304_8);
                }
            }
            flight.happened("item 5 of the plan is reached")
        });
        for number in 1..=5 {
            assert!(flight.happened(&format!("item {number} of the plan is reached")));
        }
        let rms: Vec<f64> = squares[1..]
            .iter()
            .map(|(sum, count): &(f64, f64)| (sum / count).sqrt())
            .collect();
        println!("{wind_kt} kt from {wind_from_deg}: {rms:.2?} m, {worst_ft:.1} ft");
        assert!(
            rms.iter().all(|rms| *rms <= most_m),
            "{wind_from_deg}: {rms:?}"
        );
        assert!(worst_ft < 15.0, "{worst_ft}");
    }
}

/// The first item of a plan is flown to from wherever the aircraft is: in the 78 s of 4 km at
/// 100 kt it climbs by 382 m at its envelope's 965 ft/min, and slower than 100 kt by a little
/// more.
#[test]
fn an_item_that_is_missed_in_altitude_says_so() {
    let high = ALTITUDE_M + 1_000.0;
    let there = line(1, 16, [0.0; 4], HOME.ahead(10.0, 4_000.0))
        .replace(&format!(" {ALTITUDE_M} "), &format!(" {high} "));
    let plan = format!("QGC WPL 110\n{}{there}", line(0, 16, [0.0; 4], HOME));
    let mut flight = Flight::new(&plan, "wind_kt = 0\n[built-in]\n");
    let reached = "item 1 of the plan is reached, ";
    flight.fly_until(200.0, |flight| {
        flight.events.iter().any(|event| event.starts_with(reached))
    });
    let low_m = high - flight.truth.get().altitude_m;
    assert!(low_m > 500.0, "{low_m}");
    let said = flight
        .events
        .iter()
        .find_map(|event| event.strip_prefix(reached)?.split(' ').next());
    let said: f64 = said.unwrap().parse().unwrap();
    assert!((said - low_m).abs() < 10.0, "{said}, {low_m}");
}

/// Issue: circles within 5 % of their radius in 15 kt with at most 30° of bank, at
/// 100 kt; left towards the next place after as many turns as are given.
#[test]
fn circles_are_flown_in_wind() {
    let centre = HOME.ahead(0.0, 4_000.0);
    let mut plan = format!("QGC WPL 110\n{}", line(0, 16, [0.0; 4], HOME));
    plan += &line(1, 18, [1.5, 1.0, 750.0, 0.0], centre);
    plan += &line(
        2,
        18,
        [1.0, 1.0, -1_000.0, 0.0],
        centre.ahead(60.0, 5_000.0),
    );
    plan += &line(3, 16, [0.0; 4], centre.ahead(60.0, 9_000.0));
    let keys = "wind_kt = 15\n[built-in]\nwind_from_deg = 250\nwind_kt = 15\n";
    let mut flight = Flight::new(&plan, keys);
    let mut worst = [0.0_f64; 2];
    let mut on_circle_s = [0.0_f64; 2];
    let mut bank_deg = 0.0_f64;
    flight.fly_until(900.0, |flight| {
        let item = flight.record.setpoints.guidance.item as usize;
        let circle = [(1, 750.0), (2, 1_000.0)]
            .into_iter()
            .find(|(n, _)| *n == item);
        if let Some((item, radius_m)) = circle {
            let off_m = flight.distance_m(place_of(&flight.plan, item)) - radius_m;
            if off_m.abs() < 0.2 * radius_m {
                on_circle_s[item - 1] += 0.025;
                if on_circle_s[item - 1] > 15.0 {
                    worst[item - 1] = worst[item - 1].max(off_m.abs() / radius_m);
                    bank_deg = bank_deg.max(flight.truth.get().roll_rad.to_degrees().abs());
                }
            }
        }
        flight.happened("item 3 of the plan is reached")
    });
    println!("circles: {worst:.4?}, on them {on_circle_s:.0?} s, bank {bank_deg:.1}°");
    assert!(worst.iter().all(|share| *share < 0.05), "{worst:?}");
    assert!(bank_deg < 30.5, "{bank_deg}");
    // A turn of 750 m takes 2π · 750 / 51.4 = 92 s in calm air, and is not shorter in wind.
    assert!(
        on_circle_s[0] > 1.5 * 91.0 && on_circle_s[0] < 2.6 * 95.0,
        "{on_circle_s:?}"
    );
}

/// Pause, resume, another item, a place, home: the mode of each, and that the plan goes
/// on where it was left.
#[test]
fn a_flight_is_commanded_in_the_air() {
    let plan = legs(&[0.0, 60.0, 120.0], 6_000.0, 0.0);
    let mut flight = Flight::new(&plan, "[built-in]\n");
    flight.fly_until(300.0, |flight| {
        flight.happened("item 1 of the plan is reached")
    });
    flight.fly_until(20.0, |flight| flight.record.setpoints.guidance.item == 2);
    flight.command(AutopilotCommand::Pause);
    flight.fly_until(1.0, |flight| flight.mode() == Mode::Loiter);
    let paused = flight.place();
    for _ in 0..8_000 {
        flight.tick();
        assert!(
            flight.distance_m(paused) < 2_000.0,
            "it circles where it was"
        );
    }
    flight.command(AutopilotCommand::Plan(0));
    flight.fly_until(1.0, |flight| flight.mode() == Mode::Plan);
    assert_eq!(flight.record.setpoints.guidance.item, 2);
    flight.command(AutopilotCommand::Plan(3));
    flight.fly_until(1.0, |flight| flight.record.setpoints.guidance.item == 3);
    let aside = HOME.ahead(270.0, 3_000.0);
    flight.command(AutopilotCommand::GoTo(Position {
        latitude_rad: aside.latitude_deg.to_radians(),
        longitude_rad: aside.longitude_deg.to_radians(),
        altitude_m: ALTITUDE_M + 60.0,
    }));
    flight.fly_until(1.0, |flight| flight.mode() == Mode::GoTo);
    flight.fly_until(400.0, |flight| {
        (flight.distance_m(aside) - 800.0).abs() < 30.0
            && (flight.truth.get().altitude_m - ALTITUDE_M - 60.0).abs() < 5.0
    });
    flight.command(AutopilotCommand::ReturnHome);
    flight.fly_until(1.0, |flight| flight.mode() == Mode::Return);
    flight.fly_until(400.0, |flight| {
        (flight.distance_m(HOME) - 800.0).abs() < 30.0
    });
    assert!(flight.machine.state() == State::Engaged);
}

/// With ideal sensors and with navigation by raw readings.
#[test]
fn a_plan_is_flown_without_the_allocator() {
    let plan = legs(&[0.0, 60.0, 200.0], 2_500.0, 0.0);
    for navigation in ["measured", "kalman"] {
        let raw = if navigation == "measured" {
            "none"
        } else {
            "board"
        };
        let keys = format!(
            "wind_kt = 10\n[built-in]\nraw_sensors = \"{raw}\"\n[navigation]\nmethod = \
             \"{navigation}\"\n"
        );
        let mut flight = Flight::warmed_up(&plan, &keys, |sensor| sensor);
        let mut last = FlightRecord::default();
        let ((), calls) = allocator_calls(|| {
            for _ in 0..8_000 {
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
        assert_eq!(last.setpoints.guidance.item, 3, "{navigation}");
    }
}

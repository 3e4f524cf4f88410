//! An X-Plane that is paused, slowed, killed and restarted: its states, and its
//! subscriptions.

use std::time::Duration;

use crate::support::bench::Bench;
use crate::support::{FLIGHT_TIME, P, PAUSED, SWITCH, free_port};
use fcc_core::flight::PlantState;
use fcc_core::framework::SensorFault;
use fcc_xplane::{DataRows, Input, Missing, RowsVersion, SimulatorState};

#[test]
fn requests_are_spread_over_ticks() {
    let mut bench = Bench::new();
    let mut before = 0;
    for _ in 0..10 {
        let _ = bench.sample();
        bench.simulator.listen();
        assert!(bench.simulator.requests - before <= 8);
        before = bench.simulator.requests;
    }
    assert_eq!(before, bench.simulator.subscribed.len() + 1);
}

#[test]
fn a_request_that_got_lost_is_sent_again_after_a_second() {
    let mut bench = Bench::new();
    bench.settle();
    bench.simulator.listen();
    let theta = format!("{P}theta");
    bench.simulator.subscribed.retain(|_, path| *path != theta);
    // It arrived until now, so five seconds pass first.
    for _ in 0..201 {
        bench.watch().unwrap();
    }
    bench.simulator.listen();
    assert!(
        bench
            .simulator
            .subscribed
            .values()
            .any(|path| *path == theta)
    );
}

#[test]
fn a_first_request_that_got_lost_delays_a_second_not_five() {
    let mut bench = Bench::new();
    // Every request of the first tick is lost.
    let _ = bench.sample();
    bench.simulator.listen();
    bench.simulator.subscribed.clear();
    for _ in 0..45 {
        let _ = bench.watch();
    }
    assert!(!bench.measurements.attitude.is_never());
    assert!(!bench.measurements.plant.is_never());
}

#[test]
fn a_dataref_that_x_plane_does_not_have_is_named_with_its_key() {
    let mistyped = "sim/cockpit2/switches/generic_light_switch[0]";
    let mut bench = Bench::with(|config| config.engage_switch = mistyped.into());
    for _ in 0..120 {
        let _ = bench.watch();
        assert_eq!(bench.status.missing(), []);
    }
    // Within six seconds of the first contact.
    for _ in 0..120 {
        bench.watch().unwrap();
    }
    let missing = bench.status.missing();
    assert_eq!(missing, [Missing::EngageSwitch(mistyped.into())]);
    let message = missing[0].to_string();
    assert!(message.contains("x-plane.engage_switch"), "{message}");
    assert!(message.contains(mistyped), "{message}");
    // The rest arrives, and so does the switch once a plugin provides it.
    assert_eq!(bench.status.trouble(), None);
    bench.simulator.set(mistyped, 0.0);
    for _ in 0..41 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.status.missing(), []);
}

/// Whether it has the switch is not known then; a generic light is known.
#[test]
fn a_version_that_answers_for_every_dataref_is_recognised() {
    let other = "sim/a/switch";
    for (switch, is_certain) in [(other, false), (SWITCH, true)] {
        let mut bench = Bench::with(|config| config.engage_switch = switch.into());
        for _ in 0..40 {
            let _ = bench.watch();
            for path in bench.simulator.subscribed.values() {
                bench.simulator.values.entry(path.clone()).or_insert(0.0);
            }
        }
        let maybe = Missing::MaybeEngageSwitch(switch.into());
        assert_eq!(bench.status.missing().contains(&maybe), !is_certain);
    }
    // One that answers only for what it has.
    let mut bench = Bench::with(|config| config.engage_switch = other.into());
    bench.simulator.set(other, 0.0);
    for _ in 0..40 {
        let _ = bench.watch();
    }
    assert_eq!(bench.status.missing(), []);
}

#[test]
fn rows_that_are_not_switched_on_are_named() {
    let free = free_port();
    let mut bench = Bench::with(|config| {
        config.local_port = free;
        config.input = Input::Data(DataRows::of(RowsVersion::XPlane12));
    });
    // The switch and the overrides come by RREF; no row does.
    for _ in 0..240 {
        let _ = bench.watch();
    }
    let mut rows = bench.status.missing();
    rows.sort_by_key(|missing| match missing {
        Missing::Row(row) => *row,
        other => panic!("{other}"),
    });
    assert_eq!(rows, [1, 3, 4, 16, 17, 18, 20, 21].map(Missing::Row));
}

#[test]
fn silence_is_a_fault_and_ends_with_a_new_subscription() {
    let mut bench = Bench::new();
    bench.settle();
    // Killed: it counts as silent after half a second.
    let faults: Vec<_> = (0..40).map(|_| bench.sample().err()).collect();
    let first = faults.iter().position(Option::is_some);
    assert_eq!(first, Some(20));
    assert_eq!(faults[20], Some(SensorFault::Silent));
    assert_eq!(bench.status.state(), SimulatorState::Silent);
    let message = bench.status.trouble().unwrap().to_string();
    assert!(message.contains("does not answer"));
    let last = bench.measurements.attitude.taken;

    // Restarted, with another flight, while requests were being sent: those that
    // were lost are requested again at once, and not after a second.
    bench.simulator.listen();
    bench.simulator.restart();
    bench.simulator.requests = 0;
    bench.simulator.set(FLIGHT_TIME, 0.0);
    let mut jumped = false;
    for _ in 0..20 {
        let _ = bench.watch();
        jumped |= bench.status.state() == SimulatorState::Jumped;
    }
    assert!(jumped, "the clock of the new flight starts from 0");
    let m = &bench.measurements;
    for taken in [m.attitude.taken, m.airspeed_mps.taken, m.plant.taken] {
        assert!(taken > last + Duration::from_secs(1));
    }
    assert_eq!(bench.status.state(), SimulatorState::Running);
}

#[test]
fn a_simulator_that_never_answers_gets_requests_each_second() {
    let mut bench = Bench::new();
    let mut asked = Vec::new();
    for second in 0..21 {
        for _ in 0..40 {
            let _ = bench.sample();
        }
        bench.simulator.listen();
        if core::mem::take(&mut bench.simulator.requests) > 0 {
            asked.push(second);
        }
    }
    assert!(asked.into_iter().eq(0..21));
}

#[test]
fn a_pause_is_a_state_and_readings_stay_fresh() {
    let mut bench = Bench::new();
    bench.settle();
    bench.simulator.set(PAUSED, 1.0);
    for _ in 0..400 {
        bench.simulator.live(0.0);
        bench.sample().unwrap();
        assert_eq!(bench.measurements.plant.value.state, PlantState::Paused);
    }
    assert_eq!(bench.measurements.attitude.taken, bench.ticks.now);
    bench.simulator.set(PAUSED, 0.0);
    bench.watch().unwrap();
    assert_eq!(bench.measurements.plant.value.state, PlantState::Running);
}

#[test]
fn a_jump_is_an_event_of_one_tick() {
    let mut bench = Bench::new();
    bench.settle();
    bench.simulator.set(FLIGHT_TIME, 0.5);
    // The first datagram may be one that was overtaken.
    bench.watch().unwrap();
    assert_eq!(bench.measurements.plant.value.state, PlantState::Running);
    bench.watch().unwrap();
    assert_eq!(bench.measurements.plant.value.state, PlantState::Jumped);
    bench.watch().unwrap();
    assert_eq!(bench.measurements.plant.value.state, PlantState::Running);
    assert_eq!(bench.status.counts().jumps, 1);
}

#[test]
fn a_stalled_and_a_slow_clock_are_separate_states() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..20 {
        bench.simulator.live(0.0);
        bench.sample().unwrap();
    }
    assert_eq!(bench.measurements.plant.value.state, PlantState::Stalled);
    for _ in 0..120 {
        bench.simulator.live(0.015);
        bench.sample().unwrap();
    }
    assert_eq!(bench.measurements.plant.value.state, PlantState::Slow);
}

#[test]
fn dropping_the_sensor_ends_the_subscriptions() {
    let mut bench = Bench::new();
    bench.settle();
    assert!(!bench.simulator.subscribed.is_empty());
    drop(bench.sensor);
    bench.simulator.listen();
    assert!(bench.simulator.subscribed.is_empty());
    assert_eq!(bench.simulator.position_hz.as_deref(), Some("0"));
}

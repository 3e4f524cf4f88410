//! A warm-up has no effect: a flight with one before each tick is to the last
//! bit the flight without.

use std::time::Duration;

use fcc_core::framework::State;
use fcc_flight::config::{BuiltInSection, Config, GustsChoice};
use fcc_flight::flight::assemble;
use fcc_runtime::{Machine, Parts};
use fcc_timer::ManualTimer;

/// 75 s: standby, engaged, three legs of the pattern in gusts.
const TICKS: usize = 3_000;

/// State and record after each tick, as text, which distinguishes every bit of a
/// float.
fn fly(timer: ManualTimer) -> Vec<(State, String)> {
    let config = Config {
        built_in: Some(BuiltInSection {
            gusts: GustsChoice::Moderate,
            ..BuiltInSection::default()
        }),
        ..Config::default()
    };
    let assembly = assemble(&config).unwrap();
    let parts = Parts {
        timer: Box::new(timer),
        sensors: assembly.sensors,
        controller: *assembly.autopilot,
        actuators: assembly.actuators,
    };
    let (mut machine, _link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();
    (0..TICKS)
        .map(|_| {
            let state = machine.step();
            (state, format!("{:?}", machine.record()))
        })
        .collect()
}

#[test]
fn a_flight_with_warm_up_is_the_same_flight() {
    let timer = ManualTimer::new(Duration::from_millis(25)).unwrap();
    let plain = fly(timer.clone());
    let warmed_up = fly(timer.with_warm_up());
    assert!(plain.iter().any(|(state, ..)| *state == State::Engaged));
    for (tick, (plain, warmed_up)) in plain.iter().zip(&warmed_up).enumerate() {
        assert_eq!(plain, warmed_up, "tick {tick}");
    }
}

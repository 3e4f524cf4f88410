//! Ten thousand ticks of the whole thing - aircraft, navigation, guidance,
//! control, actuators, record, and a warm-up before each - do not touch the
//! allocator.
#![cfg(test)]

use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::framework::State;
use fcc_flight::config::{BuiltInSection, Config, GustsChoice};
use fcc_flight::flight::assemble;
use fcc_runtime::{Machine, Message, Parts};
use fcc_timer::ManualTimer;

#[test]
fn ten_thousand_ticks_of_a_flight_do_not_allocate() {
    let config = Config {
        built_in: Some(BuiltInSection {
            gusts: GustsChoice::Moderate,
            delay_ms: 25,
            ..BuiltInSection::default()
        }),
        ..Config::default()
    };
    let assembly = assemble(&config).unwrap();
    let parts = Parts {
        timer: Box::new(
            ManualTimer::new(Duration::from_millis(25))
                .unwrap()
                .with_warm_up(),
        ),
        sensors: assembly.sensors,
        controller: assembly.autopilot,
        actuators: assembly.actuators,
    };
    let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();

    let (mut engaged, mut records) = (0, 0);
    let ((), calls) = allocator_calls(|| {
        for _ in 0..10_000 {
            if machine.step() == State::Engaged {
                engaged += 1;
            }
            while let Some(message) = link.messages.receive() {
                records += u32::from(matches!(message, Message::Tick(_)));
            }
        }
    });
    assert_eq!(calls, 0);

    // It was a flight: 2 s of standby, and engaged to the end.
    assert_eq!(records, 10_000);
    assert!((9_900..=9_920).contains(&engaged), "{engaged}");
}

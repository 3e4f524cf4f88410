//! Nothing in a tick allocates: plant, controller, motors.
//!
//! A process of its own: what another test initialises first would not allocate here.

use fcc_conformance::allocator_calls;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Actuator, Controller, Sensor, Tick, Time};
use fcc_multicopter::{Command, Item, Mode, Multicopter, MulticopterConfig};
use fcc_sim::{MultirotorConfig, MultirotorSimulation};

static PLAN: [Item; 3] = [
    Item::TakeOff(3.0),
    Item::Circle {
        radius_m: 2.0,
        turns: 1.0,
    },
    Item::Land,
];

#[test]
fn a_flight_does_not_allocate() {
    let mut simulation = MultirotorSimulation::new(&MultirotorConfig::default()).unwrap();
    let mut multicopter = Multicopter::new(&MulticopterConfig {
        plan: &PLAN,
        ..MulticopterConfig::default()
    })
    .unwrap();
    let mut measured = Measurements::default();
    let mut modes = [false; 9];
    let ((), calls) = allocator_calls(|| {
        for number in 1..16_000_u64 {
            let tick = Tick {
                number,
                woke: Time::from_nanos(number as i64 * 2_500_000),
                dt_s: 0.002_5,
                ..Tick::default()
            };
            simulation.sensor.sample(&tick, &mut measured).unwrap();
            multicopter.estimate(&tick, &measured);
            if number == 1_600 {
                multicopter.engage(&tick, &measured);
            } else if number == 14_000 {
                multicopter.command(&Command::Land);
            }
            if number >= 1_600 {
                let motors = multicopter.control(&tick, &measured);
                assert!(multicopter.outputs_are_valid(&motors));
                simulation.actuator.apply(&tick, &motors).unwrap();
                modes[multicopter.setpoints().mode as usize] = true;
            }
        }
    });
    assert_eq!(calls, 0);
    for mode in [Mode::TakeOff, Mode::Circle, Mode::Land, Mode::Idle] {
        assert!(modes[mode as usize], "{mode:?}");
    }
}

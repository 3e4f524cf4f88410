//! What is written to a minimal X-Plane comes back late, or not at all.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::support::bench::{Bench, SURFACES};
use crate::support::{FLIGHT_TIME, OVERRIDE_JOYSTICK, YOKE_PITCH};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ControlAuthority, Sensor};
use fcc_xplane::XPlaneAuthority;

/// Flies a tick in which the elevator is read back that was written some ticks ago.
fn fly_late(bench: &mut Bench, on_its_way: &mut VecDeque<f32>) {
    bench.simulator.listen();
    let time_s = bench.simulator.value(FLIGHT_TIME) + 0.025;
    bench.simulator.set(FLIGHT_TIME, time_s);
    let shown = on_its_way.pop_front().unwrap();
    bench.simulator.set(YOKE_PITCH, shown);
    let frame = bench.simulator.frame();
    bench.simulator.send(&frame);
    let outputs = Surfaces {
        elevator: 0.2 * f64::from(time_s).sin(),
        ..SURFACES
    };
    on_its_way.push_back(outputs.elevator as f32);
    let tick = bench.ticks.next();
    bench.sensor.sample(&tick, &mut bench.measurements).unwrap();
    let _ = bench.actuator.as_mut().unwrap().apply(&tick, &outputs);
}

/// In real time, since it is said by the clock: after three seconds in which the yoke
/// is read back 0.4 s late.
#[test]
fn controls_that_are_read_back_late_are_said_once() {
    let mut bench = Bench::new();
    bench.settle();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    let mut on_its_way = VecDeque::from([0.0; 16]);
    let mut said = Vec::new();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(6) {
        std::thread::sleep(Duration::from_millis(10));
        fly_late(&mut bench, &mut on_its_way);
        assert!(!bench.measurements.other_control.value.writer);
        authority.report(&mut |text| {
            let text = text.to_string();
            said.extend(
                text.contains("is read back after")
                    .then_some((begun.elapsed(), text)),
            );
        });
    }
    let [(at, text)] = &said[..] else {
        panic!("once: {said:?}")
    };
    assert!(*at >= Duration::from_secs(3), "{at:?}");
    assert!(text.contains("is read back after 0.4 s"), "{text}");
    assert!(text.contains("Connect both machines by a cable"), "{text}");
}

/// A network whose delay grows slowly looks like an X-Plane that computes slowly: only the
/// round trip tells it, from 0.5 s on.
#[test]
fn what_is_read_is_too_old_while_the_controls_come_back_too_late() {
    for (late_ticks, is_too_old) in [(16, false), (32, true)] {
        let mut bench = Bench::new();
        bench.settle();
        let mut on_its_way = VecDeque::from(vec![0.0; late_ticks]);
        for _ in 0..240 {
            fly_late(&mut bench, &mut on_its_way);
        }
        let age = bench
            .ticks
            .next()
            .woke
            .since(bench.measurements.attitude.taken);
        assert_eq!(age > Duration::from_millis(500), is_too_old, "{age:?}");
    }
}

/// Switched on over a network that delays: nothing that was written has come back yet.
#[test]
fn the_first_outputs_are_held_once_the_overrides_are_awaited_for_too_long() {
    let mut bench = Bench::new();
    bench.settle();
    let mut fly_unheard = |ticks: u32, elevator: f64| {
        for _ in 0..ticks {
            let time_s = bench.simulator.value(FLIGHT_TIME) + 0.025;
            bench.simulator.set(FLIGHT_TIME, time_s);
            let frame = bench.simulator.frame();
            bench.simulator.send(&frame);
            let tick = bench.ticks.next();
            bench.sensor.sample(&tick, &mut bench.measurements).unwrap();
            let outputs = Surfaces {
                elevator,
                ..SURFACES
            };
            let _ = bench.actuator.as_mut().unwrap().apply(&tick, &outputs);
        }
    };
    fly_unheard(1, 0.1);
    fly_unheard(18, 0.5);
    fly_unheard(8, 0.7);
    bench.simulator.listen();
    bench.simulator.assert_shows(YOKE_PITCH, 0.1);
    assert!(
        bench
            .simulator
            .writes
            .iter()
            .any(|(path, value)| { path == YOKE_PITCH && (value - 0.5).abs() < 1e-6 })
    );
}

#[test]
fn first_overrides_that_got_lost_are_set_again_at_once() {
    let mut bench = Bench::new();
    bench.settle();
    bench.fly().unwrap();
    bench.simulator.listen();
    bench.simulator.set(OVERRIDE_JOYSTICK, 0.0);
    for _ in 0..8 {
        bench.fly().unwrap();
    }
    bench.simulator.listen();
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
}

//! Taking the controls of a minimal X-Plane on the loopback interface, writing
//! them, and releasing them on every exit path.

use std::net::SocketAddr;
use std::time::Duration;

use crate::support::bench::{Bench, SURFACES};
use crate::support::{
    FakeXPlane, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, THROTTLE, YOKE_HEADING, YOKE_PITCH,
    YOKE_ROLL,
};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault};
use fcc_xplane::{Control, Output, Released, Trouble, XPlane};

#[test]
fn control_is_taken_written_and_confirmed() {
    let mut bench = Bench::new();
    bench.settle();
    assert_eq!(bench.status.control(), Control::Free);
    for tick in 0..400 {
        assert_eq!(bench.fly(), Ok(()), "tick {tick}");
    }
    bench.simulator.listen();
    assert_eq!(bench.status.control(), Control::Held);
    // The overrides come first, and again every second: 40 ticks of 4 writes
    // and 2 more.
    let paths: Vec<_> = bench
        .simulator
        .writes
        .iter()
        .map(|w| w.0.as_str())
        .collect();
    assert_eq!(&paths[..2], &[OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES]);
    let asserted = paths
        .iter()
        .filter(|path| **path == OVERRIDE_JOYSTICK)
        .count();
    assert_eq!(asserted, 10);
    assert_eq!(paths.len(), 400 * 4 + 10 * 2);
    bench.simulator.assert_shows(YOKE_PITCH, 0.1);
    bench.simulator.assert_shows(YOKE_ROLL, -0.2);
    bench.simulator.assert_shows(YOKE_HEADING, 0.05);
    bench.simulator.assert_shows(THROTTLE, 0.8);
}

#[test]
fn control_is_taken_only_where_it_is_allowed() {
    let mut bench = Bench::new();
    bench.status.require_permission();
    bench.settle();
    let here = bench.simulator.address();
    let elsewhere = SocketAddr::new(here.ip(), here.port() ^ 1);
    assert_eq!(bench.fly(), Err(ActuatorFault::NotConnected));
    bench.status.allow(elsewhere);
    assert_eq!(bench.fly(), Err(ActuatorFault::NotConnected));
    bench.simulator.listen();
    assert!(bench.simulator.writes.is_empty());
    assert_eq!(bench.status.held_at(), None);
    bench.status.allow(here);
    bench.fly().unwrap();
    assert_eq!(bench.status.held_at(), Some(here));
    bench.simulator.listen();
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
}

#[test]
fn an_override_that_got_lost_is_set_again_within_a_second() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..10 {
        bench.fly().unwrap();
    }
    bench.simulator.set(OVERRIDE_JOYSTICK, 0.0);
    for _ in 0..41 {
        bench.fly().unwrap();
    }
    bench.simulator.listen();
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
}

#[test]
fn a_release_centres_and_clears_the_overrides() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..40 {
        bench.fly().unwrap();
    }
    bench.simulator.listen();
    bench.actuator.as_mut().unwrap().release().unwrap();
    bench.assert_released();
    assert_eq!(bench.status.control(), Control::ReleaseMonitor);
    for _ in 0..20 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.status.control(), Control::Free);
    // Again, and at the end: there is nothing left to release.
    bench.simulator.writes.clear();
    bench.actuator.as_mut().unwrap().release().unwrap();
    drop(bench.actuator.take());
    bench.simulator.listen();
    assert_eq!(bench.simulator.writes, []);
}

#[test]
fn dropping_releases() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..40 {
        bench.fly().unwrap();
    }
    bench.simulator.listen();
    drop(bench.actuator.take());
    bench.assert_released();
}

#[test]
fn unwinding_releases() {
    let mut bench = Bench::new();
    bench.settle();
    bench.fly().unwrap();
    bench.simulator.listen();
    let actuator = bench.actuator.take();
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || {
        let _actuator = actuator;
        std::panic::resume_unwind(Box::new("a controller failed"));
    }));
    assert!(panicked.is_err());
    bench.assert_released();
}

#[test]
fn controls_that_were_never_taken_are_not_released() {
    let mut bench = Bench::new();
    bench.settle();
    bench.actuator.as_mut().unwrap().release().unwrap();
    drop(bench.actuator.take());
    bench.simulator.listen();
    assert_eq!(bench.simulator.writes, []);
}

#[test]
fn a_release_that_got_lost_is_sent_again_by_the_sensor() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..40 {
        bench.fly().unwrap();
    }
    bench.simulator.listen();
    bench.simulator.accepts_writes = false;
    drop(bench.actuator.take());
    bench.simulator.listen();
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
    bench.simulator.accepts_writes = true;
    for _ in 0..20 {
        bench.watch().unwrap();
    }
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 0.0);
    bench.simulator.assert_shows(OVERRIDE_THROTTLES, 0.0);
    bench.simulator.assert_shows(YOKE_PITCH, 0.0);
    assert_eq!(bench.status.control(), Control::Free);
}

#[test]
fn an_override_set_by_a_write_after_the_release_is_released_again() {
    let mut bench = Bench::released();
    for late in [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, OVERRIDE_JOYSTICK] {
        bench.simulator.set(late, 1.0);
        // As it was last written.
        bench.simulator.set(YOKE_PITCH, SURFACES.elevator as f32);
        for _ in 0..20 {
            bench.watch().unwrap();
        }
        bench.simulator.assert_shows(late, 0.0);
        bench.simulator.assert_shows(YOKE_PITCH, 0.0);
        for _ in 0..20 {
            bench.watch().unwrap();
        }
        assert_eq!(bench.status.control(), Control::Free);
    }
    // 60 s after the release: another program's.
    for _ in 0..2_300 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.status.held_at(), None);
    bench.simulator.writes.clear();
    bench.simulator.set(OVERRIDE_JOYSTICK, 1.0);
    for _ in 0..40 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.simulator.writes, []);
}

/// A network that repeats what was written up to 25 s before.
#[test]
fn overrides_that_old_duplicates_set_are_released_again_and_count_as_held() {
    let mut bench = Bench::new();
    bench.settle();
    let moved = |tick: u16| Surfaces {
        elevator: 0.1 + 0.0001 * f64::from(tick),
        ..SURFACES
    };
    for tick in 0..1_000 {
        bench.fly_with(&moved(tick)).unwrap();
    }
    bench.actuator.as_mut().unwrap().release().unwrap();
    for _ in 0..400 {
        bench.watch().unwrap();
    }
    for tick in 0..15 {
        assert_eq!(bench.status.held_at(), None);
        bench.simulator.set(OVERRIDE_JOYSTICK, 1.0);
        for ago in 0..8 {
            let doubled = moved(60 * tick + ago).elevator as f32;
            bench.simulator.set(YOKE_PITCH, doubled);
            bench.watch().unwrap();
        }
        // At the end of the program this would be waited for.
        assert!(bench.status.held_at().is_some());
        for _ in 0..32 {
            bench.watch().unwrap();
        }
        bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 0.0);
    }
}

#[test]
fn an_override_of_a_program_that_takes_over_is_not_released() {
    let mut bench = Bench::released();
    bench.simulator.set(OVERRIDE_JOYSTICK, 1.0);
    for tick in 0..100_u8 {
        // In the middle of what was written, and moved by little.
        let pitch = 0.05 + 0.001 * (f32::from(tick) * 0.2).sin();
        bench.simulator.set(YOKE_PITCH, pitch);
        bench.watch().unwrap();
    }
    assert_eq!(bench.simulator.writes, []);
    assert_eq!(bench.status.held_at(), None);
}

#[test]
fn control_may_be_taken_again_after_a_release() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..3 {
        for _ in 0..40 {
            bench.fly().unwrap();
        }
        bench.actuator.as_mut().unwrap().release().unwrap();
        bench.watch().unwrap();
        bench.fly().unwrap();
        bench.simulator.listen();
        bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
        assert_eq!(bench.status.control(), Control::Held);
    }
}

#[test]
fn writing_into_a_firewall_is_unconfirmed_and_says_which_setting() {
    let mut bench = Bench::new();
    bench.settle();
    bench.simulator.accepts_writes = false;
    let faults: Vec<_> = (0..60).map(|_| bench.fly().err()).collect();
    let first = faults.iter().position(Option::is_some);
    // After more than a second: 41 ticks of 25 ms.
    assert_eq!(first, Some(41));
    assert_eq!(faults[59], Some(ActuatorFault::Unconfirmed));
    let trouble = bench.status.trouble().unwrap();
    assert_eq!(trouble, Trouble::Unconfirmed(bench.simulator.address()));
    let message = trouble.to_string();
    assert!(message.contains("Settings > Network > Accept incoming connections"));
    assert!(message.contains("firewall"));

    bench.simulator.accepts_writes = true;
    for _ in 0..41 {
        let _ = bench.fly();
    }
    assert_eq!(bench.fly(), Ok(()));
    assert_eq!(bench.status.trouble(), None);
}

#[test]
fn after_a_crash_the_controls_can_be_released_from_outside() {
    let mut simulator = FakeXPlane::new();
    simulator.set(OVERRIDE_JOYSTICK, 1.0);
    simulator.set(YOKE_PITCH, -0.5);
    let (config, address) = (simulator.config(), simulator.address());
    let released = std::thread::spawn(move || {
        XPlane::release_and_wait(&config, address, Duration::from_secs(10)).unwrap()
    });
    while !released.is_finished() {
        simulator.live(0.0);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(released.join().unwrap(), Released::Confirmed);
    simulator.assert_shows(OVERRIDE_JOYSTICK, 0.0);
    simulator.assert_shows(YOKE_PITCH, 0.0);
}

#[test]
fn with_rows_controls_are_written_confirmed_and_released_too() {
    let mut bench = Bench::with(|config| config.output = Output::Data);
    bench.settle();
    for tick in 0..100 {
        assert_eq!(bench.fly(), Ok(()), "tick {tick}");
    }
    bench.simulator.listen();
    bench.simulator.assert_shows(YOKE_PITCH, 0.1);
    bench.simulator.assert_shows(YOKE_ROLL, -0.2);
    bench.simulator.assert_shows(YOKE_HEADING, 0.05);
    bench.simulator.assert_shows(THROTTLE, 0.8);
    bench.simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
    drop(bench.actuator.take());
    bench.assert_released();
}

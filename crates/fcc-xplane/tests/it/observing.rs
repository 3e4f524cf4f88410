//! What the sensor finds out besides measurements, and what is said about it.

use crate::support::bench::{Bench, SURFACES};
use crate::support::{OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, P, SWITCH, Wire, YOKE_PITCH};
use fcc_core::flight::{Measurements, OtherControl, Surfaces, Suspect};
use fcc_core::framework::{Actuator, ControlAuthority, Sensor};
use fcc_xplane::{Control, XPlane, XPlaneAuthority};

const G_NRML: &str = "sim/flightmodel/forces/g_nrml";
const LEVER: &str = "sim/cockpit2/engine/actuators/throttle_ratio[0]";

/// All lines that are to be said now.
fn lines(authority: &XPlaneAuthority) -> Vec<String> {
    let mut lines = Vec::new();
    loop {
        let before = lines.len();
        authority.report(&mut |text| lines.push(text.to_string()));
        if lines.len() == before {
            return lines;
        }
    }
}

/// Accelerations that contain gravity: 1 g more than the load factor says.
#[test]
fn accelerations_that_contradict_the_load_factor_are_said_once() {
    let mut bench = Bench::new();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    bench.simulator.set(G_NRML, 1.0);
    bench.settle();
    for _ in 0..200 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.measurements.suspect.value, Suspect::default());
    lines(&authority);
    bench.simulator.set(&format!("{P}local_ay"), 9.8);
    for _ in 0..130 {
        bench.watch().unwrap();
    }
    assert!(bench.measurements.suspect.value.specific_force);
    let said = lines(&authority);
    let [line] = &said[..] else {
        panic!("one line: {said:?}")
    };
    assert!(line.contains("contradict its load factor"), "{line}");
    assert!(line.contains("the accelerations are used"), "{line}");
    for _ in 0..200 {
        bench.watch().unwrap();
    }
    assert!(lines(&authority).is_empty());
}

#[test]
fn a_release_says_where_the_throttle_s_lever_is() {
    let mut bench = Bench::new();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    bench.simulator.set(LEVER, 0.35);
    bench.settle();
    bench.fly().unwrap();
    lines(&authority);
    drop(bench.actuator.take());
    bench.watch().unwrap();
    // Sent, not confirmed.
    assert!(lines(&authority).is_empty());
    for _ in 0..20 {
        bench.watch().unwrap();
    }
    let said = lines(&authority);
    let [line] = &said[..] else {
        panic!("one line: {said:?}")
    };
    assert!(
        line.contains("confirmed the release of its controls"),
        "{line}"
    );
    assert!(line.contains("its lever again, which is at 35 %"), "{line}");
}

/// As after a silence in which nothing is said of the controls.
#[test]
fn a_release_that_was_not_seen_before_it_was_confirmed_is_said() {
    let mut bench = Bench::new();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    bench.settle();
    bench.fly().unwrap();
    lines(&authority);
    drop(bench.actuator.take());
    for _ in 0..21 {
        bench.watch().unwrap();
    }
    let said = lines(&authority);
    assert!(
        said.iter()
            .any(|line| line.contains("confirmed the release of its controls")),
        "{said:?}"
    );
}

/// Of a version that has none of these datarefs nothing is missing.
#[test]
fn an_x_plane_without_the_optional_datarefs_is_quiet() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..400 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.status.missing(), []);
    assert_eq!(
        bench.measurements.other_control.value,
        OtherControl::default()
    );
    assert!(!bench.measurements.attitude.is_never());
    let subscribed: Vec<_> = bench.simulator.subscribed.values().collect();
    assert!(subscribed.iter().any(|path| path.ends_with("true_theta")));
    assert!(subscribed.iter().any(|path| *path == SWITCH));
}

/// A second connection to the simulator that is flown, as for Data Output: what
/// the first one's actuator writes is not another program's, and what is
/// another's is seen over both.
#[test]
fn a_connection_beside_the_one_that_flies_sees_only_another_program() {
    let mut bench = Bench::new();
    bench.settle();
    let config = bench.simulator.config();
    let from = bench.simulator.sender.local_addr().unwrap();
    let wire = Wire::default();
    let (second, _) = XPlane::over(&config, wire.clone(), None).unwrap();
    let mut second = second.beside(&bench.status);
    let mut measured = Measurements::default();
    let mut fly = |bench: &mut Bench, other: Option<f32>| {
        bench.simulator.listen();
        if let Some(pitch) = other {
            bench.simulator.set(YOKE_PITCH, pitch);
        }
        bench.simulator.send_next_frame(0.025);
        wire.arrives(&bench.simulator.frame(), from);
        let tick = bench.ticks.next();
        bench.sensor.sample(&tick, &mut bench.measurements).unwrap();
        second.sample(&tick, &mut measured).unwrap();
        let surfaces = Surfaces {
            elevator: 0.2 * (tick.number as f64 * 0.1).sin(),
            ..SURFACES
        };
        let actuator = bench.actuator.as_mut().unwrap();
        actuator.apply(&tick, &surfaces).unwrap();
        (
            bench.measurements.other_control.value,
            measured.other_control.value,
        )
    };
    for _ in 0..200 {
        let alone = OtherControl::default();
        assert_eq!(fly(&mut bench, None), (alone, alone));
    }
    let found = (0..80).map(|tick| fly(&mut bench, (tick % 3 == 0).then_some(0.7)));
    let (first, second) = found.last().unwrap();
    assert!(first.writer && second.writer, "{first:?} {second:?}");
}

/// A daemon and its release helper were both killed: nothing moves the yoke.
#[test]
fn overrides_that_were_left_set_are_said_once_and_released_when_asked() {
    let mut bench = Bench::new();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    for path in [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES] {
        bench.simulator.set(path, 1.0);
    }
    bench.simulator.set(YOKE_PITCH, 0.3);
    bench.settle();
    lines(&authority);
    for _ in 0..100 {
        bench.watch().unwrap();
    }
    assert!(lines(&authority).is_empty(), "for 3 s");
    for _ in 0..40 {
        bench.watch().unwrap();
    }
    let said = lines(&authority).concat();
    assert!(said.contains("controls are still overridden"), "{said}");
    assert_eq!(bench.simulator.writes, [], "it may be another program's");
    assert_eq!(authority.held(), None);

    authority.release_left();
    assert!(authority.held().is_some(), "until it is confirmed");
    for _ in 0..40 {
        bench.watch().unwrap();
    }
    for path in [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, YOKE_PITCH] {
        bench.simulator.assert_shows(path, 0.0);
    }
    assert_eq!(authority.held(), None);
    let writes = bench.simulator.writes.len();
    authority.release_left();
    for _ in 0..40 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.simulator.writes.len(), writes, "nothing is held");
    assert_eq!(authority.held(), None);

    // Not while this program flies.
    bench.fly().unwrap();
    authority.release_left();
    bench.fly().unwrap();
    assert_eq!(bench.status.control(), Control::Held);
}

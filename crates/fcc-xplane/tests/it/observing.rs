//! What the sensor finds out besides measurements, and what is said about it.

use crate::support::bench::Bench;
use crate::support::{OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, SWITCH, YOKE_PITCH};
use fcc_core::framework::ControlAuthority;
use fcc_xplane::{Control, XPlaneAuthority};

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
    assert!(!bench.measurements.attitude.is_never());
    let subscribed: Vec<_> = bench.simulator.subscribed.values().collect();
    assert!(subscribed.iter().any(|path| path.ends_with("true_theta")));
    assert!(subscribed.iter().any(|path| *path == SWITCH));
}

/// A daemon and its release helper were both killed.
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

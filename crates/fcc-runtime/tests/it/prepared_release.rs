//! A release that waits until the controller has prepared the plant for it.

use crate::bench::{Bench, LOST, SENSORS_LOST, config};
use fcc_core::framework::State::{Engaged, Failsafe, Stopped};
use fcc_core::framework::Switch;
use fcc_runtime::{Ending, LoopCommand};

fn stopping() -> Bench {
    let mut bench = Bench::engaged(&config());
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|s| s.prepares_release = Some(false)), Engaged);
    bench
}

fn is_by_command(bench: Bench) -> bool {
    let report = bench.machine.finish();
    report.released && matches!(report.ending, Ending::StopCommand)
}

#[test]
fn a_commanded_stop_waits_until_the_plant_is_prepared() {
    let mut bench = stopping();
    for _ in 0..100 {
        assert_eq!(bench.tick(|_| {}), Engaged);
    }
    assert_eq!(bench.stage.log().held, [true, true]);
    assert_eq!(bench.tick(|s| s.prepares_release = Some(true)), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
    assert!(is_by_command(bench));
}

#[test]
fn it_does_not_wait_longer_than_twelve_seconds() {
    let mut bench = stopping();
    let ticks = (1..1_000).find(|_| bench.tick(|_| {}) == Stopped);
    assert_eq!(ticks, Some(480));
    assert!(is_by_command(bench));
}

#[test]
fn a_second_stop_releases_at_once() {
    let mut bench = stopping();
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(is_by_command(bench));
}

#[test]
fn a_signal_releases_at_once() {
    let mut bench = stopping();
    bench.link.stop.stop();
    assert_eq!(bench.tick(|_| {}), Stopped);
}

#[test]
fn disengaging_and_the_switch_release_at_once_and_the_stop_follows() {
    let mut bench = stopping();
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(is_by_command(bench));
    let mut bench = Bench::engaged(&config());
    bench.tick(|s| s.switch = Some(Switch::On));
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|s| s.prepares_release = Some(false)), Engaged);
    // Two readings of the switch agree.
    assert_eq!(bench.tick(|s| s.switch = Some(Switch::Off)), Engaged);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(is_by_command(bench));
}

#[test]
fn who_takes_over_while_it_waits_has_control_at_once() {
    let mut bench = stopping();
    assert_eq!(bench.tick(|s| s.taken_over = LOST), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
    assert!(is_by_command(bench));
}

#[test]
fn a_controller_that_does_not_prepare_is_released_at_once() {
    let mut bench = Bench::engaged(&config());
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(is_by_command(bench));
}

#[test]
fn a_failsafe_ends_after_its_time_while_a_stop_waits() {
    let mut bench = stopping();
    let failsafe = Failsafe(SENSORS_LOST);
    for _ in 0..4 {
        assert_eq!(bench.tick(|s| s.faults = LOST), failsafe);
    }
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(is_by_command(bench));
}

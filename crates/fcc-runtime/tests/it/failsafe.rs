//! What leads to failsafe, how long it lasts, and what ends it.

use crate::bench;
use std::time::Duration;

use crate::bench::{Bench, LOST, RELEASED, SENSORS_LOST, change, config};
use fcc_core::framework::State::{Engaged, Failsafe, Standby, Stopped};
use fcc_core::framework::{AfterRelease, Cause, Flags, Switch};
use fcc_runtime::{LoopCommand, LoopConfig};

#[test]
fn faults_lead_through_failsafe_to_standby() {
    let mut bench = Bench::engaged(&config());
    assert_eq!(bench.tick(|s| s.faults = LOST), Failsafe(SENSORS_LOST));
    // Failsafe lasts for four periods of tick time: this tick and three more.
    for _ in 0..3 {
        assert_eq!(bench.tick(|_| {}), Failsafe(SENSORS_LOST));
    }
    assert_eq!(bench.stage.log().applied, [-0.25; 4]);
    assert_eq!(bench.stage.log().held, [true, true]);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(bench.stage.log().held, [false, false]);
    assert_eq!(
        bench.events(),
        [
            change(Engaged, Failsafe(SENSORS_LOST)),
            change(Failsafe(SENSORS_LOST), Standby),
            RELEASED
        ]
    );
    let report = bench.machine.finish();
    assert_eq!(report.failsafes, 1);
    assert_eq!(report.last_failsafe, Some(SENSORS_LOST));
}

#[test]
fn a_failsafe_that_goes_on_ends_only_when_it_no_longer_does() {
    let mut bench = Bench::engaged(&config());
    bench.stage.set(|s| (s.faults, s.goes_on) = (LOST, true));
    for _ in 0..100 {
        assert_eq!(bench.tick(|_| {}), Failsafe(SENSORS_LOST));
    }
    // Four periods from then on, of which one has passed.
    for _ in 0..3 {
        assert_eq!(bench.tick(|s| s.goes_on = false), Failsafe(SENSORS_LOST));
    }
    assert_eq!(bench.tick(|_| {}), Standby);
    // Invalid outputs do not go on.
    let mut bench = Bench::engaged(&config());
    bench.stage.set(|s| s.goes_on = true);
    bench.tick(|s| s.output = f64::NAN);
    for _ in 0..3 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.tick(|_| {}), Standby);
}

#[test]
fn a_failsafe_whose_faults_are_over_continues_what_was_done() {
    let mut bench = Bench::engaged(&config());
    bench.tick(|s| s.faults = LOST);
    bench.events();
    bench.stage.forget();
    let state = bench.tick(|s| (s.faults, s.has_recovered) = (Flags::NONE, true));
    assert_eq!(state, Engaged);
    assert_eq!(
        bench.stage.log().calls,
        ["sample", "estimate", "recover", "guide", "control", "apply"]
    );
    assert_eq!(bench.stage.log().applied, [0.5]);
    assert_eq!(bench.events(), [change(Failsafe(SENSORS_LOST), Engaged)]);
    // A command to disengage wins.
    let mut bench = Bench::engaged(&config());
    bench.tick(|s| s.faults = LOST);
    bench.command(LoopCommand::Disengage);
    let state = bench.tick(|s| (s.faults, s.has_recovered) = (Flags::NONE, true));
    assert_eq!(state, Standby);
    // Invalid outputs are no fault of a sensor.
    let mut bench = Bench::engaged(&config());
    bench.tick(|s| s.output = f64::NAN);
    let state = bench.tick(|s| (s.output, s.has_recovered) = (0.5, true));
    assert_eq!(state, Failsafe(Cause::InvalidOutput));
}

#[test]
fn failsafe_lasts_by_the_schedule_and_not_by_ticks() {
    let mut bench = Bench::engaged(&config());
    bench.stage.set(|s| s.faults = LOST);
    bench.machine.tick(bench::expiry(10));
    assert_eq!(bench.machine.state(), Failsafe(SENSORS_LOST));
    // Three deadlines were missed: four periods have passed in one tick.
    assert_eq!(bench.machine.tick(bench::expiry(14)), Standby);
}

#[test]
fn a_failsafe_of_no_length_releases_at_once() {
    let mut bench = Bench::engaged(&LoopConfig {
        failsafe_hold: Duration::ZERO,
        ..config()
    });
    assert_eq!(bench.tick(|s| s.faults = LOST), Standby);
    assert!(bench.stage.log().applied.is_empty());
    assert_eq!(bench.stage.log().held, [false, false]);
}

#[test]
fn failsafe_can_be_left_by_every_command() {
    let failing = || {
        let mut bench = Bench::with(&config());
        bench.turn(Switch::Off);
        bench.turn(Switch::On);
        let state = bench.tick(|s| s.faults = LOST);
        assert_eq!(state, Failsafe(SENSORS_LOST));
        bench.stage.set(|s| s.faults = Flags::NONE);
        bench
    };
    let mut bench = failing();
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);

    let mut bench = failing();
    bench.command(LoopCommand::Engage);
    assert_eq!(
        bench.tick(|s| s.engage_inhibits = LOST),
        Failsafe(SENSORS_LOST),
        "blocked"
    );

    let mut bench = failing();
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(bench.stage.log().held, [false, false]);

    let mut bench = failing();
    assert_eq!(bench.turn(Switch::Off), Standby);
    assert_eq!(bench.stage.log().held, [false, false]);

    let mut bench = failing();
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
}

#[test]
fn after_failsafe_the_loop_stops_if_configured() {
    let mut bench = Bench::engaged(&LoopConfig {
        after_failsafe: AfterRelease::Stop,
        ..config()
    });
    bench.tick(|s| s.faults = LOST);
    for _ in 0..3 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
}

#[test]
fn invalid_outputs_are_never_sent() {
    for invalid in [f64::NAN, f64::INFINITY, 1.000_001] {
        let mut bench = Bench::engaged(&config());
        let state = bench.tick(|s| s.output = invalid);
        assert_eq!(state, Failsafe(Cause::InvalidOutput));
        // The failsafe's outputs were written in that tick.
        assert_eq!(bench.stage.log().applied, [-0.25]);
        let record = *bench.machine.record();
        assert!(record.sent);
        assert!((record.outputs + 0.25).abs() < 1e-15);
    }
}

#[test]
fn invalid_outputs_in_failsafe_release_control() {
    let mut bench = Bench::engaged(&config());
    let state = bench.tick(|s| {
        s.output = f64::NAN;
        s.failsafe_output = f64::NAN;
    });
    assert_eq!(state, Standby);
    assert!(bench.stage.log().applied.is_empty());
    assert_eq!(bench.stage.log().held, [false, false]);
    assert!(!bench.machine.record().sent);
    let failsafe = Failsafe(Cause::InvalidOutput);
    assert_eq!(
        bench.events(),
        [
            change(Engaged, failsafe),
            change(failsafe, Standby),
            RELEASED
        ]
    );
}

//! What changes the loop's state, and what does not.

mod bench;

use std::time::Duration;

use bench::{Bench, EventKind, PERIOD, RELEASED, change};
use fcc_core::framework::State::{Engaged, Failsafe, Standby, Stopped};
use fcc_core::framework::{AfterRelease, Cause, Flags, Notice, Switch};
use fcc_runtime::{Ending, LoopCommand, LoopConfig};

const LOST: Flags = Flags::bit(1);
const GONE: Flags = Flags::bit(0);
const SENSORS_LOST: Cause = Cause::Faults(LOST);

fn config() -> LoopConfig {
    LoopConfig {
        failsafe_hold: 4 * PERIOD,
        switch_max_age: 2 * PERIOD,
        ..LoopConfig::default()
    }
}

fn refused(engage_inhibits: Flags) -> EventKind {
    EventKind::EngageRefused { engage_inhibits }
}

#[test]
fn standby_reads_and_writes_nothing() {
    let mut bench = Bench::new();
    for _ in 0..100 {
        assert_eq!(bench.tick(|_| {}), Standby);
    }
    let log = bench.stage.log();
    assert_eq!(log.calls.len(), 200, "sample and estimate only");
    assert!(log.applied.is_empty());
    let records = bench.records();
    assert_eq!(records.len(), 100);
    assert!(records.iter().all(|record| !record.sent));
    assert_eq!(records[99].measurements.samples, 100);
}

#[test]
fn the_parts_of_a_tick_are_called_in_order() {
    let mut bench = Bench::new();
    bench.command(LoopCommand::Controller(7));
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
    assert_eq!(
        bench.stage.log().calls,
        [
            "command", "sample", "estimate", "engage", "guide", "control", "apply"
        ]
    );
    assert_eq!(bench.events(), [change(Standby, Engaged)]);
    bench.stage.forget();
    bench.tick(|_| {});
    assert_eq!(
        bench.stage.log().calls,
        ["sample", "estimate", "guide", "control", "apply"]
    );
    assert_eq!(bench.stage.log().applied, [0.5]);
}

#[test]
fn a_disengage_command_releases() {
    let mut bench = Bench::engaged(&config());
    assert_eq!(bench.stage.log().held, [true, true]);
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(
        bench.stage.log().calls,
        ["sample", "estimate", "release", "disengage"]
    );
    assert_eq!(bench.stage.log().held, [false, false]);
    assert_eq!(bench.events(), [change(Engaged, Standby), RELEASED]);
}

#[test]
fn an_inhibited_command_is_one_refused_attempt() {
    let mut bench = Bench::new();
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|s| s.engage_inhibits = LOST), Standby);
    assert_eq!(bench.machine.record().engage_inhibits, LOST);
    // With the inhibit gone, nothing happens until the next command.
    assert_eq!(bench.tick(|s| s.engage_inhibits = Flags::NONE), Standby);
    assert_eq!(bench.events(), [refused(LOST)]);
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
}

/// The switch is on for 20 ticks, the half second after which it is steady.
#[test]
fn switching_off_stops_if_configured() {
    let mut bench = Bench::with(&LoopConfig {
        switch_off: AfterRelease::Stop,
        ..config()
    });
    bench.turn(Switch::Off);
    bench.turn(Switch::On);
    assert_eq!(bench.turn(Switch::Off), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
}

#[test]
fn disengaging_wins_over_engaging() {
    let mut bench = Bench::with(&config());
    bench.turn(Switch::Off);
    bench.turn(Switch::On);
    bench.events();
    bench.tick(|s| s.switch = Some(Switch::Off));
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Standby);
    let refused = EventKind::EngageRefusedBySwitch;
    assert_eq!(
        bench.events(),
        [change(Engaged, Standby), RELEASED, refused]
    );
}

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
fn what_must_be_released_is_released_in_the_same_tick_without_a_failsafe() {
    for from_failsafe in [false, true] {
        let mut bench = Bench::engaged(&config());
        if from_failsafe {
            bench.tick(|s| s.faults = LOST);
        }
        let from = bench.machine.state();
        bench.events();
        bench.stage.forget();
        // Engaging in that tick is refused.
        bench.command(LoopCommand::Engage);
        assert_eq!(bench.tick(|s| s.must_release = GONE), Standby);
        assert_eq!(bench.machine.record().faults.bits() & GONE.bits(), 1);
        let log = bench.stage.log();
        assert!(log.applied.is_empty());
        assert_eq!(log.held, [false, false]);
        let released_at_once = EventKind::ReleasedAtOnce { conditions: GONE };
        assert_eq!(
            bench.events(),
            [
                released_at_once,
                change(from, Standby),
                RELEASED,
                refused(Flags::NONE)
            ]
        );
        // In standby it has no effect.
        assert_eq!(bench.tick(|_| {}), Standby);
        assert_eq!(bench.events(), []);
        let failsafes = u64::from(from_failsafe);
        assert_eq!(bench.machine.finish().failsafes, failsafes);
    }
}

#[test]
fn after_a_release_at_once_the_loop_stops_if_configured() {
    let mut bench = Bench::engaged(&LoopConfig {
        after_failsafe: AfterRelease::Stop,
        ..config()
    });
    assert_eq!(bench.tick(|s| s.must_release = GONE), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
    let ending = bench.machine.finish().ending;
    assert!(matches!(ending, Ending::ReleasedAtOnce));
}

#[test]
fn outputs_that_are_withheld_are_recorded_and_not_sent() {
    let mut bench = Bench::engaged(&config());
    bench.stage.forget();
    for _ in 0..100 {
        assert_eq!(bench.tick(|s| s.withholds = true), Engaged);
        let record = bench.machine.record();
        assert_eq!((record.sent, record.outputs), (false, 0.5));
    }
    assert!(bench.stage.log().applied.is_empty());
    assert_eq!(bench.stage.log().held, [true, true]);
    // In failsafe, too; a command releases all the same.
    assert_eq!(bench.tick(|s| s.faults = LOST), Failsafe(SENSORS_LOST));
    assert!(bench.stage.log().applied.is_empty());
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(bench.stage.log().held, [false, false]);
}

#[test]
fn a_notice_is_an_event() {
    let mut bench = Bench::new();
    let notice = Notice {
        kind: 3,
        lasted_ns: 7,
        amount_permille: 0,
    };
    bench.tick(|s| s.notice = Some(notice));
    bench.tick(|s| s.notice = None);
    assert_eq!(bench.events(), [EventKind::Noticed(notice)]);
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

#[test]
fn a_missed_deadline_makes_a_longer_step() {
    let mut bench = Bench::new();
    bench.machine.tick(fcc_timer::Expiry {
        missed: 2,
        ..bench::expiry(3)
    });
    let tick = bench.machine.record().tick;
    assert_eq!((tick.number, tick.missed), (3, 2));
    assert_eq!(tick.scheduled, bench::due(3));
    assert!((tick.dt_s - 0.075).abs() < 1e-15);
    assert_eq!(tick.lateness(), Duration::from_micros(40));
}

/// Conditions are reported as they change while control is held, those that hold
/// at engagement too, and change nothing else.
#[test]
fn conditions_are_reported_while_control_is_held() {
    let (first, second) = (Flags::bit(2), Flags::bit(5));
    let changed = |began, ended| EventKind::ConditionsChanged { began, ended };
    let mut bench = Bench::new();
    bench.tick(|script| script.conditions = first);
    assert_eq!(bench.events(), []);
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
    assert_eq!(
        bench.events(),
        [change(Standby, Engaged), changed(first, Flags::NONE)]
    );
    bench.tick(|_| {});
    bench.tick(|script| script.conditions = second);
    assert_eq!(
        bench.tick(|script| script.conditions = Flags::NONE),
        Engaged
    );
    assert_eq!(
        bench.events(),
        [changed(second, first), changed(Flags::NONE, second)]
    );
    bench.tick(|script| script.conditions = second);
    bench.command(LoopCommand::Disengage);
    bench.tick(|_| {});
    let events = bench.events();
    assert_eq!(events.last(), Some(&RELEASED), "nothing after the release");
}

//! What changes the loop's state, and what does not.

use crate::bench;
use std::time::Duration;

use crate::bench::{Bench, EventKind, LOST, RELEASED, SENSORS_LOST, change, config};
use fcc_core::framework::State::{Engaged, Failsafe, Standby, Stopped};
use fcc_core::framework::{ActuatorFault, AfterRelease, Flags, Notice, Switch};
use fcc_runtime::{Ending, LoopCommand, LoopConfig};

const GONE: Flags = Flags::bit(0);

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

/// Or it would hold control of servos that do not move.
#[test]
fn an_actuator_that_is_not_ready_is_not_engaged() {
    let mut bench = Bench::new();
    let fault = ActuatorFault::Io { errno: 2 };
    bench.stage.set(|script| script.ready = Err(fault));
    for _ in 0..2 {
        bench.command(LoopCommand::Engage);
        assert_eq!(bench.tick(|_| {}), Standby);
    }
    let broken = |index| EventKind::ActuatorFault { index, fault };
    let refused = refused(Flags::NONE);
    // A fault that goes on is one event.
    assert_eq!(bench.events(), [broken(0), broken(1), refused, refused]);
    assert!(bench.stage.log().applied.is_empty());
    bench.stage.set(|script| script.ready = Ok(()));
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
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
fn each_notice_of_a_tick_is_an_event() {
    const FIRST: Notice = Notice {
        kind: 3,
        lasted_ns: 7,
        amount_permille: 0,
        item: 2,
    };
    const SECOND: Notice = Notice { item: 3, ..FIRST };
    let mut bench = Bench::new();
    bench.tick(|s| s.notices = &[FIRST, SECOND]);
    bench.tick(|s| s.notices = &[]);
    let expected = [FIRST, SECOND].map(EventKind::Noticed);
    assert_eq!(bench.events(), expected);
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
    assert_eq!(tick.lateness(), Duration::from_micros(50_040));
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

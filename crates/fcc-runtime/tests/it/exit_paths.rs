//! The actuators are released on every exit path, and the report names the
//! path.

use crate::bench;
use crate::bench::{Bench, EventKind, RELEASED, TimerEnd, change};
use fcc_core::framework::State::{Engaged, Standby, Stopped};
use fcc_core::framework::{ActuatorFault, AfterRelease, Cause, Flags, Switch};
use fcc_runtime::{Ending, LoopCommand, LoopConfig, LoopReport};

fn engaged() -> Bench {
    Bench::engaged(&LoopConfig::default())
}

/// Ends the bench; nothing may be under control then.
fn released(bench: Bench) -> LoopReport {
    assert_eq!(bench.machine.state(), Stopped);
    assert_eq!(bench.stage.log().held, [false, false]);
    let report = bench.machine.finish();
    assert!(report.released);
    report
}

#[test]
fn a_stop_command() {
    let mut bench = engaged();
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert_eq!(bench.events(), [change(Engaged, Stopped), RELEASED]);
    let report = released(bench);
    assert!(matches!(report.ending, Ending::StopCommand));
    assert_eq!(report.ticks, 2);
}

#[test]
fn the_stop_flag() {
    let mut bench = engaged();
    bench.link.stop.clone().stop();
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert_eq!(
        bench.events(),
        [EventKind::StopRequested, change(Engaged, Stopped), RELEASED]
    );
    assert!(matches!(released(bench).ending, Ending::StopFlag));
}

#[test]
fn the_stop_flag_as_a_signal_handler_sets_it() {
    let mut bench = engaged();
    let flag = bench.link.stop.flag();
    flag.store(true, std::sync::atomic::Ordering::SeqCst);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert!(matches!(released(bench).ending, Ending::StopFlag));
}

#[test]
fn the_switch() {
    let mut bench = Bench::with(&LoopConfig {
        switch_off: AfterRelease::Stop,
        ..LoopConfig::default()
    });
    for position in [Switch::Off, Switch::On, Switch::Off] {
        bench.turn(position);
    }
    assert!(matches!(released(bench).ending, Ending::SwitchedOff));
}

#[test]
fn the_end_of_failsafe() {
    let mut bench = Bench::engaged(&LoopConfig {
        after_failsafe: AfterRelease::Stop,
        failsafe_hold: bench::PERIOD,
        ..LoopConfig::default()
    });
    bench.tick(|s| s.faults = Flags::bit(0));
    bench.tick(|_| {});
    let report = released(bench);
    assert!(matches!(report.ending, Ending::FailsafeEnded));
    assert_eq!(report.last_failsafe, Some(Cause::Faults(Flags::bit(0))));
}

#[test]
fn a_timer_that_fails() {
    let mut bench = engaged();
    assert_eq!(bench.tick(|s| s.timer = Some(TimerEnd::Failed)), Stopped);
    let Bench {
        machine,
        mut link,
        stage,
    } = bench;
    let report = machine.finish();
    assert!(matches!(report.ending, Ending::TimerFailed(_)));
    assert_eq!(stage.log().held, [false, false]);
    let mut kinds = Vec::new();
    while let Some(message) = link.messages.receive() {
        if let fcc_runtime::Message::Event(event) = message {
            kinds.push(event.kind);
        }
    }
    assert_eq!(
        kinds,
        [EventKind::TimerFailed, change(Engaged, Stopped), RELEASED]
    );
}

#[test]
fn a_timer_that_ends() {
    let mut bench = engaged();
    assert_eq!(bench.tick(|s| s.timer = Some(TimerEnd::Ended)), Stopped);
    assert!(matches!(released(bench).ending, Ending::TimerEnded));
}

#[test]
fn a_panic_in_any_part() {
    for call in [
        "wait",
        "sample",
        "command",
        "estimate",
        "faults",
        "guide",
        "control",
        "outputs_are_valid",
        "apply",
        "setpoints",
    ] {
        let mut bench = engaged();
        bench.command(LoopCommand::Controller(1));
        assert_eq!(bench.tick(|s| s.panic_in = Some(call)), Stopped, "{call}");
        assert_eq!(bench.stage.log().held, [false, false], "{call}");
        let number = bench.machine.record().tick.number;
        assert_eq!(number, if call == "wait" { 1 } else { 2 });
        let report = released(bench);
        let Ending::Panicked(words) = report.ending else {
            panic!("{call}: ended by {:?}", report.ending);
        };
        assert_eq!(words, format!("scripted panic in {call}"));
    }
}

#[test]
fn a_panic_in_standby_failsafe_and_while_ending() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.tick(|s| s.panic_in = Some("engage_inhibits")),
        Stopped
    );
    assert!(matches!(released(bench).ending, Ending::Panicked(_)));

    let mut bench = Bench::new();
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|s| s.panic_in = Some("engage")), Stopped);
    assert!(matches!(released(bench).ending, Ending::Panicked(_)));

    let mut bench = engaged();
    let state = bench.tick(|s| {
        s.faults = Flags::bit(0);
        s.panic_in = Some("failsafe");
    });
    assert_eq!(state, Stopped);
    assert!(matches!(released(bench).ending, Ending::Panicked(_)));

    let mut bench = engaged();
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|s| s.panic_in = Some("disengage")), Stopped);
    assert!(matches!(released(bench).ending, Ending::Panicked(_)));
}

#[test]
fn a_panic_after_a_stop_command_is_not_hidden_by_it() {
    let mut bench = engaged();
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|s| s.panic_in = Some("disengage")), Stopped);
    assert!(matches!(released(bench).ending, Ending::Panicked(_)));
}

#[test]
fn a_panic_is_reported_and_leaves_a_record() {
    let mut bench = engaged();
    bench.records();
    bench.tick(|s| s.panic_in = Some("control"));
    let messages = bench.messages();
    let kinds: Vec<_> = messages
        .iter()
        .filter_map(|message| match message {
            fcc_runtime::Message::Event(event) => Some(event.kind),
            fcc_runtime::Message::Tick(_) => None,
        })
        .collect();
    assert_eq!(
        kinds,
        [EventKind::Panicked, change(Engaged, Stopped), RELEASED]
    );
    let Some(fcc_runtime::Message::Tick(record)) = messages.last() else {
        panic!("the tick of the panic left no record");
    };
    assert_eq!(record.tick.number, 2);
    assert_eq!(record.state, Stopped);
    assert_eq!(record.measurements.samples, 2);
    assert!(!record.sent);
}

/// The first actuator panics in its release; the second is released
/// all the same, and the loop ends.
#[test]
fn a_panic_in_a_release() {
    let mut bench = engaged();
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|s| s.panic_in = Some("release")), Stopped);
    assert_eq!(bench.stage.log().held, [true, false]);
    assert_eq!(
        bench.events(),
        [
            change(Engaged, Standby),
            EventKind::Released { ok: false },
            EventKind::Panicked,
            change(Standby, Stopped)
        ]
    );
    let report = bench.machine.finish();
    assert!(!report.released);
    assert!(matches!(report.ending, Ending::Panicked(_)));
}

#[test]
fn a_failed_release_is_repeated_until_it_succeeds() {
    let mut bench = engaged();
    bench.command(LoopCommand::Disengage);
    let fault = ActuatorFault::Io { errno: 101 };
    assert_eq!(bench.tick(|s| s.release = Err(fault)), Standby);
    for _ in 0..3 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.stage.log().held, [true, false]);
    bench.tick(|s| s.release = Ok(()));
    assert_eq!(bench.stage.log().held, [false, false]);
    let releases = bench.stage.log().releases[0];
    for _ in 0..3 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.stage.log().releases[0], releases);
    assert_eq!(
        bench.events(),
        [
            change(Engaged, Standby),
            EventKind::ActuatorFault { index: 0, fault },
            EventKind::Released { ok: false },
            EventKind::ActuatorRecovered { index: 0 },
            RELEASED
        ]
    );
}

#[test]
fn a_release_that_fails_to_the_end_is_in_the_report() {
    let mut bench = engaged();
    bench.command(LoopCommand::Stop);
    bench.tick(|s| s.release = Err(ActuatorFault::NotConnected));
    assert!(!bench.machine.finish().released);
}

#[test]
fn finishing_and_dropping() {
    let bench = engaged();
    assert_eq!(bench.stage.log().held, [true, true]);
    let stage = bench.stage.clone();
    let report = bench.machine.finish();
    assert!(matches!(report.ending, Ending::Finished));
    assert_eq!(stage.log().held, [false, false]);

    let bench = engaged();
    let stage = bench.stage.clone();
    drop(bench);
    assert_eq!(stage.log().held, [false, false]);
}

#[test]
fn a_machine_dropped_by_a_panic_around_it() {
    let bench = engaged();
    let stage = bench.stage.clone();
    // Even if a release then panics too, the next actuator gets its own.
    stage.set(|s| s.panic_in = Some("release"));
    let unwound = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || {
        let _bench = bench;
        panic!("around the machine");
    }));
    assert!(unwound.is_err());
    assert_eq!(stage.log().held, [true, false]);
}

#[test]
fn nothing_happens_after_the_end() {
    let mut bench = engaged();
    bench.command(LoopCommand::Stop);
    bench.tick(|_| {});
    bench.stage.forget();
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Stopped);
    assert_eq!(bench.machine.tick(bench::expiry(9)), Stopped);
    assert!(bench.stage.log().calls.is_empty());
    assert_eq!(bench.machine.state(), Stopped);
}

//! What the engage switch does, and what it does not.

use crate::bench::{Bench, EventKind, LOST, RELEASED, change, config};
use fcc_core::framework::State::{Engaged, Standby};
use fcc_core::framework::{AfterRelease, Flags, State, Switch};
use fcc_runtime::{Ending, LoopCommand, LoopConfig};

/// 20 ticks after the first off are half a second; the off takes two.
fn steadily_on(bench: &mut Bench) -> State {
    let states = [(); 19].map(|()| bench.tick(|s| s.switch = Some(Switch::On)));
    assert_eq!(states[17], Standby, "not before");
    states[18]
}

#[test]
fn the_switch_engages_on_its_rising_edge_only() {
    let mut bench = Bench::with(&config());
    // On from the start, as it was left.
    assert_eq!(bench.turn(Switch::On), Standby);
    assert_eq!(bench.turn(Switch::Off), Standby);
    assert_eq!(steadily_on(&mut bench), Engaged);
    assert_eq!(bench.turn(Switch::Off), Standby);
    assert_eq!(
        bench.events(),
        [change(Standby, Engaged), change(Engaged, Standby), RELEASED]
    );
}

#[test]
fn an_inhibited_switch_must_be_switched_on_again() {
    let mut bench = Bench::with(&config());
    bench.turn(Switch::Off);
    bench.stage.set(|s| s.engage_inhibits = LOST);
    bench.turn(Switch::On);
    assert_eq!(bench.tick(|s| s.engage_inhibits = Flags::NONE), Standby);
    assert_eq!(
        bench.events(),
        [EventKind::EngageRefused {
            engage_inhibits: LOST
        }]
    );
    bench.turn(Switch::Off);
    assert_eq!(steadily_on(&mut bench), Engaged);
}

#[test]
fn after_a_silence_the_switch_must_be_seen_off_again() {
    let mut bench = Bench::with(&config());
    bench.turn(Switch::Off);
    // Fresh for two periods, silent in the third.
    for _ in 0..3 {
        bench.tick(|s| s.switch = None);
    }
    assert_eq!(bench.turn(Switch::On), Standby);
    bench.tick(|_| {});
    assert_eq!(bench.events(), [EventKind::SwitchedOnUnseen], "once");
    bench.turn(Switch::Off);
    assert_eq!(steadily_on(&mut bench), Engaged);
}

#[test]
fn a_stale_switch_does_not_disengage() {
    let mut bench = Bench::with(&config());
    bench.turn(Switch::Off);
    bench.turn(Switch::On);
    for _ in 0..50 {
        assert_eq!(bench.tick(|s| s.switch = None), Engaged);
    }
    // It was switched off during the gap, and is off now.
    assert_eq!(bench.turn(Switch::Off), Standby);
}

/// However it was engaged: here by a command before the switch was first read.
#[test]
fn a_switch_that_is_off_ends_what_a_command_began_and_refuses_the_next() {
    let mut bench = Bench::with(&config());
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
    bench.tick(|s| s.switch = Some(Switch::Off));
    assert_eq!(bench.tick(|_| {}), Standby);
    bench.events();
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(bench.events(), [EventKind::EngageRefusedBySwitch]);
    bench.tick(|s| s.switch = Some(Switch::On));
    assert_eq!(bench.tick(|_| {}), Engaged);
    bench.command(LoopCommand::Disengage);
    assert_eq!(bench.tick(|_| {}), Standby);
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged, "the switch is on");
}

#[test]
fn if_permitted_a_command_engages_with_the_switch_off() {
    let mut bench = Bench::with(&LoopConfig {
        command_needs_switch: false,
        ..config()
    });
    bench.tick(|s| s.switch = Some(Switch::Off));
    bench.command(LoopCommand::Engage);
    for _ in 0..10 {
        assert_eq!(bench.tick(|_| {}), Engaged);
    }
}

/// As the switch off does, with an event; and it does not engage by itself when
/// nobody takes over any longer.
#[test]
fn who_takes_over_has_control_at_once_and_keeps_it() {
    let taken_over = Flags::bit(2);
    for from_failsafe in [false, true] {
        let mut bench = Bench::with(&config());
        bench.turn(Switch::Off);
        assert_eq!(bench.turn(Switch::On), Engaged);
        if from_failsafe {
            bench.tick(|s| s.faults = LOST);
        }
        let from = bench.machine.state();
        bench.events();
        bench.stage.forget();
        bench.command(LoopCommand::Engage);
        assert_eq!(bench.tick(|s| s.taken_over = taken_over), Standby);
        assert!(bench.stage.log().applied.is_empty());
        assert_eq!(bench.stage.log().held, [false, false]);
        let conditions = taken_over;
        let engage_inhibits = Flags::NONE;
        assert_eq!(
            bench.events(),
            [
                EventKind::ReleasedAtOnce { conditions },
                change(from, Standby),
                RELEASED,
                EventKind::EngageRefused { engage_inhibits },
            ]
        );
        bench.tick(|s| (s.taken_over, s.faults) = (Flags::NONE, Flags::NONE));
        for _ in 0..100 {
            assert_eq!(bench.tick(|_| {}), Standby);
        }
        bench.turn(Switch::Off);
        assert_eq!(steadily_on(&mut bench), Engaged);
    }
}

#[test]
fn who_takes_over_ends_the_loop_if_switching_off_does() {
    let mut bench = Bench::with(&LoopConfig {
        switch_off: AfterRelease::Stop,
        ..config()
    });
    bench.command(LoopCommand::Engage);
    assert_eq!(bench.tick(|_| {}), Engaged);
    assert_eq!(bench.tick(|s| s.taken_over = LOST), State::Stopped);
    let ending = bench.machine.finish().ending;
    assert!(matches!(ending, Ending::SwitchedOff));
}

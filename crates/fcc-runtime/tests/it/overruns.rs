//! Ticks that overrun their budget: counted, reported once, and too many of
//! them in a row are failsafe.

use std::time::Duration;

use crate::bench::{Bench, EventKind, PERIOD, RELEASED, change, expiry};
use fcc_core::framework::State::{Engaged, Failsafe, Standby};
use fcc_core::framework::{Cause, Flags, Stage, StageTimes, State};
use fcc_runtime::{Budget, LoopCommand, LoopConfig};
use fcc_timer::Expiry;

const MS: u64 = 1_000_000;

fn config(budget: Budget) -> LoopConfig {
    LoopConfig {
        budget,
        failsafe_hold: 2 * PERIOD,
        ..LoopConfig::default()
    }
}

fn after(failsafe_after: u32) -> LoopConfig {
    config(Budget {
        failsafe_after: Some(failsafe_after),
        ..Budget::default()
    })
}

/// A tick of so many milliseconds, a quarter of them in the estimate and the
/// rest in control.
fn took(total_ms: u64) -> StageTimes {
    StageTimes {
        estimate_ns: total_ms * MS / 4,
        control_ns: total_ms * MS * 3 / 4,
        total_ns: total_ms * MS,
        ..StageTimes::default()
    }
}

/// Performs tick `number`, which takes so long.
fn tick(bench: &mut Bench, number: u64, total_ms: u64) -> State {
    bench.machine.tick_again(expiry(number), took(total_ms))
}

fn overruns(bench: &mut Bench) -> Vec<EventKind> {
    let mut events = bench.events();
    events.retain(|kind| {
        matches!(
            kind,
            EventKind::Overrun { .. } | EventKind::OverrunsOver { .. }
        )
    });
    events
}

#[test]
fn a_tick_as_long_as_its_budget_does_not_overrun() {
    let mut bench = Bench::engaged(&after(1));
    for number in 2..100 {
        assert_eq!(tick(&mut bench, number, 25), Engaged);
    }
    assert_eq!(bench.machine.record().overruns, 0);
    assert_eq!(overruns(&mut bench), []);
}

#[test]
fn one_overrun_is_counted_and_reported_and_the_loop_continues() {
    let mut bench = Bench::engaged(&after(2));
    assert_eq!(tick(&mut bench, 2, 31), Engaged);
    assert_eq!(bench.machine.record().overruns, 1, "in its own record");
    for number in 3..=42 {
        assert_eq!(tick(&mut bench, number, 1), Engaged);
    }
    assert_eq!(bench.machine.record().overruns, 1);
    // A second after it: 40 ticks of 25 ms.
    assert_eq!(
        overruns(&mut bench),
        [
            EventKind::Overrun {
                of: Stage::Tick,
                took_ns: 31 * MS,
                budget_ns: 25 * MS,
                longest: Stage::Control,
            },
            EventKind::OverrunsOver {
                count: 1,
                first: 2,
                last: 2
            },
        ]
    );
}

#[test]
fn as_many_in_a_row_as_configured_are_failsafe_and_one_less_is_not() {
    let mut bench = Bench::engaged(&after(3));
    for number in [2, 3, 5, 6, 8, 9] {
        assert_eq!(tick(&mut bench, number, 26), Engaged);
        if number % 3 == 0 {
            assert_eq!(tick(&mut bench, number + 1, 1), Engaged);
        }
    }
    for number in 11..=13 {
        assert_eq!(tick(&mut bench, number, 26), Engaged);
    }
    // Known at the end of the third, acted upon in the next.
    assert_eq!(tick(&mut bench, 14, 26), Failsafe(Cause::Overrun));
    assert!(bench.machine.record().sent, "wings level goes on");
    let events = bench.events();
    assert!(events.contains(&change(Engaged, Failsafe(Cause::Overrun))));
    assert_eq!(bench.machine.record().overruns, 10);
}

#[test]
fn alternating_overruns_are_reported_once() {
    let mut bench = Bench::engaged(&after(2));
    for number in 2..1_000 {
        let total_ms = if number % 2 == 0 { 40 } else { 1 };
        assert_eq!(tick(&mut bench, number, total_ms), Engaged);
    }
    assert_eq!(overruns(&mut bench).len(), 1);
    assert_eq!(bench.machine.record().overruns, 499);
}

#[test]
fn missed_periods_count_in_the_row() {
    let late = |number, missed| Expiry {
        missed,
        ..expiry(number)
    };
    let mut bench = Bench::engaged(&after(4));
    assert_eq!(bench.machine.tick_again(late(5, 3), took(1)), Engaged);
    assert_eq!(bench.machine.record().overruns, 0, "missed is not overrun");
    // Three missed and 40 µs: from the first of them.
    assert_eq!(
        overruns(&mut bench),
        [EventKind::Overrun {
            of: Stage::Timer,
            took_ns: 75 * MS + 40_000,
            budget_ns: 25 * MS,
            longest: Stage::Timer,
        }]
    );
    assert_eq!(
        bench.machine.tick_again(late(10, 4), took(1)),
        Failsafe(Cause::Overrun),
        "at once: what was missed is over"
    );
}

#[test]
fn a_stage_has_a_budget_of_its_own() {
    let budget = Budget {
        estimate: Some(Duration::from_millis(2)),
        ..Budget::default()
    };
    let mut bench = Bench::engaged(&config(budget));
    assert_eq!(tick(&mut bench, 2, 8), Engaged);
    assert_eq!(tick(&mut bench, 3, 12), Engaged);
    assert_eq!(
        overruns(&mut bench),
        [EventKind::Overrun {
            of: Stage::Estimate,
            took_ns: 3 * MS,
            budget_ns: 2 * MS,
            longest: Stage::Control,
        }]
    );
    assert_eq!(bench.machine.record().overruns, 1);
}

#[test]
fn zero_means_never_and_the_default_is_half_a_second() {
    let mut bench = Bench::engaged(&after(0));
    for number in 2..1_000 {
        assert_eq!(tick(&mut bench, number, 500), Engaged);
    }
    let mut bench = Bench::engaged(&LoopConfig::default());
    for number in 2..22 {
        assert_eq!(tick(&mut bench, number, 26), Engaged, "{number}");
    }
    assert_eq!(tick(&mut bench, 22, 26), Failsafe(Cause::Overrun));
}

#[test]
fn a_loop_that_overruns_does_not_engage() {
    let mut bench = Bench::with(&after(2));
    for number in 1..=2 {
        assert_eq!(tick(&mut bench, number, 30), Standby);
    }
    bench.command(LoopCommand::Engage);
    assert_eq!(tick(&mut bench, 3, 1), Standby);
    let refused = EventKind::EngageRefused {
        engage_inhibits: Flags::NONE,
    };
    assert!(bench.events().contains(&refused));
    bench.command(LoopCommand::Engage);
    assert_eq!(tick(&mut bench, 4, 1), Engaged);
}

#[test]
fn failsafe_by_overruns_ends_as_any_other() {
    let mut bench = Bench::engaged(&after(1));
    assert_eq!(tick(&mut bench, 2, 26), Engaged);
    for number in 3..=4 {
        assert_eq!(tick(&mut bench, number, 26), Failsafe(Cause::Overrun));
    }
    assert_eq!(tick(&mut bench, 5, 26), Standby);
    let events = bench.events();
    let end = [change(Failsafe(Cause::Overrun), Standby), RELEASED];
    assert!(events.ends_with(&end), "{events:?}");
}

/// A standstill of 0.6 s before tick `number`, which is flown in failsafe.
fn stand_still(bench: &mut Bench, number: u64) {
    let late = Expiry {
        missed: 24,
        ..expiry(number)
    };
    let state = bench.machine.tick_again(late, took(1));
    assert_eq!(state, Failsafe(Cause::Overrun));
}

/// After how many ticks on time the failsafe before tick `number` ends, and in what; within
/// a thousand.
fn ends_after(bench: &mut Bench, number: u64) -> (u64, State) {
    for ticks in 1..1_000 {
        let state = tick(bench, number + ticks - 1, 1);
        if state != Failsafe(Cause::Overrun) {
            return (ticks, state);
        }
    }
    (1_000, Failsafe(Cause::Overrun))
}

fn held_for_5_s() -> LoopConfig {
    LoopConfig {
        failsafe_hold: Duration::from_secs(5),
        ..after(20)
    }
}

#[test]
fn a_standstill_is_flown_on_after_two_seconds_on_time() {
    let mut bench = Bench::engaged(&held_for_5_s());
    bench.stage.set(|s| s.has_recovered = true);
    stand_still(&mut bench, 100);
    // 80 periods of 25 ms.
    assert_eq!(ends_after(&mut bench, 101), (80, Engaged));
    assert_eq!(bench.stage.log().held, [true, true]);
    assert!(bench.stage.log().calls.contains(&"recover"));
}

/// A machine that is too slow for its loop does not end and begin a failsafe again and again.
#[test]
fn the_fourth_standstill_of_a_minute_is_not_flown_on() {
    let mut bench = Bench::engaged(&held_for_5_s());
    bench.stage.set(|s| s.has_recovered = true);
    for number in [100, 300, 500] {
        stand_still(&mut bench, number);
        assert_eq!(ends_after(&mut bench, number + 1), (80, Engaged));
    }
    stand_still(&mut bench, 700);
    // 200 periods of 25 ms.
    assert_eq!(ends_after(&mut bench, 701), (200, Standby));
    // A minute after the first of three was flown on, another is.
    bench.command(LoopCommand::Engage);
    assert_eq!(tick(&mut bench, 2_500, 1), Engaged);
    stand_still(&mut bench, 2_600);
    assert_eq!(ends_after(&mut bench, 2_601), (80, Engaged));
}

#[test]
fn ticks_that_go_on_overrunning_are_not_flown_on() {
    let mut bench = Bench::engaged(&held_for_5_s());
    bench
        .stage
        .set(|s| (s.has_recovered, s.unattended) = (true, true));
    stand_still(&mut bench, 100);
    for number in 101..300 {
        // Five of each six: a quarter of those that lead to failsafe.
        let total_ms = if number % 6 == 0 { 1 } else { 26 };
        let state = tick(&mut bench, number, total_ms);
        assert_eq!(state, Failsafe(Cause::Overrun), "{number}");
    }
    // One that is late by itself is not in the way.
    for number in 300..380 {
        let total_ms = if number % 40 == 0 { 26 } else { 1 };
        tick(&mut bench, number, total_ms);
    }
    assert_eq!(bench.machine.state(), Engaged);
}

#[test]
fn without_anybody_overruns_that_have_ended_are_no_reason_to_release() {
    let mut bench = Bench::engaged(&held_for_5_s());
    bench.stage.set(|s| s.unattended = true);
    stand_still(&mut bench, 100);
    for number in 101..2_000 {
        assert_eq!(tick(&mut bench, number, 1), Failsafe(Cause::Overrun));
    }
    // Those that have not are.
    for number in 2_000..2_200 {
        assert_eq!(tick(&mut bench, number, 26), Failsafe(Cause::Overrun));
    }
    for number in 2_200..2_210 {
        tick(&mut bench, number, 26);
    }
    assert_eq!(bench.machine.state(), Standby);
}

//! Ticks that leave no time to sleep: deadlines are skipped, and it ends.

use crate::bench;
use std::time::Duration;

use crate::bench::{Bench, EventKind, PERIOD, RELEASED, change, expiry};
use fcc_core::framework::State::{Engaged, Standby, Stopped};
use fcc_runtime::{Ending, LoopConfig, Machine, Overload, Parts};
use fcc_timer::{Expiry, ManualTimer, Relief, Timer, TimerError};

const MS: u64 = 1_000_000;

/// Skips after ten periods, stops after forty.
fn config() -> LoopConfig {
    LoopConfig {
        overload: Overload {
            skip_after: Some(10 * PERIOD),
            stop_after: Some(40 * PERIOD),
        },
        ..LoopConfig::default()
    }
}

/// Performs a tick; the one before it used so many milliseconds of its 25.
fn tick(bench: &mut Bench, number: u64, used_ms: u64) -> fcc_core::framework::State {
    bench.machine.tick(Expiry {
        used_ns: used_ms * MS,
        ..expiry(number)
    })
}

fn overloads(bench: &mut Bench) -> Vec<EventKind> {
    let mut events = bench.events();
    events.retain(|kind| {
        matches!(
            kind,
            EventKind::Overloaded { .. } | EventKind::OverloadOver { .. }
        )
    });
    events
}

#[test]
fn ticks_that_leave_a_twentieth_of_a_period_are_no_overload() {
    let mut bench = Bench::engaged(&config());
    for number in 2..200 {
        // 1.25 ms of 25 are a twentieth; a single tick of two periods is late.
        tick(&mut bench, number, if number == 100 { 50 } else { 23 });
    }
    assert_eq!(overloads(&mut bench), []);
    assert_eq!(bench.machine.finish().unslept, 1);
}

#[test]
fn an_overload_begins_after_its_time_and_ends_a_second_after_its_last_tick() {
    let mut bench = Bench::engaged(&config());
    for number in 2..=12 {
        assert_eq!(overloads(&mut bench), [], "{number}");
        tick(&mut bench, number, 24);
    }
    let began = EventKind::Overloaded {
        used_ns: 24 * MS,
        period_ns: 25 * MS,
    };
    assert_eq!(overloads(&mut bench), [began]);
    tick(&mut bench, 13, 30);
    // 40 ticks of 25 ms.
    for number in 14..53 {
        tick(&mut bench, number, 1);
        assert_eq!(overloads(&mut bench), [], "{number}");
    }
    tick(&mut bench, 53, 1);
    let over = EventKind::OverloadOver {
        count: 12,
        first: 2,
        last: 13,
    };
    assert_eq!(overloads(&mut bench), [over]);
}

#[test]
fn a_lasting_overload_releases_and_stops() {
    let mut bench = Bench::engaged(&config());
    for number in 2..=41 {
        assert_eq!(tick(&mut bench, number, 30), Engaged, "{number}");
    }
    bench.events();
    assert_eq!(tick(&mut bench, 42, 30), Stopped);
    let events = bench.events();
    assert_eq!(
        events,
        [
            EventKind::StoppedByOverload,
            change(Engaged, Stopped),
            RELEASED
        ]
    );
    let report = bench.machine.finish();
    assert!(matches!(report.ending, Ending::Overloaded));
    assert!(report.released);
    assert_eq!(report.unslept, 41);
}

#[test]
fn one_tick_that_leaves_time_postpones_the_stop() {
    let mut bench = Bench::engaged(&config());
    for number in 2..=120 {
        let used_ms = if number % 40 == 0 { 1 } else { 30 };
        assert_eq!(tick(&mut bench, number, used_ms), Engaged, "{number}");
    }
}

#[test]
fn it_can_be_switched_off() {
    let mut bench = Bench::engaged(&LoopConfig {
        overload: Overload {
            skip_after: None,
            stop_after: None,
        },
        ..LoopConfig::default()
    });
    for number in 2..1_000 {
        assert_eq!(tick(&mut bench, number, 60), Engaged);
    }
    assert_eq!(overloads(&mut bench), []);
}

/// What a loop asks of its timer, in order.
struct Asked {
    timer: ManualTimer,
    reliefs: std::sync::Arc<std::sync::Mutex<Vec<Relief>>>,
    /// How long each tick takes.
    ticks: Duration,
    margin: Duration,
}

impl Timer for Asked {
    fn start(&mut self) -> Result<(), TimerError> {
        self.timer.start()
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        self.timer.advance(self.ticks);
        Ok(Expiry {
            early_wake_ns: self.margin.as_nanos() as u64,
            ..self.timer.wait()?
        })
    }

    fn relieve(&mut self, relief: Relief) -> Result<(), TimerError> {
        let mut reliefs = self.reliefs.lock().unwrap();
        if reliefs.last() != Some(&relief) {
            reliefs.push(relief);
        }
        if relief != Relief::None {
            self.margin = Duration::ZERO;
        }
        self.timer.relieve(relief)
    }

    fn period(&self) -> Duration {
        self.timer.period()
    }

    fn now_ns(&self) -> i64 {
        self.timer.now_ns()
    }

    fn name(&self) -> &'static str {
        "asked"
    }
}

/// Runs a loop whose ticks take so long; returns what it asked of its timer, and
/// the missed periods of its last hundred ticks.
fn ticks_of(ticks: Duration, margin: Duration) -> (Vec<Relief>, u64) {
    let reliefs = std::sync::Arc::default();
    let asked = Asked {
        timer: ManualTimer::new(PERIOD).unwrap(),
        reliefs: std::sync::Arc::clone(&reliefs),
        ticks,
        margin,
    };
    let stage = bench::Stage::default();
    let parts = Parts {
        timer: Box::new(asked),
        ..bench::parts(&stage)
    };
    let config = LoopConfig {
        overload: Overload {
            stop_after: None,
            ..config().overload
        },
        ..config()
    };
    let (mut machine, _link) = Machine::new(parts, &config).unwrap();
    machine.start().unwrap();
    let mut missed = Vec::new();
    for _ in 0..200 {
        assert_eq!(machine.step(), Standby);
        missed.push(machine.record().tick.missed);
    }
    let reliefs = reliefs.lock().unwrap().clone();
    (reliefs, missed.iter().skip(100).sum())
}

#[test]
fn the_early_wake_goes_first_and_then_deadlines() {
    let ms = Duration::from_millis;
    // 1.2 periods: each second deadline is skipped.
    assert_eq!(
        ticks_of(ms(30), ms(2)),
        (vec![Relief::None, Relief::NoSpin, Relief::Skip], 100)
    );
    // 0.92 periods and a margin of 0.08: without the margin there is time.
    assert_eq!(
        ticks_of(ms(23), ms(2)),
        (vec![Relief::None, Relief::NoSpin], 0)
    );
    assert_eq!(ticks_of(ms(20), ms(2)), (vec![Relief::None], 0));
}

//! When the controller rehearses, and with what.
#![cfg(test)]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::framework::{Controller, Flags, Sensor, SensorFault, State, Tick};
use fcc_runtime::{LoopConfig, Machine, Parts};
use fcc_timer::ManualTimer;

/// What was called, in which tick, and with what measured.
type Calls = Arc<Mutex<Vec<(&'static str, u64, u64)>>>;

struct Counter;

impl Sensor<u64> for Counter {
    fn sample(&mut self, tick: &Tick, into: &mut u64) -> Result<(), SensorFault> {
        *into = 100 + tick.number;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "counter"
    }
}

struct Noting(Calls);

impl Noting {
    fn note(&self, what: &'static str, tick: &Tick, measured: u64) {
        self.0.lock().unwrap().push((what, tick.number, measured));
    }
}

impl Controller for Noting {
    type Measurements = u64;
    type Setpoints = ();
    type Outputs = u64;
    type Order = ();

    fn estimate(&mut self, tick: &Tick, measured: &u64) {
        self.note("tick", tick, *measured);
    }

    fn warm_up(&self, tick: &Tick, measured: &u64) {
        assert!((tick.dt_s - 0.01).abs() < 1e-12);
        self.note("rehearsal", tick, *measured);
    }

    fn blockers(&self, _: &Tick, _: &u64) -> Flags {
        Flags::NONE
    }

    fn faults(&self, _: &Tick, _: &u64) -> Flags {
        Flags::NONE
    }

    fn flag_name(_: u32) -> &'static str {
        "none"
    }

    fn engage(&mut self, _: &Tick, _: &u64) {}

    fn control(&mut self, _: &Tick, measured: &u64) -> u64 {
        *measured
    }

    fn failsafe(&mut self, _: &Tick, measured: &u64) -> u64 {
        *measured
    }

    fn setpoints(&self) {}

    fn outputs_are_valid(&self, _: &u64) -> bool {
        true
    }
}

fn calls_of(timer: ManualTimer) -> Vec<(&'static str, u64, u64)> {
    let calls = Calls::default();
    let parts = Parts {
        timer: Box::new(timer),
        sensors: vec![Box::new(Counter)],
        controller: Noting(Arc::clone(&calls)),
        actuators: Vec::new(),
    };
    let (mut machine, link) = Machine::new(parts, &LoopConfig::default()).unwrap();
    machine.start().unwrap();
    for _ in 0..3 {
        machine.step();
    }
    link.stop.stop();
    while machine.step() != State::Stopped {}
    let last = calls.lock().unwrap().len();
    machine.step();
    assert_eq!(calls.lock().unwrap().len(), last, "stopped is stopped");
    let calls = calls.lock().unwrap();
    calls[..6.min(last)].to_vec()
}

#[test]
fn each_tick_is_rehearsed_with_what_was_measured_before() {
    let timer = ManualTimer::new(Duration::from_millis(10)).unwrap();
    assert_eq!(
        calls_of(timer.with_warm_up()),
        [
            ("rehearsal", 1, 0),
            ("tick", 1, 101),
            ("rehearsal", 2, 101),
            ("tick", 2, 102),
            ("rehearsal", 3, 102),
            ("tick", 3, 103),
        ]
    );
}

#[test]
fn a_timer_that_does_not_wake_early_has_nothing_rehearsed() {
    let timer = ManualTimer::new(Duration::from_millis(10)).unwrap();
    let calls = calls_of(timer);
    assert_eq!(
        calls[..3],
        [("tick", 1, 101), ("tick", 2, 102), ("tick", 3, 103)]
    );
    assert!(calls.iter().all(|(what, ..)| *what == "tick"));
}

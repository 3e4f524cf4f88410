//! When the loop warms up, in which order, and with what.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::framework::{
    Actuator, ActuatorFault, Controller, Flags, Sensor, SensorFault, State, Tick,
};
use fcc_runtime::{LoopCommand, LoopConfig, Machine, Parts};
use fcc_timer::ManualTimer;

/// What was called, in which tick, and with what measured.
type Calls = Arc<Mutex<Vec<(&'static str, u64, u64)>>>;

struct Counter(Calls);

impl Sensor<u64> for Counter {
    fn sample(&mut self, tick: &Tick, into: &mut u64) -> Result<(), SensorFault> {
        *into = 100 + tick.number;
        Ok(())
    }

    fn warm_up(&self, tick: &Tick) {
        let call = ("warm up sensor", tick.number, 0);
        self.0.lock().unwrap().push(call);
    }

    fn name(&self) -> &'static str {
        "counter"
    }
}

struct Display(Calls);

impl Actuator<u64> for Display {
    fn apply(&mut self, tick: &Tick, outputs: &u64) -> Result<(), ActuatorFault> {
        let call = ("apply", tick.number, *outputs);
        self.0.lock().unwrap().push(call);
        Ok(())
    }

    fn warm_up(&self, tick: &Tick, outputs: &u64) {
        let call = ("warm up actuator", tick.number, *outputs);
        self.0.lock().unwrap().push(call);
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn name(&self) -> &'static str {
        "display"
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
    type Estimate = ();
    type Setpoints = ();
    type Outputs = u64;
    type Command = ();

    fn estimate(&mut self, tick: &Tick, measured: &u64) {
        self.note("tick", tick, *measured);
    }

    fn warm_up(&self, tick: &Tick, measured: &u64) {
        assert!((tick.dt_s - 0.01).abs() < 1e-12);
        self.note("warm up", tick, *measured);
    }

    fn engage_inhibits(&self, _: &Tick, _: &u64) -> Flags {
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

/// What is called in three ticks, the first of which engages.
fn calls_of(timer: ManualTimer) -> Vec<(&'static str, u64, u64)> {
    let calls = Calls::default();
    let parts = Parts {
        timer: Box::new(timer),
        sensors: vec![Box::new(Counter(Arc::clone(&calls)))],
        controller: Noting(Arc::clone(&calls)),
        actuators: vec![Box::new(Display(Arc::clone(&calls)))],
    };
    let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
    machine.start().unwrap();
    link.commands.send(LoopCommand::Engage).unwrap();
    for _ in 0..3 {
        machine.step();
    }
    let calls_of_three = calls.lock().unwrap().clone();
    link.stop.stop();
    while machine.step() != State::Stopped {}
    let last = calls.lock().unwrap().len();
    machine.step();
    assert_eq!(calls.lock().unwrap().len(), last, "stopped is stopped");
    calls_of_three
}

/// The actuator only while control is held: not before the tick that engages.
#[test]
fn each_tick_is_warmed_up_with_what_was_measured_and_sent_before() {
    let timer = ManualTimer::new(Duration::from_millis(10)).unwrap();
    assert_eq!(
        calls_of(timer.with_warm_up()),
        [
            ("warm up sensor", 1, 0),
            ("warm up", 1, 0),
            ("tick", 1, 101),
            ("apply", 1, 101),
            ("warm up sensor", 2, 0),
            ("warm up", 2, 101),
            ("warm up actuator", 2, 101),
            ("tick", 2, 102),
            ("apply", 2, 102),
            ("warm up sensor", 3, 0),
            ("warm up", 3, 102),
            ("warm up actuator", 3, 102),
            ("tick", 3, 103),
            ("apply", 3, 103),
        ]
    );
}

#[test]
fn a_timer_that_does_not_wake_early_does_not_warm_up() {
    let timer = ManualTimer::new(Duration::from_millis(10)).unwrap();
    assert_eq!(
        calls_of(timer),
        [
            ("tick", 1, 101),
            ("apply", 1, 101),
            ("tick", 2, 102),
            ("apply", 2, 102),
            ("tick", 3, 103),
            ("apply", 3, 103),
        ]
    );
}

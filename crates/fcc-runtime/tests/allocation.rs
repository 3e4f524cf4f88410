//! Ten thousand ticks and not one call of the allocator, shown by counting
//! them.
//!
//! A process of its own: what another test initialises first would not allocate here.
#![allow(clippy::unwrap_used, clippy::panic, reason = "as in any test")]

use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::framework::{
    Actuator, ActuatorFault, Controller, Flags, Reading, Sensor, SensorFault, State, Switch, Tick,
};
use fcc_runtime::{Link, LoopCommand, LoopConfig, Machine, Parts};
use fcc_timer::ManualTimer;

/// A plant that goes through everything by the tick's number alone.
struct Plant;

fcc_core::schema! {
    /// What the plant measures.
    #[derive(Clone, Copy, Debug, Default)]
    struct Measured {
        #[field(1)]
        value: f64,
        #[field(2)]
        switch: Reading<Switch>,
        #[field(3)]
        faults: Flags,
        #[field(4)]
        engage_inhibits: Flags,
    }
}

fcc_core::readings!(Measured { switch: "switch" });

/// Whether tick `number` lies in the first part of a cycle.
fn within(number: u64, part: u64, of: u64) -> bool {
    number % of < part
}

impl Sensor<Measured> for Plant {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        let n = tick.number;
        into.value = n as f64;
        let position = if within(n, 40, 100) {
            Switch::Off
        } else {
            Switch::On
        };
        into.switch = Reading::new(position, tick.woke);
        into.faults = Flags::NONE.with(Flags::bit(3), within(n, 1, 170));
        into.engage_inhibits = Flags::NONE.with(Flags::bit(4), within(n, 60, 500));
        if within(n, 3, 70) {
            return Err(SensorFault::Io { errno: 5 });
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "plant"
    }
}

/// A plant to which nothing happens.
struct Steady;

impl Sensor<Measured> for Steady {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        into.value = tick.number as f64;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "steady"
    }
}

impl Actuator<f64> for Plant {
    fn apply(&mut self, tick: &Tick, _: &f64) -> Result<(), ActuatorFault> {
        if within(tick.number, 5, 90) {
            return Err(ActuatorFault::Unconfirmed);
        }
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn name(&self) -> &'static str {
        "plant"
    }
}

struct Copying {
    invalid_every: u64,
    number: u64,
}

impl Controller for Copying {
    type Measurements = Measured;
    type Estimate = f64;
    type Setpoints = f64;
    type Outputs = f64;
    type Command = u64;

    fn estimate(&mut self, tick: &Tick, _: &Measured) {
        self.number = tick.number;
    }

    fn engage_inhibits(&self, _: &Tick, measured: &Measured) -> Flags {
        measured.engage_inhibits
    }

    fn faults(&self, _: &Tick, measured: &Measured) -> Flags {
        measured.faults
    }

    fn flag_name(_: u32) -> &'static str {
        "scripted"
    }

    fn engage(&mut self, _: &Tick, _: &Measured) {}

    fn control(&mut self, _: &Tick, measured: &Measured) -> f64 {
        if within(self.number, 1, self.invalid_every) {
            return f64::NAN;
        }
        measured.value
    }

    fn failsafe(&mut self, _: &Tick, _: &Measured) -> f64 {
        0.0
    }

    fn command(&mut self, command: &u64) {
        self.number = *command;
    }

    fn setpoints(&self) -> f64 {
        0.0
    }

    fn outputs_are_valid(&self, outputs: &f64) -> bool {
        outputs.is_finite()
    }

    fn switch(&self, measured: &Measured) -> Reading<Switch> {
        measured.switch
    }
}

fn machine(
    sensor: Box<dyn Sensor<Measured>>,
    invalid_every: u64,
    messages_capacity: usize,
) -> (Machine<Copying>, Link<Copying>) {
    let period = Duration::from_millis(25);
    let parts = Parts {
        timer: Box::new(ManualTimer::new(period).unwrap()),
        sensors: vec![sensor],
        controller: Copying {
            invalid_every,
            number: 0,
        },
        actuators: vec![Box::new(Plant)],
    };
    let config = LoopConfig {
        failsafe_hold: 8 * period,
        messages_capacity,
        ..LoopConfig::default()
    };
    let (mut machine, link) = Machine::new(parts, &config).unwrap();
    machine.start().unwrap();
    (machine, link)
}

#[test]
fn ten_thousand_engaged_ticks_do_not_allocate() {
    let (mut machine, mut link) = machine(Box::new(Steady), u64::MAX, 4_096);
    link.commands.send(LoopCommand::Engage).unwrap();
    let (engaged, calls) = allocator_calls(|| {
        (0..10_000)
            .filter(|_| {
                let state = machine.step();
                while link.messages.receive().is_some() {}
                state == State::Engaged
            })
            .count()
    });
    assert_eq!(engaged, 10_000);
    assert_eq!(calls, 0);
}

/// Switch on and off, refusals, faults, failsafe, invalid outputs, commands, and
/// a ring that overflows because nobody fetches.
#[test]
fn nothing_that_happens_allocates() {
    let (mut machine, mut link) = machine(Box::new(Plant), 330, 100);
    let mut seen = [0_u32; 3];
    let mut calls = 0;
    for n in 0..10_000 {
        let command = if within(n, 1, 230) {
            LoopCommand::Engage
        } else {
            LoopCommand::Controller(n)
        };
        link.commands.send(command).unwrap();
        let (state, during) = allocator_calls(|| machine.step());
        calls += during;
        match state {
            State::Standby => seen[0] += 1,
            State::Engaged => seen[1] += 1,
            State::Failsafe(_) => seen[2] += 1,
            State::Stopped => panic!("stopped at {n}"),
        }
        // Fetched now and then only, so that gaps of both kinds are told.
        if within(n, 1, 3_000) {
            while link.messages.receive().is_some() {}
        }
    }
    assert_eq!(calls, 0);
    assert!(seen.iter().all(|ticks| *ticks > 100), "{seen:?}");
    let report = machine.finish();
    assert!(report.failsafes > 10);
    assert!(report.records_dropped > 1_000);
    assert!(report.events_dropped > 10);
}

//! A loop on a bench: every part is a puppet that does as the script says and
//! writes down what was asked of it.
#![allow(
    dead_code,
    reason = "each test file uses the part of the bench it needs"
)]
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "as in any test"
)]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::framework::{
    Actuator, ActuatorFault, Controller, Flags, Reading, Sensor, SensorFault, State, Switch, Tick,
    Time,
};
use fcc_runtime::{Link, LoopConfig, Machine, Message, MessageOf, Parts, RecordOf};
use fcc_timer::{Expiry, Timer, TimerError};

pub(crate) type EventKind = fcc_runtime::EventKind<u32>;

/// 40 Hz.
pub(crate) const PERIOD: Duration = Duration::from_millis(25);

/// What the puppets do from now on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Script {
    /// `None`: the switch is silent, its last reading grows old.
    pub(crate) switch: Option<Switch>,
    pub(crate) blockers: Flags,
    pub(crate) faults: Flags,
    pub(crate) output: f64,
    pub(crate) failsafe_output: f64,
    pub(crate) sample: Result<(), SensorFault>,
    pub(crate) apply: Result<(), ActuatorFault>,
    pub(crate) release: Result<(), ActuatorFault>,
    pub(crate) timer: Option<TimerEnd>,
    /// The call in which a part panics.
    pub(crate) panic_in: Option<&'static str>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum TimerEnd {
    Ended,
    Failed,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            switch: None,
            blockers: Flags::NONE,
            faults: Flags::NONE,
            output: 0.5,
            failsafe_output: -0.25,
            sample: Ok(()),
            apply: Ok(()),
            release: Ok(()),
            timer: None,
            panic_in: None,
        }
    }
}

/// What was asked of the puppets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Log {
    /// Calls, those that come each tick in every state left out.
    pub(crate) calls: Vec<&'static str>,
    /// Outputs that reached the first actuator.
    pub(crate) applied: Vec<f64>,
    /// Whether each actuator holds control.
    pub(crate) held: [bool; 2],
    pub(crate) releases: [u32; 2],
    /// Numbers ordered of the controller.
    pub(crate) ordered: Vec<u32>,
    /// What the calls since the wake-up took, ns.
    pub(crate) took_ns: i64,
}

#[derive(Clone, Default)]
pub(crate) struct Stage {
    script: Arc<Mutex<Script>>,
    log: Arc<Mutex<Log>>,
}

impl Stage {
    pub(crate) fn script(&self) -> Script {
        *self.script.lock().unwrap()
    }

    pub(crate) fn set(&self, change: impl FnOnce(&mut Script)) {
        change(&mut self.script.lock().unwrap());
    }

    pub(crate) fn log(&self) -> Log {
        self.log.lock().unwrap().clone()
    }

    pub(crate) fn forget(&self) {
        let mut log = self.log.lock().unwrap();
        log.calls.clear();
        log.applied.clear();
    }

    fn note(&self, change: impl FnOnce(&mut Log)) {
        change(&mut self.log.lock().unwrap());
    }

    /// Notes a call and how long it takes, and panics in it if the script says
    /// so.
    fn called(&self, call: &'static str) {
        let took_ns = match call {
            "sample" => 1_000,
            "estimate" => 2_000,
            "guide" => 4_000,
            "control" | "failsafe" => 8_000,
            "apply" => 16_000,
            _ => 32_000,
        };
        self.note(|log| {
            log.calls.push(call);
            log.took_ns += took_ns;
        });
        self.perhaps_panic(call);
    }

    fn perhaps_panic(&self, call: &'static str) {
        let panics = self.script().panic_in == Some(call);
        assert!(!panics, "scripted panic in {call}");
    }
}

#[derive(Clone, Copy, Default, PartialEq, Debug)]
pub(crate) struct Measured {
    pub(crate) samples: u32,
    pub(crate) switch: Reading<Switch>,
}

struct Probe(Stage);

impl Sensor<Measured> for Probe {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        self.0.called("sample");
        let script = self.0.script();
        into.samples += 1;
        if let Some(position) = script.switch {
            into.switch = Reading::new(position, tick.woke);
        }
        script.sample
    }

    fn name(&self) -> &'static str {
        "probe"
    }
}

pub(crate) struct Puppet {
    stage: Stage,
    dt_s: f64,
}

impl Controller for Puppet {
    type Measurements = Measured;
    type Setpoints = f64;
    type Outputs = f64;
    type Order = u32;

    fn estimate(&mut self, tick: &Tick, _: &Measured) {
        self.dt_s = tick.dt_s;
        self.stage.called("estimate");
    }

    fn blockers(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.perhaps_panic("blockers");
        self.stage.script().blockers
    }

    fn faults(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.perhaps_panic("faults");
        self.stage.script().faults
    }

    fn flag_name(bit: u32) -> &'static str {
        ["nobody home", "too cold"]
            .get(bit as usize)
            .unwrap_or(&"unknown")
    }

    fn engage(&mut self, _: &Tick, _: &Measured) {
        self.stage.called("engage");
    }

    fn guide(&mut self, _: &Tick, _: &Measured) {
        self.stage.called("guide");
    }

    fn control(&mut self, _: &Tick, _: &Measured) -> f64 {
        self.stage.called("control");
        self.stage.script().output
    }

    fn failsafe(&mut self, _: &Tick, _: &Measured) -> f64 {
        self.stage.called("failsafe");
        self.stage.script().failsafe_output
    }

    fn disengage(&mut self) {
        self.stage.called("disengage");
    }

    fn command(&mut self, order: &u32) {
        self.stage.called("command");
        self.stage.note(|log| log.ordered.push(*order));
    }

    fn setpoints(&self) -> f64 {
        self.stage.perhaps_panic("setpoints");
        self.dt_s
    }

    fn outputs_are_valid(&self, outputs: &f64) -> bool {
        self.stage.perhaps_panic("outputs_are_valid");
        outputs.abs() <= 1.0
    }

    fn switch(&self, measured: &Measured) -> Reading<Switch> {
        measured.switch
    }
}

/// The first lies before the second: what it does must not keep the second
/// from being released.
struct Arm(Stage, usize);

impl Actuator<f64> for Arm {
    fn apply(&mut self, _: &Tick, outputs: &f64) -> Result<(), ActuatorFault> {
        self.0.note(|log| log.held[self.1] = true);
        if self.1 == 1 {
            return Ok(());
        }
        self.0.called("apply");
        self.0.note(|log| log.applied.push(*outputs));
        self.0.script().apply
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.note(|log| log.releases[self.1] += 1);
        if self.1 == 0 {
            self.0.called("release");
            self.0.script().release?;
        }
        self.0.note(|log| log.held[self.1] = false);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "arm"
    }
}

/// Never waits; ends or fails when the script says so.
struct Clock {
    stage: Stage,
    number: u64,
}

impl Timer for Clock {
    fn start(&mut self) -> Result<(), TimerError> {
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        self.stage.perhaps_panic("wait");
        match self.stage.script().timer {
            Some(TimerEnd::Ended) => return Err(TimerError::Ended),
            Some(TimerEnd::Failed) => return Err(TimerError::NotStarted),
            None => self.number += 1,
        }
        self.stage.note(|log| log.took_ns = 0);
        Ok(expiry(self.number))
    }

    fn period(&self) -> Duration {
        PERIOD
    }

    fn now_ns(&self) -> i64 {
        expiry(self.number).woke_ns + self.stage.log().took_ns
    }

    fn name(&self) -> &'static str {
        "bench"
    }
}

/// Deadline `number`, woken 40 µs late.
pub(crate) fn expiry(number: u64) -> Expiry {
    let scheduled_ns = 25_000_000 * number as i64;
    Expiry {
        number,
        scheduled_ns,
        woke_ns: scheduled_ns + 40_000,
        ..Expiry::default()
    }
}

pub(crate) fn parts(stage: &Stage) -> Parts<Puppet> {
    Parts {
        timer: Box::new(Clock {
            stage: stage.clone(),
            number: 0,
        }),
        sensors: vec![Box::new(Probe(stage.clone()))],
        controller: Puppet {
            stage: stage.clone(),
            dt_s: 0.0,
        },
        actuators: vec![
            Box::new(Arm(stage.clone(), 0)),
            Box::new(Arm(stage.clone(), 1)),
        ],
    }
}

/// A machine with its puppets.
pub(crate) struct Bench {
    pub(crate) machine: Machine<Puppet>,
    pub(crate) link: Link<Puppet>,
    pub(crate) stage: Stage,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self::with(&LoopConfig::default())
    }

    pub(crate) fn with(config: &LoopConfig) -> Self {
        let stage = Stage::default();
        let (machine, link) = Machine::new(parts(&stage), config).unwrap();
        let mut bench = Self {
            machine,
            link,
            stage,
        };
        bench.machine.start().unwrap();
        bench
    }

    /// A bench whose machine is engaged, with nothing left to fetch.
    pub(crate) fn engaged(config: &LoopConfig) -> Self {
        let mut bench = Self::with(config);
        bench.order(fcc_runtime::Order::Engage);
        assert_eq!(bench.machine.step(), State::Engaged);
        bench.events();
        bench.stage.forget();
        bench
    }

    pub(crate) fn order(&mut self, order: fcc_runtime::Order<u32>) {
        self.link.orders.send(order).unwrap();
    }

    /// Changes the script and performs a tick.
    pub(crate) fn tick(&mut self, change: impl FnOnce(&mut Script)) -> State {
        self.stage.set(change);
        self.machine.step()
    }

    pub(crate) fn messages(&mut self) -> Vec<MessageOf<Puppet>> {
        std::iter::from_fn(|| self.link.messages.receive()).collect()
    }

    /// Fetches all; what happened, but for the orders: those the script knows.
    pub(crate) fn events(&mut self) -> Vec<EventKind> {
        happened(self.messages())
    }

    /// Fetches all; the records.
    pub(crate) fn records(&mut self) -> Vec<RecordOf<Puppet>> {
        self.messages()
            .into_iter()
            .filter_map(|message| match message {
                Message::Tick(record) => Some(record),
                Message::Event(_) => None,
            })
            .collect()
    }
}

/// What happened, but for the orders.
pub(crate) fn happened(messages: Vec<MessageOf<Puppet>>) -> Vec<EventKind> {
    messages
        .into_iter()
        .filter_map(|message| match message {
            Message::Event(event) => Some(event.kind),
            Message::Tick(_) => None,
        })
        .filter(|kind| !matches!(kind, EventKind::Ordered(_)))
        .collect()
}

pub(crate) fn change(from: State, to: State) -> EventKind {
    EventKind::StateChanged { from, to }
}

pub(crate) const RELEASED: EventKind = EventKind::Released { ok: true };

/// The time of the bench's deadline `number`.
pub(crate) fn due(number: u64) -> Time {
    Time::from_nanos(expiry(number).scheduled_ns)
}

//! A loop on a bench: every part is a stub that follows a script and records its
//! calls.
#![allow(
    dead_code,
    reason = "each test file uses the part of the bench it needs"
)]
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "as in any test"
)]

mod stubs;

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::framework::{
    ActuatorFault, Cause, Flags, Notice, Reading, SensorFault, State, Switch, Time,
};
use fcc_runtime::{Link, LoopConfig, Machine, Message, MessageOf, RecordOf};
use fcc_timer::Expiry;

pub(crate) use stubs::{Stub, parts};

pub(crate) type EventKind = fcc_runtime::EventKind<u32>;

/// 40 Hz.
pub(crate) const PERIOD: Duration = Duration::from_millis(25);

/// A fault of the sensors, and the cause of a failsafe that it is.
pub(crate) const LOST: Flags = Flags::bit(1);
pub(crate) const SENSORS_LOST: Cause = Cause::Faults(LOST);

/// A failsafe of four periods, and a switch that is silent after two.
pub(crate) fn config() -> LoopConfig {
    LoopConfig {
        failsafe_hold: 4 * PERIOD,
        switch_max_age: 2 * PERIOD,
        ..LoopConfig::default()
    }
}

/// What the stubs do from now on.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is the answer of one method"
)]
pub(crate) struct Script {
    /// `None`: the switch is silent, its last reading grows old.
    pub(crate) switch: Option<Switch>,
    pub(crate) engage_inhibits: Flags,
    pub(crate) faults: Flags,
    pub(crate) goes_on: bool,
    pub(crate) has_recovered: bool,
    pub(crate) unattended: bool,
    pub(crate) must_release: Flags,
    pub(crate) taken_over: Flags,
    pub(crate) withholds: bool,
    /// Whether the controller prepares a release, and is ready for it.
    pub(crate) prepares_release: Option<bool>,
    /// What the controller notices in each tick.
    pub(crate) notices: &'static [Notice],
    pub(crate) conditions: Flags,
    pub(crate) output: f64,
    pub(crate) failsafe_output: f64,
    pub(crate) sample: Result<(), SensorFault>,
    pub(crate) ready: Result<(), ActuatorFault>,
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
            engage_inhibits: Flags::NONE,
            faults: Flags::NONE,
            goes_on: false,
            has_recovered: false,
            unattended: false,
            must_release: Flags::NONE,
            taken_over: Flags::NONE,
            withholds: false,
            prepares_release: None,
            notices: &[],
            conditions: Flags::NONE,
            output: 0.5,
            failsafe_output: -0.25,
            sample: Ok(()),
            ready: Ok(()),
            apply: Ok(()),
            release: Ok(()),
            timer: None,
            panic_in: None,
        }
    }
}

/// The calls that the stubs received.
#[derive(Clone, Debug, Default)]
pub(crate) struct Log {
    /// Calls, those that come each tick in every state left out.
    pub(crate) calls: Vec<&'static str>,
    /// Outputs that reached the first actuator.
    pub(crate) applied: Vec<f64>,
    /// Whether each actuator holds control.
    pub(crate) held: [bool; 2],
    pub(crate) releases: [u32; 2],
    /// Numbers commanded of the controller.
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

fcc_core::schema! {
    /// What the sensors measure.
    #[derive(Clone, Copy, Default, PartialEq, Debug)]
    pub(crate) struct Measured {
        #[field(1)]
        pub(crate) samples: u32,
        #[field(2)]
        pub(crate) switch: Reading<Switch>,
    }
}

fcc_core::readings!(Measured { switch: "switch" });

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

/// A machine with its stubs.
pub(crate) struct Bench {
    pub(crate) machine: Machine<Stub>,
    pub(crate) link: Link<Stub>,
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

    /// A bench whose machine is engaged, with all messages read.
    pub(crate) fn engaged(config: &LoopConfig) -> Self {
        let mut bench = Self::with(config);
        bench.command(fcc_runtime::LoopCommand::Engage);
        assert_eq!(bench.machine.step(), State::Engaged);
        bench.events();
        bench.stage.forget();
        bench
    }

    pub(crate) fn command(&mut self, command: fcc_runtime::LoopCommand<u32>) {
        self.link.commands.send(command).unwrap();
    }

    /// Changes the script and performs a tick.
    pub(crate) fn tick(&mut self, change: impl FnOnce(&mut Script)) -> State {
        self.stage.set(change);
        self.machine.step()
    }

    /// Moves the switch, for the two ticks after which its position counts.
    pub(crate) fn turn(&mut self, position: Switch) -> State {
        self.tick(|s| s.switch = Some(position));
        self.tick(|_| {})
    }

    pub(crate) fn messages(&mut self) -> Vec<MessageOf<Stub>> {
        std::iter::from_fn(|| self.link.messages.receive()).collect()
    }

    /// Reads all messages; returns the events except commands, which the script knows.
    pub(crate) fn events(&mut self) -> Vec<EventKind> {
        happened(self.messages())
    }

    /// Reads all messages; returns the records.
    pub(crate) fn records(&mut self) -> Vec<RecordOf<Stub>> {
        self.messages()
            .into_iter()
            .filter_map(|message| match message {
                Message::Tick(record) => Some(record),
                Message::Event(_) => None,
            })
            .collect()
    }
}

/// The events except commands.
pub(crate) fn happened(messages: Vec<MessageOf<Stub>>) -> Vec<EventKind> {
    messages
        .into_iter()
        .filter_map(|message| match message {
            Message::Event(event) => Some(event.kind),
            Message::Tick(_) => None,
        })
        .filter(|kind| !matches!(kind, EventKind::CommandReceived(_)))
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

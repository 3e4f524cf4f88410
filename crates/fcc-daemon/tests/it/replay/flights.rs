//! Flights in lockstep, with all messages of the loop.

use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{LoopCommand, Message, Record, Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_flight::config::{BuiltInSection, Config, FailsafeSection, GustsChoice};
use fcc_flight::flight::assemble;
use fcc_flight::replay::replay;
use fcc_replay::{Identity, Run, run};
use fcc_runtime::{Machine, Parts};
use fcc_telemetry::FlightMessage;
use fcc_timer::ManualTimer;

/// Events in a flight, other than gusts.
#[derive(Default)]
pub(crate) struct Happenings {
    /// Commands given before a step.
    pub(crate) commands: Vec<(u64, LoopCommand<AutopilotCommand>)>,
    /// Ticks in which the sensors are silent.
    pub(crate) silent: Vec<RangeInclusive<u64>>,
    /// Deadlines for which the loop wakes late.
    pub(crate) late: Vec<(u64, Duration)>,
    /// Set the stop flag before this step.
    pub(crate) stop_before: Option<u64>,
    /// From this tick on the first sensor's gyroscope is wrong by 5 °/s in pitch.
    pub(crate) biased_from: Option<u64>,
    /// Adds a second sensor with the same measurements, which is never silent.
    pub(crate) seconded: bool,
    /// Length of the flight, steps.
    pub(crate) steps: u64,
}

/// Gusts, noise and delay: all disturbances of the built-in aircraft.
pub(crate) fn rough() -> Config {
    Config {
        built_in: Some(BuiltInSection {
            gusts: GustsChoice::Moderate,
            noise: true,
            delay_ms: 50,
            wind_kt: 20.0,
            seed: 7,
            ..BuiltInSection::default()
        }),
        // A silent aircraft is lost as soon as a silent sensor.
        failsafe: FailsafeSection {
            all_silent_s: 0.25,
            ..FailsafeSection::default()
        },
        ..Config::default()
    }
}

/// Flies, and returns all messages.
pub(crate) fn fly(config: &Config, happenings: &Happenings) -> Vec<FlightMessage> {
    let assembly = assemble(config).unwrap();
    let mut timer = ManualTimer::new(config.tick.period()).unwrap();
    for (number, by) in &happenings.late {
        timer = timer.late_at(*number, *by);
    }
    let mut last = Arc::default();
    let silenced = |inner| {
        last = Arc::default();
        Box::new(Silenced {
            inner,
            silent: happenings.silent.clone(),
            biased_from: happenings.biased_from,
            measured: Arc::clone(&last),
        }) as Box<dyn Sensor<Measurements>>
    };
    let mut sensors: Vec<_> = assembly.sensors.into_iter().map(silenced).collect();
    if happenings.seconded {
        sensors.push(Box::new(Second(last)));
    }
    let parts = Parts {
        timer: Box::new(timer),
        sensors,
        controller: *assembly.autopilot,
        actuators: assembly.actuators,
    };
    let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();
    let mut messages = Vec::new();
    for step in 1..=happenings.steps {
        for (_, command) in happenings.commands.iter().filter(|(at, _)| *at == step) {
            link.commands.send(*command).unwrap();
        }
        if happenings.stop_before == Some(step) {
            link.stop.stop();
        }
        let state = machine.step();
        messages.extend(std::iter::from_fn(|| link.messages.receive()));
        if state == State::Stopped {
            break;
        }
    }
    messages
}

/// A sensor that is silent for a while.
struct Silenced {
    inner: Box<dyn Sensor<Measurements>>,
    silent: Vec<RangeInclusive<u64>>,
    biased_from: Option<u64>,
    /// What it measures.
    measured: Arc<Mutex<Measurements>>,
}

impl Sensor<Measurements> for Silenced {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut measured = self.measured.lock().unwrap();
        let sampled = self.inner.sample(tick, &mut measured);
        if self.silent.iter().any(|span| span.contains(&tick.number)) {
            // The aircraft flies on without measurements.
            return Err(SensorFault::Silent);
        }
        *into = *measured;
        if self.biased_from.is_some_and(|from| tick.number >= from) {
            into.raw_body_rates.value.pitch_radps += 5.0_f64.to_radians();
        }
        sampled
    }

    fn name(&self) -> &str {
        self.inner.name()
    }
}

/// Measures the same as the first sensor.
struct Second(Arc<Mutex<Measurements>>);

impl Sensor<Measurements> for Second {
    fn sample(&mut self, _: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        *into = *self.0.lock().unwrap();
        Ok(())
    }

    fn name(&self) -> &'static str {
        "second"
    }
}

/// Replays a recording.
pub(crate) fn again(config: &Config, messages: &[FlightMessage]) -> (Run, Identity) {
    let mut identity = Identity::of::<Autopilot>();
    let run = run(
        &mut replay(config).unwrap(),
        messages.iter().copied(),
        |recorded, again| {
            identity.take(recorded, again);
        },
    );
    (run, identity)
}

pub(crate) fn records<M: Copy, E: Copy, S: Copy, O: Copy, R>(
    messages: &[Message<M, E, S, O, R>],
) -> Vec<Record<M, E, S, O>> {
    let record = |message: &Message<M, E, S, O, R>| match message {
        Message::Tick(record) => Some(*record),
        Message::Event(_) => None,
    };
    messages.iter().filter_map(record).collect()
}

//! A flight of the whole loop: the adapter, the machine, the autopilot.

use std::time::Duration;

use fcc_core::framework::{Event, EventKind, LoopCommand, Message, State};
use fcc_fixed_wing::{Autopilot, AutopilotConfig, StickTakeover};
use fcc_flight::flight::true_sample;
use fcc_guidance::{GuidanceConfig, TimedPatternConfig};
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_sim::{Severity, SimConfig};
use fcc_telemetry::{LegScore, PatternScorer};
use fcc_timer::{Expiry, ManualTimer};
use fcc_xplane::{XPlane, XPlaneConfig};

use crate::simulator_silence::world::{Manner, Wire};

pub(crate) const PERIOD_NS: i64 = 25_000_000;

type Kind = EventKind<fcc_fixed_wing::AutopilotCommand>;

pub(crate) struct Flight {
    pub(crate) wire: Wire,
    machine: Machine<Autopilot>,
    link: Link<Autopilot>,
    scorer: PatternScorer,
    tick: i64,
    events: Vec<Event<fcc_fixed_wing::AutopilotCommand>>,
    seen: usize,
    /// The bank commanded in the last tick.
    commanded_rad: Option<f64>,
    /// The leg in the last tick, and when it began and the last gap ended.
    leg: u32,
    leg_began: i64,
    gap_ended: i64,
    largest_step_rad: f64,
}

impl Flight {
    /// Engaged at frames of a rate, with jitter unless its seed is 0.
    pub(crate) fn engaged(frame_hz: f64, jitter: u64) -> Self {
        let wire = Wire::new(frame_hz, jitter, &SimConfig::default());
        Self::engaged_over(wire, AutopilotConfig::default().guidance)
    }

    /// Straight and level in moderate turbulence.
    pub(crate) fn in_turbulence(seed: u64) -> Self {
        let config = SimConfig {
            gusts: Some(Severity::Moderate),
            seed,
            ..SimConfig::default()
        };
        Self::engaged_over(Wire::new(60.0, 0, &config), GuidanceConfig::Hold)
    }

    fn engaged_over(wire: Wire, guidance: GuidanceConfig) -> Self {
        let config = XPlaneConfig {
            pilot_controls: true,
            ..XPlaneConfig::default()
        };
        let (sensor, actuator) = XPlane::over(&config, wire.clone(), None).unwrap();
        let parts = Parts {
            timer: Box::new(ManualTimer::new(Duration::from_nanos(PERIOD_NS as u64)).unwrap()),
            sensors: vec![Box::new(sensor)],
            controller: Autopilot::new(AutopilotConfig {
                guidance,
                stick_takeover: Some(StickTakeover {
                    threshold: 0.3,
                    after: Duration::from_millis(200),
                }),
                ..AutopilotConfig::default()
            }),
            actuators: vec![Box::new(actuator)],
        };
        // The wire's switch stays off.
        let config = LoopConfig {
            command_needs_switch: false,
            ..LoopConfig::default()
        };
        let (mut machine, link) = Machine::new(parts, &config).unwrap();
        machine.start().unwrap();
        let GuidanceConfig::TimedPattern(pattern) = AutopilotConfig::default().guidance else {
            panic!("the default");
        };
        let _: TimedPatternConfig = pattern;
        let mut flight = Self {
            wire,
            machine,
            link,
            scorer: PatternScorer::new(pattern),
            tick: 0,
            events: Vec::new(),
            seen: 0,
            commanded_rad: None,
            leg: 0,
            leg_began: 0,
            gap_ended: 0,
            largest_step_rad: 0.0,
        };
        flight.run(Manner::Flying, 5.0);
        flight.link.commands.send(LoopCommand::Engage).unwrap();
        flight.run(Manner::Flying, 0.1);
        assert_eq!(flight.state(), State::Engaged, "{:?}", flight.events);
        flight.events();
        flight
    }

    /// Runs the loop while the simulator does this.
    pub(crate) fn run(&mut self, manner: Manner, seconds: f64) {
        self.wire.world().manner = manner;
        for _ in 0..(seconds * 1e9 / PERIOD_NS as f64).round() as u32 {
            self.step(0);
        }
    }

    /// The same, engaged throughout.
    pub(crate) fn during(&mut self, manner: Manner, seconds: f64) {
        self.run(manner, seconds);
        self.wire.world().manner = Manner::Flying;
        let last = self.events.len().saturating_sub(6);
        assert_eq!(
            self.state(),
            State::Engaged,
            "{manner:?}: {:?}",
            &self.events[last..]
        );
    }

    pub(crate) fn fly(&mut self, seconds: f64) {
        self.during(Manner::Flying, seconds);
    }

    /// Our process misses this many periods.
    pub(crate) fn miss(&mut self, periods: i64) {
        self.step(periods as u64);
    }

    fn step(&mut self, missed: u64) {
        self.tick += 1 + missed as i64;
        let now_ns = self.tick * PERIOD_NS;
        self.wire.world().advance_to(now_ns);
        self.machine.tick(Expiry {
            number: self.tick as u64,
            scheduled_ns: now_ns,
            woke_ns: now_ns,
            missed,
            ..Expiry::default()
        });
        let before = self.events.len();
        while let Some(message) = self.link.messages.receive() {
            if let Message::Event(event) = message {
                self.events.push(event);
            }
        }
        let record = self.machine.record();
        let (state, setpoints) = (record.state.state(), record.setpoints);
        let truth = self.wire.world().aircraft.truth();
        let sample = Some(true_sample(truth.time_s, &truth));
        self.scorer.take(state, &setpoints.guidance, sample, sample);
        let noticed = |event: &Event<_>| matches!(event.kind, EventKind::Noticed(_));
        if self.events[before..].iter().any(noticed) {
            self.gap_ended = self.tick;
        }
        if self.leg != setpoints.guidance.item {
            self.leg = setpoints.guidance.item;
            self.leg_began = self.tick;
        }
        // The next tick flies to a new leg's targets: with a step, unless it
        // began in a gap.
        let is_step = self.tick <= self.leg_began + 1 && self.leg_began > self.gap_ended;
        if let Some(last_rad) = self.commanded_rad
            && !is_step
        {
            let step_rad = (setpoints.roll_rad - last_rad).abs();
            self.largest_step_rad = self.largest_step_rad.max(step_rad);
        }
        self.commanded_rad = (state == State::Engaged).then_some(setpoints.roll_rad);
    }

    /// Cuts the link from the simulator, and the one to it unless it still
    /// hears.
    pub(crate) fn cut(&mut self, hears: bool) {
        let mut world = self.wire.world();
        world.sends = false;
        world.hears = hears;
    }

    /// Cuts the link to the simulator only: its incoming connections are
    /// switched off.
    pub(crate) fn deafen(&mut self) {
        self.wire.world().hears = false;
    }

    pub(crate) fn restore(&mut self) {
        let mut world = self.wire.world();
        world.sends = true;
        world.hears = true;
    }

    pub(crate) fn disengage(&mut self) {
        self.link.commands.send(LoopCommand::Disengage).unwrap();
    }

    pub(crate) fn state(&self) -> State {
        self.machine.state()
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.tick as u64
    }

    /// The events since the last call.
    pub(crate) fn events(&mut self) -> Vec<Kind> {
        let new = self.events[self.seen..]
            .iter()
            .map(|event| event.kind)
            .collect();
        self.seen = self.events.len();
        new
    }

    /// The tick of the release at once.
    pub(crate) fn released_in_tick(&self) -> Option<u64> {
        let released = |kind: &Kind| matches!(kind, EventKind::ReleasedAtOnce { .. });
        self.events
            .iter()
            .find(|event| released(&event.kind))
            .map(|event| event.tick)
    }

    pub(crate) fn true_bank_deg(&self) -> f64 {
        let roll_rad = self.wire.world().aircraft.truth().roll_rad;
        roll_rad.to_degrees()
    }

    pub(crate) fn true_altitude_m(&self) -> f64 {
        self.wire.world().aircraft.truth().altitude_m
    }

    pub(crate) fn rudder(&self) -> f64 {
        self.machine.record().outputs.rudder
    }

    pub(crate) fn largest_bank_step_deg(&self) -> f64 {
        self.largest_step_rad.to_degrees()
    }

    /// Flies on until this long after engaging, by the simulator's time; the
    /// worst leg.
    pub(crate) fn flown(mut self, seconds: f64) -> LegScore {
        while self.machine.record().setpoints.guidance.elapsed_s < seconds {
            self.fly(1.0);
        }
        self.scorer.result().0.worst.unwrap()
    }
}

//! A flight of the built-in aircraft by a plan.

use std::fmt::Write as _;
use std::time::Duration;

use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, LoopCommand, Sensor, SensorFault, Tick};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_flight::config::{Config, PreparedPlan};
use fcc_flight::flight::assemble;
use fcc_guidance::Mode;
use fcc_plan::{Home, Item, Place, Plan};
use fcc_runtime::{Link, Machine, Message, Parts};
use fcc_sim::TruthHandle;
use fcc_telemetry::FlightRecord;
use fcc_timer::ManualTimer;
use tempfile::TempDir;

pub(crate) const HOME: Place = Place {
    latitude_deg: 47.0,
    longitude_deg: 8.0,
};
pub(crate) const ALTITUDE_M: f64 = 914.4;

/// A plan from home along courses, with legs of a length, as a `QGC WPL 110`.
pub(crate) fn legs(courses_deg: &[f64], length_m: f64, radius_m: f64) -> String {
    let mut text = line(0, 16, [0.0; 4], HOME);
    let mut at = HOME;
    for (n, course_deg) in courses_deg.iter().enumerate() {
        at = at.ahead(*course_deg, length_m);
        text += &line(n + 1, 16, [0.0, radius_m, 0.0, 0.0], at);
    }
    format!("QGC WPL 110\n{text}")
}

pub(crate) fn line(number: usize, command: u16, parameters: [f64; 4], at: Place) -> String {
    let [a, b, c, d] = parameters;
    let (latitude, longitude) = (at.latitude_deg, at.longitude_deg);
    format!("{number} 0 0 {command} {a} {b} {c} {d} {latitude:.9} {longitude:.9} {ALTITUDE_M} 1\n")
}

/// A sensor without a reading, which is taken out of its measurements.
pub(crate) struct Without(
    pub(crate) Box<dyn Sensor<Measurements>>,
    pub(crate) fn(&mut Measurements),
);

impl Sensor<Measurements> for Without {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn sample(&mut self, tick: &Tick, measurements: &mut Measurements) -> Result<(), SensorFault> {
        self.0.sample(tick, measurements)?;
        (self.1)(measurements);
        Ok(())
    }
}

/// A flight of the built-in aircraft.
pub(crate) struct Flight {
    pub(crate) machine: Machine<Autopilot>,
    pub(crate) link: Link<Autopilot>,
    pub(crate) truth: TruthHandle,
    pub(crate) plan: Plan,
    pub(crate) config: Config,
    pub(crate) record: FlightRecord,
    pub(crate) events: Vec<String>,
    pub(crate) folder: TempDir,
}

impl Flight {
    pub(crate) fn new(plan: &str, keys: &str) -> Self {
        Self::with(plan, keys, |sensor| sensor)
    }

    /// With sensors that are put around the aircraft's.
    pub(crate) fn with(
        plan: &str,
        keys: &str,
        around: impl Fn(Box<dyn Sensor<Measurements>>) -> Box<dyn Sensor<Measurements>>,
    ) -> Self {
        Self::between(plan, keys, around, |actuator| actuator)
    }

    /// With sensors and actuators that are put around the aircraft's.
    pub(crate) fn between(
        plan: &str,
        keys: &str,
        around: impl Fn(Box<dyn Sensor<Measurements>>) -> Box<dyn Sensor<Measurements>>,
        around_actuator: impl Fn(Box<dyn Actuator<Surfaces>>) -> Box<dyn Actuator<Surfaces>>,
    ) -> Self {
        let timer = ManualTimer::new(Duration::from_millis(25)).unwrap();
        Self::timed(timer, plan, keys, around, around_actuator)
    }

    /// With sensors that are put around the aircraft's, and a warm-up before each tick, which
    /// takes as long as the tick.
    pub(crate) fn warmed_up(
        plan: &str,
        keys: &str,
        around: impl Fn(Box<dyn Sensor<Measurements>>) -> Box<dyn Sensor<Measurements>>,
    ) -> Self {
        let timer = ManualTimer::new(Duration::from_millis(25)).unwrap();
        Self::timed(timer.with_warm_up(), plan, keys, around, |actuator| {
            actuator
        })
    }

    fn timed(
        timer: ManualTimer,
        plan: &str,
        keys: &str,
        around: impl Fn(Box<dyn Sensor<Measurements>>) -> Box<dyn Sensor<Measurements>>,
        around_actuator: impl Fn(Box<dyn Actuator<Surfaces>>) -> Box<dyn Actuator<Surfaces>>,
    ) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.waypoints");
        std::fs::write(&file, plan).unwrap();
        let mut text = String::from("[guidance]\nmode = \"plan\"\n");
        write!(text, "[plan]\nfile = {:?}\n{keys}", file.to_str().unwrap()).unwrap();
        let mut config = Config::parse(&text, "test").unwrap();
        config.load_plan(1_790_000_000).unwrap();
        let assembly = assemble(&config).unwrap();
        let parts = Parts {
            timer: Box::new(timer),
            sensors: assembly.sensors.into_iter().map(around).collect(),
            controller: Autopilot::new(*assembly.autopilot.config()),
            actuators: assembly
                .actuators
                .into_iter()
                .map(around_actuator)
                .collect(),
        };
        let (mut machine, link) = Machine::new(parts, &assembly.loop_config).unwrap();
        machine.start().unwrap();
        Self {
            machine,
            link,
            truth: assembly.true_now.unwrap(),
            plan: config.plan.plan().unwrap().clone(),
            config,
            record: FlightRecord::default(),
            events: Vec::with_capacity(1_000),
            folder,
        }
    }

    /// One tick; what happened in it is added to the events.
    pub(crate) fn tick(&mut self) {
        let _ = self.machine.step();
        self.receive();
    }

    /// What happened in the ticks since the last time is added to the events.
    pub(crate) fn receive(&mut self) {
        while let Some(message) = self.link.messages.receive() {
            match message {
                Message::Tick(record) => self.record = record,
                Message::Event(event) => {
                    let text = event.kind.description::<Autopilot>().to_string();
                    self.events.push(text);
                }
            }
        }
    }

    pub(crate) fn fly_until(&mut self, most_s: f64, mut until: impl FnMut(&Self) -> bool) {
        for _ in 0..(most_s * 40.0) as usize {
            self.tick();
            if until(self) {
                return;
            }
        }
        panic!("after {most_s} s: {:#?}", self.events);
    }

    pub(crate) fn mode(&self) -> Mode {
        self.record.setpoints.guidance.mode
    }

    pub(crate) fn command(&mut self, command: AutopilotCommand) {
        let command = LoopCommand::Controller(command);
        self.link.commands.send(command).unwrap();
    }

    /// A plan that is ready to be flown from an item on, uploaded at a time, s; none if it
    /// cannot be flown.
    pub(crate) fn prepared(&self, plan: &str, item: u16, uploaded_s: u64) -> Option<PreparedPlan> {
        let file = self.folder.path().join("next.waypoints");
        std::fs::write(&file, plan).unwrap();
        self.config.prepare_plan(&file, item, uploaded_s).ok()
    }

    pub(crate) fn happened(&self, text: &str) -> bool {
        self.events.iter().any(|event| event == text)
    }

    /// Where the aircraft is: the built-in one flies over a flat earth that touches the
    /// ellipsoid where it began.
    pub(crate) fn place(&self) -> Place {
        let truth = self.truth.get();
        let (north, east) = metres_per_radian(HOME.latitude_deg.to_radians(), 0.0);
        Place {
            latitude_deg: HOME.latitude_deg + (truth.north_m / north).to_degrees(),
            longitude_deg: HOME.longitude_deg + (truth.east_m / east).to_degrees(),
        }
    }

    pub(crate) fn distance_m(&self, to: Place) -> f64 {
        self.place().to(to).0
    }
}

pub(crate) fn place_of(plan: &Plan, number: usize) -> Place {
    match number {
        0 => plan.home.map(|home: Home| home.place).unwrap(),
        number => plan.item(number).and_then(Item::place).unwrap(),
    }
}

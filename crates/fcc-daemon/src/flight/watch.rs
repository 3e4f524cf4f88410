//! Takes what the loop tells, and keeps what matters later.

use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_core::flight::{Course, Order};
use fcc_core::framework::{EventKind, Message, State};
use fcc_sim::Truth;
use fcc_telemetry::{FlightEvent, FlightLog, FlightMessage, FlightRecord, Sample};

use super::Pilot;
use super::assemble::Assembly;
use super::fly::Plan;
use super::live::Live;
use super::outcome::EventEntry;
use super::status;
use super::tap::TruthReceiver;

const M_FT: f64 = 1.0 / 0.304_8;
const MPS_KT: f64 = 3_600.0 / 1_852.0;
const G_MPS2: f64 = 9.806_65;

/// Takes what the loop tells, and keeps what matters later.
pub(super) struct Watch {
    names: Names,
    truth: Option<TruthReceiver>,
    log: Option<FlightLog>,
    events: Vec<EventEntry>,
    start_ns: Option<i64>,
    engaged_at_s: Option<f64>,
    now_s: f64,
    tick: u64,
    woke_ns: i64,
    failed: bool,
    announce: bool,
    status: Option<status::Printer>,
    /// Who watches from elsewhere.
    pub(super) live: Live,
}

impl Watch {
    /// Watches a flight along a course.
    pub(super) fn new(
        course: &Course,
        truth: Option<TruthReceiver>,
        plan: Plan,
        names: Names,
        live: Live,
    ) -> Self {
        Self {
            names,
            truth,
            log: pattern(course).map(FlightLog::new),
            events: Vec::new(),
            start_ns: None,
            engaged_at_s: None,
            now_s: 0.0,
            tick: 0,
            woke_ns: i64::MIN,
            failed: false,
            announce: plan.announce,
            status: (!plan.quiet).then(status::Printer::default),
            live,
        }
    }

    /// Takes one message.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        match message {
            Message::Tick(record) => self.record(record),
            Message::Event(event) => self.event(event),
        }
    }

    /// Seconds since the loop was engaged; none while it is not.
    pub(super) fn engaged_for_s(&self) -> Option<f64> {
        self.engaged_at_s.map(|at_s| self.now_s - at_s)
    }

    /// Whether the loop fell into failsafe.
    pub(super) fn failed(&self) -> bool {
        self.failed
    }

    /// What was kept: events, and the log of the flight.
    pub(super) fn into_parts(self) -> (Vec<EventEntry>, Option<FlightLog>) {
        (self.events, self.log)
    }

    fn record(&mut self, record: &FlightRecord) {
        self.live.record(record);
        self.now_s = self.seconds(record.tick.scheduled.as_nanos());
        self.tick = record.tick.number;
        self.woke_ns = record.tick.woke.as_nanos();
        let truth = self
            .truth
            .as_mut()
            .and_then(|truth| truth.of_tick(record.tick.number));
        if record.state == State::Engaged {
            if self.engaged_at_s.is_none() {
                self.engaged_at_s = Some(self.now_s);
                if let Some(log) = &mut self.log {
                    log.clear();
                }
            }
            let sample = match truth {
                Some(truth) => true_sample(self.now_s, &truth),
                None => measured_sample(self.now_s, record),
            };
            if let Some(log) = &mut self.log {
                log.push(sample);
            }
        } else {
            self.engaged_at_s = None;
        }
        if let Some(status) = &mut self.status {
            status.record(record, self.now_s, self.engaged_at_s);
        }
    }

    fn event(&mut self, event: &FlightEvent) {
        let entry = EventEntry {
            time_s: self.seconds(event.time.as_nanos()),
            tick: event.tick,
            text: self.names.words(event.kind),
        };
        self.live.event(event, &entry.text);
        self.failed |= matches!(
            event.kind,
            EventKind::StateChanged {
                to: State::Failsafe(_),
                ..
            }
        );
        self.keep(entry);
    }

    /// Something that the loop itself does not know.
    pub(super) fn remark(&mut self, text: String) {
        self.live.remark(self.tick, self.woke_ns, &text);
        self.keep(EventEntry {
            time_s: self.now_s,
            tick: self.tick,
            text,
        });
    }

    fn keep(&mut self, entry: EventEntry) {
        if self.announce {
            eprintln!("{:8.2} s  {}", entry.time_s, entry.text);
        }
        self.events.push(entry);
    }

    /// Seconds since the first thing the loop told; an event before the first
    /// tick is at 0.
    fn seconds(&mut self, nanos: i64) -> f64 {
        if nanos == i64::MIN {
            return 0.0;
        }
        let start = *self.start_ns.get_or_insert(nanos);
        (nanos - start) as f64 * 1e-9
    }
}

/// What sensors and actuators are called: the loop knows them by their places.
pub(super) struct Names {
    sensors: Vec<&'static str>,
    actuators: Vec<&'static str>,
}

impl Names {
    pub(super) fn of(assembly: &Assembly) -> Self {
        Self {
            sensors: assembly.sensors.iter().map(|s| s.name()).collect(),
            actuators: assembly.actuators.iter().map(|a| a.name()).collect(),
        }
    }

    /// What is flown: by what it is sensed.
    pub(super) fn aircraft(&self) -> String {
        self.sensors.join(", ")
    }

    fn words(&self, kind: EventKind<Order>) -> String {
        let sensor = |index: u16| self.sensors.get(usize::from(index)).unwrap_or(&"?");
        let actuator = |index: u16| self.actuators.get(usize::from(index)).unwrap_or(&"?");
        match kind {
            EventKind::SensorFault { index, fault } => {
                format!("sensor {}: {fault}", sensor(index))
            }
            EventKind::SensorRecovered { index } => {
                format!("sensor {}: works again", sensor(index))
            }
            EventKind::ActuatorFault { index, fault } => {
                format!("actuator {}: {fault}", actuator(index))
            }
            EventKind::ActuatorRecovered { index } => {
                format!("actuator {}: works again", actuator(index))
            }
            kind => kind.words::<Pilot>().to_string(),
        }
    }
}

fn pattern(course: &Course) -> Option<TimedPatternConfig> {
    match course {
        Course::TimedPattern(pattern) => Some(*pattern),
        Course::Hold => None,
    }
}

fn true_sample(time_s: f64, truth: &Truth) -> Sample {
    Sample {
        time_s,
        heading_deg: truth.heading_rad.to_degrees(),
        altitude_ft: truth.altitude_m * M_FT,
        airspeed_kt: truth.indicated_airspeed_mps * MPS_KT,
        lateral_g: truth.specific_force.y_mps2 / G_MPS2,
    }
}

fn measured_sample(time_s: f64, record: &FlightRecord) -> Sample {
    let measured = &record.measurements;
    Sample {
        time_s,
        heading_deg: measured.heading_rad.value.to_degrees(),
        altitude_ft: measured.altitude_m.value * M_FT,
        airspeed_kt: measured.airspeed_mps.value * MPS_KT,
        lateral_g: measured.specific_force.value.y_mps2 / G_MPS2,
    }
}

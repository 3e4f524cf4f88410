//! Takes what the loop tells, and keeps what matters later.

use fcc_core::flight::AutopilotCommand;
use fcc_core::flight::guidance::{GuidanceConfig, TimedPatternConfig};
use fcc_core::framework::{self, EventKind, Message, State};
use fcc_runtime::CommandSender;
use fcc_sim::Truth;
use fcc_telemetry::units::{G_MPS2, M_FT, MPS_KT};
use fcc_telemetry::{
    FlightEvent, FlightLog, FlightMessage, FlightRecord, Sample, ScoredBy, event_words,
};

use super::assemble::Assembly;
use super::connection::Connection;
use super::live::Live;
use super::outcome::EventEntry;
use super::plan::{Length, Lines, Plan};
use super::restart::{Restart, RestartRequest};
use super::service::Service;
use super::status::StatusLines;
use super::truth_recorder::TruthReceiver;

/// The most events that are kept for the end.
const MOST_EVENTS: usize = 10_000;

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
    refused: bool,
    lines: Lines,
    status: Option<StatusLines>,
    /// Who watches from elsewhere.
    pub(super) live: Live,
    /// Who started this.
    pub(super) service: Service,
    /// What would have to be known to start again in flight.
    pub(super) restart: Option<Restart>,
}

impl Watch {
    /// Watches a flight with this guidance.
    pub(super) fn new(
        guidance: &GuidanceConfig,
        truth: Option<TruthReceiver>,
        plan: Plan,
        names: Names,
        live: Live,
        lines: Lines,
    ) -> Self {
        Self {
            names,
            truth,
            log: pattern(guidance).map(FlightLog::new),
            events: Vec::new(),
            start_ns: None,
            engaged_at_s: None,
            now_s: 0.0,
            tick: 0,
            woke_ns: i64::MIN,
            failed: false,
            refused: false,
            lines,
            status: (!plan.quiet).then(StatusLines::default),
            live,
            service: Service::from_environment(),
            restart: None,
        }
    }

    /// Takes one message.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        self.service.take(message);
        if let Some(restart) = &mut self.restart {
            restart.take(message);
        }
        match message {
            Message::Tick(record) => self.record(record),
            Message::Event(event) => self.event(event),
        }
    }

    /// Whether a flight of this length is over: its time is up, or it cannot be
    /// flown.
    pub(super) fn is_over(&self, length: Length) -> bool {
        // Sums of ticks end this close to a whole second.
        const ROUNDING_S: f64 = 1e-6;
        let time_is_up = match length {
            Length::Open => return false,
            Length::Engaged(seconds) => self
                .engaged_at_s
                .is_some_and(|at_s| self.now_s - at_s >= seconds - ROUNDING_S),
            Length::Whole(seconds) => self.now_s >= seconds - ROUNDING_S,
        };
        time_is_up || self.failed || self.refused
    }

    /// Whether engaging was refused.
    pub(super) const fn was_refused(&self) -> bool {
        self.refused
    }

    /// What the flight is scored by.
    pub(super) const fn scored_by(&self) -> ScoredBy {
        match self.truth {
            Some(_) => ScoredBy::Truth,
            None => ScoredBy::Measurement,
        }
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
            // Where there is truth, a tick without it is left out: sensors and
            // truth do not mix in one score.
            let sample = match truth {
                Some(truth) => Some(true_sample(self.now_s, &truth)),
                None if self.truth.is_some() => None,
                None => Some(Sample::measured(record, self.now_s)),
            };
            if let Some((log, sample)) = self.log.as_mut().zip(sample) {
                log.push(sample);
            }
        } else {
            self.engaged_at_s = None;
        }
        if let Some(status) = &mut self.status
            && let Some(line) = status.record(record, self.now_s, self.engaged_at_s)
        {
            (self.lines)(line);
        }
    }

    fn event(&mut self, event: &FlightEvent) {
        let entry = EventEntry {
            time_s: self.seconds(event.time.as_nanos()),
            tick: event.tick,
            text: event_words(event, &self.names.sensors, &self.names.actuators),
        };
        self.live.event(event, &entry.text);
        self.failed |= matches!(
            event.kind,
            EventKind::StateChanged {
                to: State::Failsafe(_),
                ..
            }
        );
        self.refused |= matches!(event.kind, EventKind::EngageRefused { .. });
        if matches!(
            event.kind,
            EventKind::CommandReceived(framework::LoopCommand::Controller(_))
        ) {
            // What is flown is not the pattern from its beginning: no score.
            self.log = None;
        }
        self.keep(entry);
    }

    /// Looks at what a flight before this one left, and keeps this one for the
    /// next; what there is to say.
    pub(super) fn begin_restart(&mut self, wish: Option<RestartRequest>) -> Option<String> {
        let (restart, words) = Restart::begin(wish?);
        self.restart = restart;
        words
    }

    /// Goes on with what a restart in flight asks for; what is new, in words.
    pub(super) fn poll_restart(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        connection: Option<&mut Connection>,
    ) -> Option<String> {
        self.restart.as_mut()?.poll(commands, || {
            if let Some(connection) = connection {
                connection.take_over_from_release_helper();
            }
        })
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

    /// Something that is said and not kept: it is no part of the flight.
    pub(super) fn mention(&mut self, text: &str) {
        (self.lines)(format!("{:8.2} s  {text}", self.now_s));
    }

    fn keep(&mut self, entry: EventEntry) {
        (self.lines)(format!("{:8.2} s  {}", entry.time_s, entry.text));
        // A flight may take weeks; the recording has them all.
        if self.events.len() < MOST_EVENTS {
            self.events.push(entry);
        }
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
#[derive(Clone)]
pub(super) struct Names {
    pub(super) sensors: Vec<String>,
    pub(super) actuators: Vec<String>,
}

impl Names {
    pub(super) fn of(assembly: &Assembly) -> Self {
        let sensors = assembly.sensors.iter().map(|s| s.name().to_owned());
        let actuators = assembly.actuators.iter().map(|a| a.name().to_owned());
        Self {
            sensors: sensors.collect(),
            actuators: actuators.collect(),
        }
    }

    /// What is flown: by what it is sensed.
    pub(super) fn aircraft(&self) -> String {
        self.sensors.join(", ")
    }
}

fn pattern(guidance: &GuidanceConfig) -> Option<TimedPatternConfig> {
    match guidance {
        GuidanceConfig::TimedPattern(pattern) => Some(*pattern),
        GuidanceConfig::Hold => None,
    }
}

/// A sample of a flight as it truly was, for scoring.
pub fn true_sample(time_s: f64, truth: &Truth) -> Sample {
    Sample {
        time_s,
        heading_deg: truth.heading_rad.to_degrees(),
        altitude_ft: truth.altitude_m * M_FT,
        airspeed_kt: truth.indicated_airspeed_mps * MPS_KT,
        lateral_g: truth.specific_force.y_mps2 / G_MPS2,
    }
}

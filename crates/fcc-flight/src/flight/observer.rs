//! Who observes a flight, and what it may do beside.

use fcc_core::flight::AutopilotCommand;
use fcc_record::RecorderStatus;
use fcc_runtime::CommandSender;
use fcc_telemetry::{FlightEvent, FlightRecord};
use fcc_timer::RealtimeGranted;

use super::outcome::Outcome;
use super::plan::Pace;

/// Observes a flight: a recorder, live telemetry, a status line, a score.
///
/// Called in the thread that fetches the loop's messages, never in the loop's.
/// Observers do not know each other: what one [reports](Reports), all others
/// get. Every call may come in any flight: no record before an event, reports
/// before the beginning, an end without a record.
pub trait Observer {
    /// The flight is about to begin, and no loop runs yet: what takes its time
    /// is done here.
    fn prepare(&mut self, _reports: &mut Reports) {}

    /// The loop begins.
    fn begin(&mut self, _facts: &Facts<'_>, _reports: &mut Reports) {}

    /// A tick.
    fn record(&mut self, _record: &FlightRecord, _at: &FlightTime) {}

    /// Something that happened in the loop, and the same in words.
    fn event(&mut self, _event: &FlightEvent, _words: &str, _at: &FlightTime) {}

    /// Something that the loop itself does not know.
    fn report(&mut self, _report: &Report, _at: &FlightTime) {}

    /// All messages that there are have been handed over; called 50 times a
    /// second, and in lockstep after each tick.
    fn poll(&mut self, _access: &mut Access<'_>) {}

    /// The loop ends, or hangs.
    fn stopping(&mut self) {}

    /// The flight is over and the controls are given back: this may wait, for a
    /// while. What it adds to the outcome, if anything. Nothing is handed over
    /// later.
    fn end(&mut self, _ending: &str, _outcome: &mut Outcome, _reports: &mut Reports) {}
}

/// What is known of a flight when it begins.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Ticks a second.
    pub rate_hz: f64,
    /// What wakes the loop.
    pub timer: &'static str,
    /// What the sensors are called, in the loop's command.
    pub sensors: &'a [String],
    /// What the actuators are called, in the loop's command.
    pub actuators: &'a [String],
    /// The time of day, ns since 1970.
    pub started_unix_ns: u64,
    /// What is added to the loop's clock to get the time of day, ns.
    pub clock_offset_ns: i64,
    /// How fast time passes.
    pub pace: Pace,
    /// What the kernel granted the loop's thread; none in lockstep.
    pub granted: Option<&'a RealtimeGranted>,
}

/// When something was in a flight.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FlightTime {
    /// Since the first that the loop reported, s.
    pub time_s: f64,
    /// The tick.
    pub tick: u64,
    /// That tick's wake-up, ns on the loop's clock; the smallest number there
    /// is before the first tick.
    pub woke_ns: i64,
    /// When the loop was engaged, s; none while it is not.
    pub engaged_at_s: Option<f64>,
}

impl Default for FlightTime {
    /// Before the first tick.
    fn default() -> Self {
        Self {
            time_s: 0.0,
            tick: 0,
            woke_ns: i64::MIN,
            engaged_at_s: None,
        }
    }
}

/// Something that the loop itself does not know.
#[derive(Clone, Debug)]
pub enum Report {
    /// It is part of the flight, and is kept.
    Remark(String),
    /// It is for whoever is there, and no part of the flight.
    Mention(String),
    /// How recording goes.
    Recording(RecorderStatus),
}

/// Takes what an observer has to report.
#[derive(Default, Debug)]
pub struct Reports(Vec<Report>);

impl Reports {
    /// Something that is part of the flight, and is kept.
    pub fn remark(&mut self, words: impl Into<String>) {
        self.0.push(Report::Remark(words.into()));
    }

    /// Something for whoever is there, and no part of the flight.
    pub fn mention(&mut self, words: impl Into<String>) {
        self.0.push(Report::Mention(words.into()));
    }

    /// How recording goes.
    pub fn recording(&mut self, status: RecorderStatus) {
        self.0.push(Report::Recording(status));
    }

    /// All that was reported since the last call.
    pub fn take(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.0)
    }
}

/// What an observer may do beside observing.
pub struct Access<'a> {
    /// Commands to the loop.
    pub commands: &'a mut CommandSender<AutopilotCommand>,
    /// What there is to report.
    pub reports: &'a mut Reports,
    /// To be called right before a command that takes control by itself.
    pub before_control: &'a mut dyn FnMut(),
}

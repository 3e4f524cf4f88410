//! The observers of a flight.

use std::sync::Arc;

use fcc_core::framework::{Controller, EventOf, RecordOf};
use fcc_record::RecorderStatus;
use fcc_runtime::CommandSender;
use fcc_timer::RealtimeGranted;

use super::outcome::Outcome;
use super::plan::Pace;
use crate::config::PreparedPlan;

/// Observes a run of a loop with the controller `C`, here a flight: a recorder,
/// live telemetry, a status line, a score.
///
/// Called in the thread that reads the loop's messages, never in the loop's.
/// Observers are independent of each other: what one [reports](Reports), all
/// others receive. The calls of a flight may be incomplete: an event before any
/// record, reports before the beginning, an end without a record.
pub trait Observer<C: Controller> {
    /// The flight is about to begin, and no loop runs yet: time-consuming
    /// preparations are done here.
    fn prepare(&mut self, _reports: &mut Reports) {}

    /// The loop begins.
    fn begin(&mut self, _facts: &Facts<'_>, _reports: &mut Reports) {}

    /// A tick.
    fn record(&mut self, _record: &RecordOf<C>, _at: &FlightTime) {}

    /// An event of the loop, and its description.
    fn event(&mut self, _event: &EventOf<C>, _description: &str, _at: &FlightTime) {}

    /// Something reported from outside the loop.
    fn report(&mut self, _report: &Report, _at: &FlightTime) {}

    /// All available messages have been passed on; called 50 times a second,
    /// and in lockstep after each tick.
    fn poll(&mut self, _access: &mut Access<'_, C::Command>) {}

    /// The loop ends, or hangs.
    fn stopping(&mut self) {}

    /// The flight is over and the controls are released: this may wait, for a
    /// limited time. Adds its part to the outcome, if any. No other call
    /// follows.
    fn end(&mut self, _ending: &str, _outcome: &mut Outcome, _reports: &mut Reports) {}
}

/// The facts of a flight at its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Ticks per second.
    pub rate_hz: f64,
    /// What wakes the loop.
    pub timer: &'static str,
    /// The names of the sensors, in the loop's order.
    pub sensors: &'a [String],
    /// The names of the actuators, in the loop's order.
    pub actuators: &'a [String],
    /// The time of day, ns since 1970.
    pub started_unix_ns: u64,
    /// The offset from the loop's clock to the time of day, ns.
    pub clock_offset_ns: i64,
    /// The pace of time.
    pub pace: Pace,
    /// What the kernel granted the loop's thread; none in lockstep.
    pub granted: Option<&'a RealtimeGranted>,
}

/// A time in a flight.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FlightTime {
    /// Since the loop's first message, s.
    pub time_s: f64,
    /// The tick.
    pub tick: u64,
    /// That tick's wake-up, ns on the loop's clock; the smallest possible
    /// number before the first tick.
    pub woke_ns: i64,
    /// When the loop engaged, s; none while it is not engaged.
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

/// Something reported from outside the loop.
#[derive(Clone, Debug)]
pub enum Report {
    /// A remark that is part of the flight and is recorded.
    Remark(String),
    /// A message for the user that is not recorded.
    Mention(String),
    /// The status of the recording.
    Recording(RecorderStatus),
    /// A plan that may replace the one that is flown, before its command.
    Plan(Arc<PreparedPlan>),
}

/// Collects the reports of observers.
#[derive(Default, Debug)]
pub struct Reports {
    new: Vec<Report>,
    commander: String,
}

impl Reports {
    /// Adds a remark that is part of the flight and is recorded.
    pub fn remark(&mut self, words: impl Into<String>) {
        self.new.push(Report::Remark(words.into()));
    }

    /// Whose commands come next; the remark, if another one sent those before.
    pub fn commander(&mut self, who: &str) -> Option<String> {
        if self.commander == who {
            return None;
        }
        who.clone_into(&mut self.commander);
        let words = format!("commands come from {who}");
        self.remark(words.clone());
        Some(words)
    }

    /// Adds a message for the user that is not recorded.
    pub fn mention(&mut self, words: impl Into<String>) {
        self.new.push(Report::Mention(words.into()));
    }

    /// The status of the recording.
    pub fn recording(&mut self, status: RecorderStatus) {
        self.new.push(Report::Recording(status));
    }

    /// A plan that may replace the one that is flown, before its command.
    pub fn plan(&mut self, plan: Arc<PreparedPlan>) {
        self.new.push(Report::Plan(plan));
    }

    /// All that was reported since the last call.
    pub fn take(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.new)
    }
}

/// What an observer may do in addition to observing.
pub struct Access<'a, R> {
    /// Commands to the loop.
    pub commands: &'a mut CommandSender<R>,
    /// The reports.
    pub reports: &'a mut Reports,
    /// To be called directly before a command that takes control by itself.
    pub before_control: &'a mut dyn FnMut(),
}

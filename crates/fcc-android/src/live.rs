//! The state for the screens: written by the thread that reads the loop's
//! messages, read by the app's threads. The loop's thread never waits for it.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, State};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_flight::flight::{
    Access, Conclusion, EventEntry, Facts, Flapping, FlightTime, Observer, Outcome, Report, Reports,
};
use fcc_phone::{PhoneHandle, SensorHealth};
use fcc_record::RecorderStatus;
use fcc_telemetry::{FlightEvent, FlightRecord, Realtime, TimingReport, expiry_of};
use fcc_timer::{TimerError, TimingStats};
use serde::Serialize;

use crate::listener::{Notice, Notifier};
use crate::now::Now;

/// The newest reports that are kept: a screen of them.
const MOST_REPORTS: usize = 50;
/// How often the phone's sensors are shown.
const SENSORS_EVERY: Duration = Duration::from_millis(200);
/// How often the statistics of the timing are computed.
const TIMING_EVERY: Duration = Duration::from_millis(500);

/// Whether a loop hangs in this process: nothing flies in it again, by whatever computer.
static HUNG: AtomicBool = AtomicBool::new(false);

/// What a screen shows. Its JSON is described in android/README.md.
#[derive(Clone, Debug, Default, Serialize)]
struct Shown {
    /// Whether a loop runs.
    flying: bool,
    /// A loop hangs in this process, and nothing flies in it again.
    hung: bool,
    /// What the user should know about the configuration.
    remarks: Vec<String>,
    /// The names of what is read, in the order of preference; none before a flight.
    sources: Vec<String>,
    /// The names of what is controlled.
    actuators: Vec<String>,
    /// The newest tick; none before the first.
    now: Option<Now>,
    /// What the kernel granted the loop's thread; none before a flight.
    granted: Option<Granted>,
    /// Performance hints for the loop's thread; none before a flight.
    performance_hints: Option<ShownHints>,
    /// Of the flight so far; none before its first second is over.
    timing: Option<TimingReport>,
    recording: Option<Recording>,
    /// The phone's sensors, of a flight by them.
    sensors: Vec<SensorHealth>,
    /// The newest events and remarks, oldest first.
    reports: VecDeque<EventEntry>,
    /// The outcome of the last flight, as `fccd run --json` prints it; none
    /// before, or if it ended by an error of the program.
    outcome: Option<serde_json::Value>,
    /// Why the last flight ended.
    ending: Option<String>,
}

/// What the kernel granted.
#[derive(Clone, Debug, Serialize)]
struct Granted {
    /// Without effect under `SCHED_FIFO`.
    nice: i8,
    #[serde(flatten)]
    realtime: Realtime,
}

/// Performance hints for the loop's thread.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub(crate) struct ShownHints {
    /// Whether there is a session for the loop's thread.
    pub(crate) session: bool,
    /// Why there is none.
    pub(crate) why: Option<String>,
    /// How long the system was told that a tick may take.
    pub(crate) target_us: f64,
    /// How often it was told how long one took.
    pub(crate) reports: u64,
}

/// The state of the recorder.
#[derive(Clone, Debug, Serialize)]
struct Recording {
    file: Option<String>,
    ticks: u64,
    bytes: u64,
    not_recorded: u64,
    stopped: Option<String>,
}

impl From<&RecorderStatus> for Recording {
    fn from(status: &RecorderStatus) -> Self {
        Self {
            file: status.file.as_ref().map(|file| file.display().to_string()),
            ticks: status.ticks,
            bytes: status.bytes,
            not_recorded: status.not_recorded,
            stopped: status.stopped.clone(),
        }
    }
}

/// Whether a loop of this process hangs.
pub(crate) fn is_hung() -> bool {
    HUNG.load(Ordering::SeqCst)
}

/// The state that is shared with the app's threads.
pub(crate) struct Live(Mutex<Shown>);

impl Live {
    pub(crate) fn new(remarks: Vec<String>) -> Self {
        Self(Mutex::new(Shown {
            remarks,
            ..Shown::default()
        }))
    }

    pub(crate) fn to_json(&self) -> String {
        let mut shown = self.lock().clone();
        shown.hung = is_hung();
        // A struct of numbers and texts can be written.
        serde_json::to_string(&shown).unwrap_or_default()
    }

    pub(crate) fn show_hints(&self, hints: &ShownHints) {
        self.lock().performance_hints = Some(hints.clone());
    }

    /// The flight is over, or did not begin.
    pub(crate) fn end(&self, outcome: Option<&Outcome>, ending: &str) {
        let mut shown = self.lock();
        shown.flying = false;
        if outcome.is_some_and(|outcome| outcome.conclusion == Conclusion::Hung) {
            HUNG.store(true, Ordering::SeqCst);
        }
        shown.outcome = outcome.and_then(|outcome| serde_json::to_value(outcome).ok());
        shown.ending = Some(ending.to_owned());
    }

    fn lock(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Writes the state of a flight, and tells the app's listener.
pub(crate) struct LiveObserver {
    live: Arc<Live>,
    notifier: Notifier,
    timing: TimingStats,
    timed: Instant,
    timer: &'static str,
    realtime: Realtime,
    /// The newest record that is not in the state yet.
    newest: Option<(FlightRecord, FlightTime)>,
    missed: u64,
    state: Option<State>,
    /// Changes of state that the app is told when its screens can read them.
    changed: Vec<State>,
    flapping: Flapping,
    phone: PhoneHandle,
    sensors_seen: Instant,
}

impl LiveObserver {
    /// For a loop of this period.
    ///
    /// # Errors
    /// When no statistics can be kept for it.
    pub(crate) fn new(
        live: &Arc<Live>,
        notifier: &Notifier,
        phone: PhoneHandle,
        period: Duration,
    ) -> Result<Self, TimerError> {
        Ok(Self {
            live: Arc::clone(live),
            notifier: notifier.clone(),
            timing: TimingStats::new(period)?,
            timed: Instant::now(),
            timer: "",
            realtime: Realtime::default(),
            newest: None,
            missed: 0,
            state: None,
            changed: Vec::new(),
            flapping: Flapping::default(),
            phone,
            sensors_seen: Instant::now(),
        })
    }

    fn keep(&self, text: &str, at: &FlightTime) {
        let mut shown = self.live.lock();
        if shown.reports.len() >= MOST_REPORTS {
            shown.reports.pop_front();
        }
        shown.reports.push_back(EventEntry {
            time_s: at.time_s,
            tick: at.tick,
            text: text.to_owned(),
        });
        drop(shown);
        self.notifier.tell(Notice::Report(text.to_owned()));
    }
}

impl Observer<Autopilot> for LiveObserver {
    fn begin(&mut self, facts: &Facts<'_>, _: &mut Reports) {
        self.timer = facts.timer;
        self.realtime = facts.granted.map(Realtime::from).unwrap_or_default();
        let mut shown = self.live.lock();
        *shown = Shown {
            flying: true,
            remarks: std::mem::take(&mut shown.remarks),
            sources: facts.sensors.to_vec(),
            actuators: facts.actuators.to_vec(),
            granted: facts.granted.map(|granted| Granted {
                nice: granted.nice,
                realtime: self.realtime.clone(),
            }),
            ..Shown::default()
        };
    }

    fn record(&mut self, record: &FlightRecord, at: &FlightTime) {
        let tick = &record.tick;
        self.timing.record(&expiry_of(record));
        self.missed += tick.missed;
        self.newest = Some((*record, *at));
        for line in self
            .flapping
            .summaries(at.time_s, false)
            .collect::<Vec<_>>()
        {
            self.keep(&line, at);
        }
        let state = record.state.state();
        if self.state.replace(state) != Some(state) {
            self.changed.push(state);
        }
    }

    fn event(&mut self, event: &FlightEvent, words: &str, at: &FlightTime) {
        let is_own_command = matches!(event.kind, EventKind::CommandReceived(_));
        if !is_own_command && self.flapping.passes(&event.kind, words, at.time_s) {
            self.keep(words, at);
        }
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        match report {
            Report::Remark(words) | Report::Mention(words) => self.keep(words, at),
            Report::Recording(status) => self.live.lock().recording = Some(status.into()),
            Report::Plan(_) => {}
        }
    }

    fn poll(&mut self, _: &mut Access<'_, AutopilotCommand>) {
        if self.sensors_seen.elapsed() >= SENSORS_EVERY {
            self.sensors_seen = Instant::now();
            let sensors = self.phone.sensors();
            self.live.lock().sensors = sensors;
        }
        let Some((record, at)) = self.newest.take() else {
            return;
        };
        let timing = (self.timed.elapsed() >= TIMING_EVERY).then(|| {
            self.timed = Instant::now();
            TimingReport::new(self.timer, &self.timing.summary(), self.realtime.clone())
        });
        let now = Now::of(&record, &at, self.missed);
        let mut shown = self.live.lock();
        shown.now = Some(now);
        if timing.is_some() {
            shown.timing = timing;
        }
        drop(shown);
        for state in self.changed.drain(..) {
            self.notifier.tell(Notice::State(state.to_string()));
        }
    }
}

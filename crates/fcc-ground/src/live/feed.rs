//! What one daemon publishes, as the pages read it.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use fcc_live::{EVENT_HISTORY, Event, Info, RecorderState, RowWatcher, Status, WatchError};
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::{FlightRecord, Instance, not_started};
use serde_json::{Value, json};
use tokio::sync::{broadcast, watch};

use super::Machine;
use super::track::Track;
use crate::columns::Columns;

/// How long nothing may come before it is looked whether the daemon lives.
const SILENT: Duration = Duration::from_millis(500);
/// How often a thread looks for a new record.
const LOOK_EVERY: (Duration, Duration) = (Duration::from_millis(1), Duration::from_millis(5));
const OPENED_WITHIN: Duration = Duration::from_secs(10);

/// The newest tick: as it is sent, and as it was published.
#[derive(Clone, Debug, Default)]
pub(crate) struct Newest {
    pub(crate) bytes: Bytes,
    pub(crate) row: Arc<[u64]>,
}

/// One daemon.
#[derive(Debug)]
pub(crate) struct Feed {
    pub(crate) instance: Instance,
    pub(crate) info: Info,
    pub(crate) columns: Columns,
    /// Its records are those of this program's aircraft.
    pub(crate) is_flight: bool,
    record: watch::Sender<Newest>,
    status: watch::Sender<Utf8Bytes>,
    events: broadcast::Sender<Utf8Bytes>,
    past: Mutex<VecDeque<Utf8Bytes>>,
    /// The columns of the position, and where it was.
    position: Option<[usize; 2]>,
    track: Mutex<Track>,
    ended: AtomicBool,
    end: watch::Sender<Utf8Bytes>,
}

fn flight() -> RecordDescription {
    RecordDescription::of::<FlightRecord>()
}

impl Feed {
    /// Starts to watch a daemon, in a thread of its own.
    pub(super) fn start(instance: &Instance, machine: Machine) -> Result<Arc<Self>, String> {
        let (send, opened) = mpsc::channel();
        let name = instance.clone();
        thread::Builder::new()
            .name("ground-feed".to_owned())
            .spawn(move || match RowWatcher::open(&name) {
                Err(error) => drop(send.send(Err(error.to_string()))),
                Ok(watcher) if watcher.columns().is_of_another_plant(&flight()) => {
                    let plant = watcher.info().plant;
                    drop(send.send(Err(format!("{plant}: see fccd top, this shows aeroplanes"))));
                }
                Ok(mut watcher) => {
                    let feed = Arc::new(Self::new(&watcher));
                    if send.send(Ok(Arc::clone(&feed))).is_ok() {
                        let why = Self::follow(&feed, &mut watcher, &machine);
                        feed.finish(&why);
                    }
                }
            })
            .map_err(|error| not_started(error).to_string())?;
        let opened = opened.recv_timeout(OPENED_WITHIN);
        opened.unwrap_or_else(|_| Err(format!("fccd '{instance}' does not answer")))
    }

    fn new(watcher: &RowWatcher) -> Self {
        let columns = Columns::of(watcher.columns());
        let latitude = columns.index("estimated_latitude_rad");
        Self {
            instance: watcher.instance().clone(),
            info: *watcher.info(),
            position: latitude
                .zip(columns.index("estimated_longitude_rad"))
                .map(Into::into),
            track: Mutex::default(),
            columns,
            is_flight: watcher.columns().has_layout_of(&flight()),
            record: watch::Sender::default(),
            status: watch::Sender::default(),
            events: broadcast::Sender::new(EVENT_HISTORY),
            past: Mutex::default(),
            ended: AtomicBool::new(false),
            end: watch::Sender::default(),
        }
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }

    pub(crate) fn records(&self) -> watch::Receiver<Newest> {
        self.record.subscribe()
    }

    pub(super) fn statuses(&self) -> watch::Receiver<Utf8Bytes> {
        self.status.subscribe()
    }

    pub(super) fn ends(&self) -> watch::Receiver<Utf8Bytes> {
        self.end.subscribe()
    }

    /// The events until now, and those from now on.
    pub(crate) fn events(&self) -> (Vec<Utf8Bytes>, broadcast::Receiver<Utf8Bytes>) {
        let past = self.past.lock().unwrap_or_else(PoisonError::into_inner);
        (past.iter().cloned().collect(), self.events.subscribe())
    }

    /// The word of a column in the newest record.
    pub(crate) fn word(&self, column: &str) -> Option<u64> {
        let row = Arc::clone(&self.record.borrow().row);
        self.columns.word(self.columns.index(column)?, &row)
    }

    /// Where it was until now, as a message to a page.
    pub(super) fn track(&self) -> Value {
        let track = self.track.lock().unwrap_or_else(PoisonError::into_inner);
        track.message()
    }

    /// The first message to a page.
    pub(super) fn hello(&self) -> Value {
        json!({ "hello": {
            "instance": self.instance,
            "plant": self.info.plant.as_str(),
            "rate_hz": self.info.rate_hz,
            "started_ns": self.info.started_ns,
            "run_started_utc_s": self.info.started_unix_ns as f64 * 1e-9,
            "columns": self.columns.all,
        }})
    }

    /// Follows the daemon until it has ended, or nobody else has the feed; returns why.
    fn follow(this: &Arc<Self>, watcher: &mut RowWatcher, machine: &Machine) -> String {
        let half_period = Duration::try_from_secs_f64(0.5 / this.info.rate_hz);
        let look_every =
            half_period.map_or(LOOK_EVERY.1, |half| half.clamp(LOOK_EVERY.0, LOOK_EVERY.1));
        let mut heard = Instant::now();
        while Arc::strong_count(this) > 1 {
            match this.take(watcher, machine) {
                Err(error) => return error.to_string(),
                Ok(true) => heard = Instant::now(),
                Ok(false) if heard.elapsed() > SILENT => {
                    if !watcher.is_alive() {
                        return WatchError::Ended(this.instance.clone()).to_string();
                    }
                    heard = Instant::now();
                }
                Ok(false) => {}
            }
            thread::sleep(look_every);
        }
        "the station has ended".to_owned()
    }

    /// Takes what is new; returns whether there was anything.
    fn take(&self, watcher: &mut RowWatcher, machine: &Machine) -> Result<bool, WatchError> {
        let newest = watcher.newest(|row| Newest {
            bytes: self.columns.encode(row).into(),
            row: row.into(),
        })?;
        let is_new = newest.is_some();
        if let Some(newest) = newest {
            if let Some(position) = self.position {
                let place = position.map(|column| self.columns.value(column, &newest.row));
                let mut track = self.track.lock().unwrap_or_else(PoisonError::into_inner);
                track.add(place);
            }
            self.record.send_replace(newest);
        }
        while let Some(event) = watcher.next_event()? {
            self.event(&event);
        }
        if let Some(status) = watcher.latest_status()? {
            let status = json!({ "status": self.status(&status, machine) });
            self.status.send_replace(status.to_string().into());
        }
        Ok(is_new)
    }

    fn event(&self, event: &Event) {
        let text = json!({ "event": {
            "tick": event.tick,
            "time_s": self.seconds(event.time_ns),
            "code": event.code,
            "index": event.index,
            "values": event.values,
            "text": event.text.as_str(),
        }});
        let text = Utf8Bytes::from(text.to_string());
        let mut past = self.past.lock().unwrap_or_else(PoisonError::into_inner);
        if past.len() == EVENT_HISTORY {
            past.pop_front();
        }
        past.push_back(text.clone());
        // Perhaps nobody listens.
        let _ = self.events.send(text);
    }

    /// Since the publishing began.
    fn seconds(&self, time_ns: i64) -> f64 {
        time_ns.saturating_sub(self.info.started_ns) as f64 * 1e-9
    }

    fn status(&self, status: &Status, machine: &Machine) -> Value {
        let us = |ns: u64| ns as f64 * 1e-3;
        let recorder = match status.recorder() {
            RecorderState::Off => "off",
            RecorderState::Recording => "recording",
            RecorderState::Stopped => "cannot write",
        };
        let mut all = json!({
            "time_s": self.seconds(status.time_ns),
            "ticks": status.ticks,
            "missed": status.missed,
            "lateness_p50_us": us(status.lateness_p50_ns),
            "lateness_p99_us": us(status.lateness_p99_ns),
            "lateness_p99_9_us": us(status.lateness_p99_9_ns),
            "lateness_max_us": us(status.lateness_max_ns),
            "lateness_counts": status.lateness_counts,
            "not_published": status.not_published,
            "recorder": recorder,
            "recording": status.recording.as_str(),
            "recorded": status.recorded,
            "not_recorded": status.not_recorded,
            "recording_bytes": status.recording_bytes,
            "watchers": status.watchers,
        });
        if let (Some(all), Value::Object(own)) = (all.as_object_mut(), machine.now()) {
            all.extend(own);
        }
        all
    }

    fn finish(&self, why: &str) {
        self.end
            .send_replace(json!({ "end": why }).to_string().into());
        self.ended.store(true, Ordering::Release);
    }
}

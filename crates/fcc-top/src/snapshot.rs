//! One moment of a loop, for other tools to read.

use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{Flags, RecordOf};
use fcc_live::{RecorderState, Status, WatchError, WatcherOf};
use serde::Serialize;
use serde_json::{Map, Value};

use super::picture::Picture;
use super::watched::Watched;

/// A status comes each second.
const PATIENCE: Duration = Duration::from_millis(1_500);

/// One moment of a loop, once there is a record and a status, or soon after.
///
/// # Errors
/// When shared memory fails.
pub fn snapshot<C: Watched>(mut watcher: WatcherOf<C>) -> Result<Snapshot, WatchError> {
    let mut picture = Picture::new(&watcher);
    let deadline = Instant::now() + PATIENCE;
    while !picture.is_whole() && Instant::now() < deadline {
        picture.update(&mut watcher)?;
        thread::sleep(Duration::from_millis(5));
    }
    Ok(Snapshot::of(&picture))
}

/// One moment of a loop. What has not been measured or told is null.
#[derive(Serialize)]
pub struct Snapshot {
    software: String,
    aircraft: String,
    process_id: u32,
    rate_hz: f64,
    timer: String,
    policy: String,
    priority: i32,
    tick: Option<Tick>,
    run: Option<Run>,
    events: Vec<Happened>,
}

#[derive(Serialize)]
struct Tick {
    number: u64,
    time_s: f64,
    lateness_us: f64,
    total_us: f64,
    state: String,
    engage_inhibits: Vec<&'static str>,
    faults: Vec<&'static str>,
    records_dropped: u64,
    page_faults: u64,
    early_wake_us: f64,
    #[serde(flatten)]
    values: Map<String, Value>,
}

#[derive(Serialize)]
struct Run {
    ticks: u64,
    missed: u64,
    lateness_p50_us: f64,
    lateness_p99_us: f64,
    lateness_p99_9_us: f64,
    lateness_max_us: f64,
    watchers: u32,
    not_published: u64,
    cpu_s: f64,
    recorder: &'static str,
    recording: String,
    recorded: u64,
    not_recorded: u64,
}

#[derive(Serialize)]
struct Happened {
    time_s: f64,
    tick: u64,
    text: String,
}

impl Snapshot {
    /// What a picture shows.
    pub fn of<C: Watched>(picture: &Picture<C>) -> Self {
        let info = &picture.info;
        Self {
            software: info.software.to_string(),
            aircraft: info.aircraft.to_string(),
            process_id: info.process_id,
            rate_hz: info.rate_hz,
            timer: info.timer.to_string(),
            policy: info.policy.to_string(),
            priority: info.priority,
            tick: picture
                .record
                .as_ref()
                .map(|record| tick::<C>(record, picture.seconds(record.tick.woke.as_nanos()))),
            run: picture.status.as_ref().map(run),
            events: picture
                .events
                .iter()
                .map(|event| Happened {
                    time_s: picture.seconds(event.time_ns).max(0.0),
                    tick: event.tick,
                    text: event.text.to_string(),
                })
                .collect(),
        }
    }
}

fn tick<C: Watched>(record: &RecordOf<C>, time_s: f64) -> Tick {
    let names = |flags: Flags| flags.iter().map(C::flag_name).collect();
    Tick {
        number: record.tick.number,
        time_s,
        lateness_us: record.tick.lateness().as_secs_f64() * 1e6,
        total_us: record.stages.total_ns as f64 * 1e-3,
        state: record.state.to_string(),
        engage_inhibits: names(record.engage_inhibits),
        faults: names(record.faults),
        records_dropped: record.records_dropped,
        page_faults: record.page_faults,
        early_wake_us: record.early_wake_ns as f64 * 1e-3,
        values: C::values(record),
    }
}

fn run(status: &Status) -> Run {
    let us = |ns: u64| ns as f64 * 1e-3;
    Run {
        ticks: status.ticks,
        missed: status.missed,
        lateness_p50_us: us(status.lateness_p50_ns),
        lateness_p99_us: us(status.lateness_p99_ns),
        lateness_p99_9_us: us(status.lateness_p99_9_ns),
        lateness_max_us: us(status.lateness_max_ns),
        watchers: status.watchers,
        not_published: status.not_published,
        cpu_s: status.cpu_ns as f64 * 1e-9,
        recorder: match status.recorder() {
            RecorderState::Off => "off",
            RecorderState::Recording => "recording",
            RecorderState::Stopped => "stopped",
        },
        recording: status.recording.to_string(),
        recorded: status.recorded,
        not_recorded: status.not_recorded,
    }
}

//! The state of a loop at one time, as JSON.

use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{Flags, RecordOf};
use fcc_live::{RecorderState, Status, WatchError, WatcherOf};
use serde_json::{Value, json};

use super::picture::Picture;
use super::watched::Watched;

/// A status is published each second.
const PATIENCE: Duration = Duration::from_millis(1_500);

/// The state of a loop as soon as there is a record and a status, or after a
/// short wait.
///
/// # Errors
/// When shared memory fails.
pub fn snapshot<C: Watched>(mut watcher: WatcherOf<C>) -> Result<Value, WatchError> {
    let mut picture = Picture::new(&watcher);
    let deadline = Instant::now() + PATIENCE;
    while !picture.is_whole() && Instant::now() < deadline {
        picture.update(&mut watcher)?;
        thread::sleep(Duration::from_millis(5));
    }
    Ok(json_of(&picture))
}

/// What a picture shows; what has not been measured or reported is null.
pub fn json_of<C: Watched>(picture: &Picture<C>) -> Value {
    let info = &picture.info;
    let events = picture.events.iter().map(|event| {
        json!({
            "time_s": picture.seconds(event.time_ns).max(0.0),
            "tick": event.tick,
            "text": event.text.to_string(),
        })
    });
    let record = picture.record.as_ref();
    json!({
        "software": info.software.to_string(),
        "plant": info.plant.to_string(),
        "process_id": info.process_id,
        "rate_hz": info.rate_hz,
        "timer": info.timer.to_string(),
        "policy": info.policy.to_string(),
        "priority": info.priority,
        "tick": record.map(|record| {
            tick::<C>(record, picture.seconds(record.tick.woke.as_nanos()))
        }),
        "run": picture.status.as_ref().map(run),
        "events": events.collect::<Vec<_>>(),
    })
}

fn tick<C: Watched>(record: &RecordOf<C>, time_s: f64) -> Value {
    let names = |flags: Flags| flags.iter().map(C::flag_name).collect::<Vec<_>>();
    let mut tick = json!({
        "number": record.tick.number,
        "time_s": time_s,
        "lateness_us": record.tick.lateness().as_secs_f64() * 1e6,
        "total_us": record.stages.total_ns as f64 * 1e-3,
        "state": record.state.to_string(),
        "engage_inhibits": names(record.engage_inhibits),
        "faults": names(record.faults),
        "records_dropped": record.records_dropped,
        "page_faults": record.page_faults,
        "early_wake_us": record.early_wake_ns as f64 * 1e-3,
    });
    if let Value::Object(tick) = &mut tick {
        tick.extend(C::values(record));
    }
    tick
}

fn run(status: &Status) -> Value {
    let us = |ns: u64| ns as f64 * 1e-3;
    json!({
        "ticks": status.ticks,
        "missed": status.missed,
        "lateness_p50_us": us(status.lateness_p50_ns),
        "lateness_p99_us": us(status.lateness_p99_ns),
        "lateness_p99_9_us": us(status.lateness_p99_9_ns),
        "lateness_max_us": us(status.lateness_max_ns),
        "watchers": status.watchers,
        "not_published": status.not_published,
        "cpu_s": status.cpu_ns as f64 * 1e-9,
        "recorder": match status.recorder() {
            RecorderState::Off => "off",
            RecorderState::Recording => "recording",
            RecorderState::Stopped => "stopped",
        },
        "recording": status.recording.to_string(),
        "recorded": status.recorded,
        "not_recorded": status.not_recorded,
    })
}

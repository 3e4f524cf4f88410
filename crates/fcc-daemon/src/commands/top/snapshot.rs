//! One moment of a flight, for other tools to read.

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, Flags, State};
use fcc_live::{RecorderState, Status};
use fcc_telemetry::FlightRecord;
use fcc_telemetry::units::{M_FT, MPS_KT};
use serde::Serialize;

use super::picture::Picture;

/// One moment of a flight. What has not been measured or told is null.
#[derive(Serialize)]
pub(super) struct Snapshot {
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
    actual: Values,
    setpoints: Option<Values>,
    guidance: Option<Guidance>,
    outputs: Option<Outputs>,
}

/// The mode that is flown, and how far it has come.
#[derive(Serialize)]
struct Guidance {
    mode: &'static str,
    item: u32,
    elapsed_s: f64,
}

#[derive(Serialize)]
struct Values {
    heading_deg: Option<f64>,
    altitude_ft: Option<f64>,
    airspeed_kt: Option<f64>,
    bank_deg: Option<f64>,
    pitch_deg: Option<f64>,
}

#[derive(Serialize)]
struct Outputs {
    throttle: f64,
    elevator: f64,
    aileron: f64,
    rudder: f64,
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
    pub(super) fn of(picture: &Picture) -> Self {
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
                .map(|record| tick(record, picture.seconds(record.tick.woke.as_nanos()))),
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

fn tick(record: &FlightRecord, time_s: f64) -> Tick {
    let names = |flags: Flags| flags.iter().map(Autopilot::flag_name).collect();
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
        actual: actual(record),
        setpoints: (record.state == State::Engaged).then(|| setpoints(record)),
        guidance: (record.state == State::Engaged).then(|| guidance(record)),
        outputs: record.sent.then_some(Outputs {
            throttle: record.outputs.throttle,
            elevator: record.outputs.elevator,
            aileron: record.outputs.aileron,
            rudder: record.outputs.rudder,
        }),
    }
}

fn actual(record: &FlightRecord) -> Values {
    let m = &record.measurements;
    let attitude = (!m.attitude.is_never()).then_some(m.attitude.value);
    Values {
        heading_deg: (!m.heading_rad.is_never())
            .then(|| m.heading_rad.value.to_degrees().rem_euclid(360.0)),
        altitude_ft: (!m.altitude_m.is_never()).then_some(m.altitude_m.value * M_FT),
        airspeed_kt: (!m.airspeed_mps.is_never()).then_some(m.airspeed_mps.value * MPS_KT),
        bank_deg: attitude.map(|attitude| attitude.roll_rad.to_degrees()),
        pitch_deg: attitude.map(|attitude| attitude.pitch_rad.to_degrees()),
    }
}

fn setpoints(record: &FlightRecord) -> Values {
    let aims = &record.setpoints;
    Values {
        heading_deg: Some(aims.heading_rad.to_degrees().rem_euclid(360.0)),
        altitude_ft: Some(aims.altitude_m * M_FT),
        airspeed_kt: Some(aims.airspeed_mps * MPS_KT),
        bank_deg: Some(aims.roll_rad.to_degrees()),
        pitch_deg: Some(aims.pitch_rad.to_degrees()),
    }
}

fn guidance(record: &FlightRecord) -> Guidance {
    let progress = record.setpoints.guidance;
    Guidance {
        mode: progress.mode.name(),
        item: progress.item,
        elapsed_s: progress.elapsed_s,
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

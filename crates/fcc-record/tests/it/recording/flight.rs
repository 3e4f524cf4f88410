//! Flights to record: computed, not flown.

use std::path::Path;

use fcc_core::flight::{Attitude, Measurements, Position, Surfaces};
use fcc_core::framework::{Event, EventKind, Message, Reading, State, Tick, Time};
use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
use fcc_telemetry::{FlightMessage, FlightRecord};

/// 2026-11-20T04:21:33Z.
pub(crate) const STARTED_UNIX_NS: u64 = 1_795_148_493_000_000_000;
/// 40 Hz.
pub(crate) const PERIOD_NS: i64 = 25_000_000;
/// The loop's clock at the start.
const CLOCK_AT_START_NS: i64 = 77_000_000_000;

pub(crate) fn about() -> About {
    About {
        software: "fccd 0.1.0".to_owned(),
        git_hash: "0123456789ab".to_owned(),
        host: "bench".to_owned(),
        kernel: "Linux 6.18".to_owned(),
        plant: "built-in".to_owned(),
        rate_hz: 40.0,
        timer: "timerfd".to_owned(),
        sensors: vec!["built-in aircraft".to_owned()],
        actuators: vec!["built-in aircraft".to_owned()],
        started_unix_ns: STARTED_UNIX_NS,
        clock_offset_ns: STARTED_UNIX_NS as i64 - CLOCK_AT_START_NS,
        config_as_given: Some("[built-in]\n".to_owned()),
        config: "[loop]\nrate_hz = 40.0\n".to_owned(),
        parameters: [("loop.rate_hz".to_owned(), "40.0".to_owned())].into(),
        part: 1,
        ..About::default()
    }
}

/// Settings for a recorder that waits instead of dropping messages.
pub(crate) fn settings(folder: &Path) -> RecorderSettings {
    RecorderSettings {
        pace: RecordingPace::Lockstep,
        ..RecorderSettings::new(folder)
    }
}

/// Tick `number` of a flight, woken `number` µs late.
pub(crate) fn record(number: u64) -> FlightRecord {
    let scheduled = Time::from_nanos(CLOCK_AT_START_NS + number as i64 * PERIOD_NS);
    let woke = Time::from_nanos(scheduled.as_nanos() + number as i64 * 1_000);
    let n = number as f64;
    FlightRecord {
        measurements: Measurements {
            attitude: Reading::new(
                Attitude {
                    pitch_rad: 0.01 * n.sin(),
                    roll_rad: 0.1 * n.cos(),
                },
                woke,
            ),
            heading_rad: Reading::new(0.001 * n, woke),
            position: Reading::new(
                Position {
                    latitude_rad: 0.83,
                    longitude_rad: -0.2 + 1e-6 * n,
                    altitude_m: 900.0,
                },
                woke,
            ),
            ..Measurements::default()
        },
        outputs: Surfaces {
            elevator: -0.001 * n,
            ..Surfaces::default()
        },
        sent: true,
        ..FlightRecord::new(
            Tick {
                number,
                scheduled,
                woke,
                missed: 0,
                dt_s: 0.025,
            },
            State::Engaged,
        )
    }
}

pub(crate) fn event(
    record: &FlightRecord,
    kind: EventKind<fcc_fixed_wing::AutopilotCommand>,
) -> FlightMessage {
    Message::Event(Event {
        tick: record.tick.number,
        time: record.tick.woke,
        kind,
    })
}

/// Engaged in tick 1, then `ticks` records.
pub(crate) fn flight(ticks: u64) -> Vec<FlightMessage> {
    let engaged = EventKind::StateChanged {
        from: State::Standby,
        to: State::Engaged,
    };
    let records = (1..=ticks).map(|number| Message::Tick(record(number)));
    [event(&record(1), engaged)]
        .into_iter()
        .chain(records)
        .collect()
}

/// Records messages and finishes as a flight does.
pub(crate) fn record_all(recorder: Recorder, messages: &[FlightMessage]) -> Vec<String> {
    let mut recorder = recorder;
    for message in messages {
        recorder.take(message);
    }
    recorder
        .finish("stopped by command")
        .1
        .into_iter()
        .map(|notices| notices.text)
        .collect()
}

/// The only recording in a folder.
pub(crate) fn only_file(folder: &Path) -> std::path::PathBuf {
    let mut files = fcc_record::files(folder).unwrap();
    assert_eq!(files.len(), 1, "{files:?}");
    files.remove(0)
}

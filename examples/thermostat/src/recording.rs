//! The recording of a run, by the recorder that records flights.

use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_record::{About, Recorded, RecorderOf, RecorderSettings, RecorderStatus, RecordingPace};
use fcc_runtime::Parts;
use fcc_telemetry::Telemetry;

use crate::thermostat::{Config, Thermostat};

impl Telemetry for Thermostat {}

impl Recorded for Thermostat {
    type Views = ();
}

/// Begins a recording of these parts; call it before their loop starts.
pub(crate) fn start(
    folder: &Path,
    parts: &Parts<Thermostat>,
    pace: RecordingPace,
) -> io::Result<RecorderOf<Thermostat>> {
    let started_unix_ns = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos() as u64);
    let names = |names: &mut dyn Iterator<Item = &str>| names.map(str::to_owned).collect();
    let about = About {
        software: concat!("thermostat ", env!("CARGO_PKG_VERSION")).to_owned(),
        git_hash: "unknown".to_owned(),
        plant: "thermostat".to_owned(),
        rate_hz: 1.0 / parts.timer.period().as_secs_f64(),
        timer: parts.timer.name().to_owned(),
        sensors: names(&mut parts.sensors.iter().map(|sensor| sensor.name())),
        actuators: names(&mut parts.actuators.iter().map(|actuator| actuator.name())),
        started_unix_ns,
        config: toml::to_string(&Config::default()).map_err(io::Error::other)?,
        clock_offset_ns: (started_unix_ns as i64).saturating_sub(parts.timer.now_ns()),
        ..About::default()
    };
    let settings = RecorderSettings {
        pace,
        ..RecorderSettings::new(folder)
    };
    RecorderOf::start(about, settings)
}

/// Ends a recording.
///
/// # Errors
/// When a part of the run was not recorded.
pub(crate) fn finish(
    recorder: RecorderOf<Thermostat>,
    ending: &str,
) -> Result<RecorderStatus, String> {
    let (status, news) = recorder.finish(ending);
    let troubles = news.into_iter().filter(|news| news.is_trouble);
    let troubles: Vec<_> = troubles.map(|news| news.text).collect();
    if troubles.is_empty() && status.not_recorded == 0 {
        return Ok(status);
    }
    Err(format!(
        "{} records and events were not recorded: {}",
        status.not_recorded,
        troubles.join("; ")
    ))
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::schema::{Schema, Values};
    use fcc_record::Recording;
    use fcc_runtime::{Message, MessageOf, RecordOf};

    use super::*;
    use crate::replay::tests::{TICKS, record};

    /// The bits of a record: comparing numbers would treat -0 as 0.
    fn bits(record: &RecordOf<Thermostat>) -> Vec<u64> {
        const LEAVES: usize = <RecordOf<Thermostat> as Schema>::TYPE.leaves();
        let mut values = Values::<LEAVES>::default();
        record.visit(&mut values);
        values.as_slice().iter().map(|value| value.bits()).collect()
    }

    /// The recording contains what the loop produced.
    #[test]
    fn a_recording_has_every_bit_of_every_tick() {
        let folder = tempfile::tempdir().unwrap();
        let (file, messages) = record(folder.path());

        let recording = Recording::open(file).unwrap();
        let end = recording.end().unwrap();
        assert_eq!(
            (end.ticks, end.first_tick, end.last_tick),
            (TICKS, 1, TICKS)
        );
        assert_eq!(end.ending, "the test is over");
        assert_eq!(recording.about().rate_hz, 40.0);
        assert_eq!(recording.about().sensors, ["thermometer"]);
        assert_eq!(recording.about().actuators, ["heater"]);

        let read: Vec<_> = recording
            .messages::<MessageOf<Thermostat>>()
            .unwrap()
            .collect();
        assert_eq!(read.len(), messages.len());
        for pair in read.iter().zip(&messages) {
            match pair {
                (Message::Tick(read), Message::Tick(produced)) => {
                    assert_eq!(bits(read), bits(produced), "tick {}", produced.tick.number);
                }
                (read, produced) => assert_eq!(read, produced),
            }
        }
        // It does not contain zeros only: the second command is in it.
        let heats = |message: &MessageOf<Thermostat>| {
            matches!(message, Message::Tick(record)
            if record.setpoints.room_c == 22.5 && record.outputs.power > 0.0)
        };
        assert!(read.iter().any(heats));
    }
}

//! The recording of a run, by the recorder that records flights.

use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_record::{About, Recorded, RecorderOf, RecorderSettings, RecorderStatus, RecordingPace};
use fcc_runtime::{Parts, RecordOf};
use fcc_telemetry::Telemetry;
use fcc_telemetry::schema::{Words, words};

use crate::thermostat::Thermostat;

impl Telemetry for Thermostat {
    type Words = Words<RecordOf<Self>, { words::<RecordOf<Self>>() }>;
}

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
        aircraft: "thermostat".to_owned(),
        rate_hz: 1.0 / parts.timer.period().as_secs_f64(),
        timer: parts.timer.name().to_owned(),
        sensors: names(&mut parts.sensors.iter().map(|sensor| sensor.name())),
        actuators: names(&mut parts.actuators.iter().map(|actuator| actuator.name())),
        started_unix_ns,
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
    use fcc_runtime::{LoopCommand, LoopConfig, Machine, Message, MessageOf};
    use fcc_timer::ManualTimer;

    use super::*;
    use crate::room::Heater;
    use crate::{PERIOD, parts};

    const TICKS: u64 = 400;

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
        let parts = parts(
            Box::new(ManualTimer::new(PERIOD).unwrap()),
            &Heater::default(),
        );
        let mut recorder = start(folder.path(), &parts, RecordingPace::Lockstep).unwrap();
        let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        let (mut produced, mut events) = (Vec::new(), Vec::new());
        for number in 1..=TICKS {
            match number {
                10 => link.commands.send(LoopCommand::Engage).unwrap(),
                200 => link.commands.send(LoopCommand::Controller(22.5)).unwrap(),
                390 => link.commands.send(LoopCommand::Disengage).unwrap(),
                _ => {}
            }
            machine.step();
            produced.push(*machine.record());
            while let Some(message) = link.messages.receive() {
                recorder.take(&message);
                if let Message::Event(event) = message {
                    events.push(event);
                }
            }
        }
        let status = finish(recorder, "the test is over").unwrap();
        assert_eq!(status.ticks, TICKS);

        let recording = Recording::open(&status.files[0]).unwrap();
        let end = recording.end().unwrap();
        assert_eq!(
            (end.ticks, end.first_tick, end.last_tick),
            (TICKS, 1, TICKS)
        );
        assert_eq!(end.ending, "the test is over");
        assert_eq!(recording.about().rate_hz, 40.0);
        assert_eq!(recording.about().sensors, ["thermometer"]);
        assert_eq!(recording.about().actuators, ["heater"]);

        let (mut read, mut events_read) = (Vec::new(), Vec::new());
        for message in recording.messages::<MessageOf<Thermostat>>().unwrap() {
            match message {
                Message::Tick(record) => read.push(record),
                Message::Event(event) => events_read.push(event),
            }
        }
        assert_eq!(read.len(), produced.len());
        for (read, produced) in read.iter().zip(&produced) {
            assert_eq!(bits(read), bits(produced), "tick {}", produced.tick.number);
        }
        assert!(!events.is_empty());
        assert_eq!(events_read, events);
        // It does not contain zeros only: the second command is in it.
        assert_eq!(read[300].setpoints.room_c, 22.5);
        assert!(read[300].outputs.power > 0.0);
    }
}

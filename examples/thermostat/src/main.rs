//! The framework without an aircraft: a room, a heater and a PI controller
//! under the same 40 Hz loop that flies an aircraft, with the same timing and
//! report.
//!
//! `cargo run -p thermostat` heats the room for eight seconds, each of which is
//! 33 minutes in the room. With `-- --record DIR` the run is recorded, like a
//! flight.

#[cfg(test)]
mod conformance;
mod recording;
mod room;
mod thermostat;

use std::env;
use std::error::Error;
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use fcc_record::{RecorderOf, RecordingPace};
use fcc_runtime::{Link, Loop, LoopCommand, LoopConfig, LoopReport, Message, Parts, RecordOf};
use fcc_timer::{RealtimeRequest, Timer, TimerKind};

use room::{Heater, Thermometer};
use thermostat::Thermostat;

const PERIOD: Duration = Duration::from_millis(25);
const WANTED_C: f64 = 20.0;
const SECONDS: u64 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = recording_folder(env::args_os().skip(1))?;
    let timer = TimerKind::Timerfd.build(PERIOD)?;
    heat(timer, SECONDS, folder.as_deref(), &mut io::stdout())?;
    Ok(())
}

/// The folder to record into, if the command line names one.
fn recording_folder(
    mut arguments: impl Iterator<Item = OsString>,
) -> Result<Option<PathBuf>, String> {
    match (arguments.next(), arguments.next(), arguments.next()) {
        (None, ..) => Ok(None),
        (Some(option), Some(folder), None) if option == "--record" => Ok(Some(folder.into())),
        _ => Err("usage: thermostat [--record DIR]".to_owned()),
    }
}

/// Assembles the parts.
fn parts(timer: Box<dyn Timer>, heater: &Heater) -> Parts<Thermostat> {
    let thermometer = Thermometer {
        room_c: 12.0,
        heater: heater.clone(),
    };
    Parts {
        timer,
        sensors: vec![Box::new(thermometer)],
        controller: Thermostat::new(WANTED_C),
        actuators: vec![Box::new(heater.clone())],
    }
}

/// Heats for some seconds, reports each second, and records if there is a
/// folder. Output that cannot be written does not end it.
fn heat(
    timer: Box<dyn Timer>,
    seconds: u64,
    folder: Option<&Path>,
    out: &mut dyn Write,
) -> Result<LoopReport, Box<dyn Error>> {
    let parts = parts(timer, &Heater::default());
    let mut recorder = folder
        .map(|folder| recording::start(folder, &parts, RecordingPace::RealTime))
        .transpose()?;
    let config = LoopConfig {
        realtime: RealtimeRequest {
            priority: Some(50),
            ..RealtimeRequest::default()
        },
        ..LoopConfig::default()
    };
    let (this, mut link) = Loop::new(parts, &config)?;
    let handle = this.spawn()?;
    for denied in &handle.granted().denied {
        let _ = writeln!(out, "continues without: {denied}");
    }
    link.commands.send(LoopCommand::Engage)?;
    for second in 1..=seconds {
        thread::sleep(Duration::from_secs(1));
        if let Some(record) = receive(&mut link, recorder.as_mut(), out) {
            let _ = writeln!(
                out,
                "{second:2} s  {}  room {:5.2} °C  heater {:4.0} W",
                record.state,
                record.measurements.room_c.value,
                record.outputs.power * room::HEATER_W
            );
        }
    }
    link.commands.send(LoopCommand::Stop)?;
    let report = handle.join();
    // For the recording; how the loop ended is in the report.
    receive(&mut link, recorder.as_mut(), &mut io::sink());
    let _ = print_report(&report, out);
    if let Some(recorder) = recorder {
        let recorded = recording::finish(recorder, &report.ending.to_string())?;
        for file in recorded.files {
            let _ = writeln!(out, "Recorded {}", file.display());
        }
    }
    Ok(report)
}

/// Receives what the loop has sent, and returns the last record of it.
fn receive(
    link: &mut Link<Thermostat>,
    mut recorder: Option<&mut RecorderOf<Thermostat>>,
    out: &mut dyn Write,
) -> Option<RecordOf<Thermostat>> {
    let mut last = None;
    while let Some(message) = link.messages.receive() {
        if let Some(recorder) = &mut recorder {
            recorder.take(&message);
        }
        match message {
            Message::Tick(record) => last = Some(record),
            Message::Event(event) => {
                let _ = writeln!(out, "{}", event.kind.description::<Thermostat>());
            }
        }
    }
    last
}

fn print_report(report: &LoopReport, out: &mut dyn Write) -> io::Result<()> {
    let timing = &report.timing;
    writeln!(out, "\nEnded: {}", report.ending)?;
    writeln!(out, "Runtime  {:8.3} s", timing.runtime_s)?;
    writeln!(out, "Average  {:8.3} ms", timing.period_mean_ms)?;
    writeln!(out, "Median   {:8.3} ms", timing.period_median_ms)?;
    writeln!(out, "Min      {:8.3} ms", timing.period_min_ms)?;
    writeln!(out, "Max      {:8.3} ms", timing.period_max_ms)?;
    writeln!(out, "Range    {:8.3} ms", timing.period_range_ms)?;
    writeln!(out, "Missed   {:8}", timing.missed)
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use fcc_core::framework::{Actuator, State, Tick};
    use fcc_record::Recording;
    use fcc_runtime::{Ending, Machine};
    use fcc_timer::ManualTimer;

    use super::*;
    use room::{HEATER_W, OUTSIDE_C, RESISTANCE_K_PER_W};
    use thermostat::Heating;

    /// After one time constant a first-order room has covered 1 - 1/e of the
    /// difference.
    #[test]
    fn the_room_has_the_textbooks_time_constant() {
        let mut heater = Heater::default();
        Actuator::apply(&mut heater, &Tick::default(), &Heating { power: 0.5 }).unwrap();
        let mut thermometer = Thermometer {
            room_c: OUTSIDE_C,
            heater,
        };
        // 0.02 K/W times 360 kJ/K.
        for _ in 0..7_200 {
            thermometer.pass(1.0);
        }
        // 1 kW through 0.02 K/W is 20 K.
        assert!((thermometer.room_c - (OUTSIDE_C + 20.0 * 0.632_120_558_8)).abs() < 1e-6);
    }

    /// Finally the heater gives what the walls lose at the wanted temperature:
    /// (20 - 2)/0.02 = 900 W.
    #[test]
    fn the_room_reaches_the_set_point() {
        let heater = Heater::default();
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let (mut machine, mut link) =
            Machine::new(parts(timer, &heater), &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        link.commands.send(LoopCommand::Engage).unwrap();
        let mut warmest_c = 0.0_f64;
        for _ in 0..40 * SECONDS {
            assert_eq!(machine.step(), State::Engaged);
            warmest_c = warmest_c.max(machine.record().measurements.room_c.value);
        }
        let room_c = machine.record().measurements.room_c.value;
        assert!((room_c - WANTED_C).abs() < 0.01, "{room_c} °C");
        assert!(warmest_c < WANTED_C + 0.1, "overshoot to {warmest_c} °C");
        let lost_w = (WANTED_C - OUTSIDE_C) / RESISTANCE_K_PER_W;
        assert!((heater.power() * HEATER_W - lost_w).abs() < 1.0);
        machine.finish();
        assert!(heater.power() <= 0.0, "the heater is still on");
    }

    /// It is recorded to the last tick, even if nothing can be printed.
    #[test]
    fn it_runs_on_a_real_clock() {
        let folder = tempfile::tempdir().unwrap();
        let timer = TimerKind::Timerfd.build(PERIOD).unwrap();
        let mut full = File::options().write(true).open("/dev/full").unwrap();
        let report = heat(timer, 1, Some(folder.path()), &mut full).unwrap();
        assert!(matches!(report.ending, Ending::StopCommand));
        assert!(report.released);
        assert!(report.ticks > 1);
        assert!(report.timing.runtime_s >= 1.0);
        let file = fcc_record::files(folder.path()).unwrap().remove(0);
        let recording = Recording::open(file).unwrap();
        assert_eq!(recording.end().unwrap().ticks, report.ticks);
    }

    #[test]
    fn it_records_only_if_requested() {
        let folder = |words: &[&str]| recording_folder(words.iter().map(OsString::from));
        assert_eq!(folder(&[]), Ok(None));
        assert_eq!(folder(&["--record", "runs"]), Ok(Some("runs".into())));
        for wrong in [&["--record"][..], &["runs"], &["--record", "runs", "2"]] {
            assert!(folder(wrong).unwrap_err().contains("--record DIR"));
        }
    }
}

//! The framework without an aircraft: a room, a heater and a PI controller
//! under the same 40 Hz loop that flies an aircraft, with the same timing and
//! report.
//!
//! `cargo run -p thermostat` heats the room for eight seconds, each of which is
//! 33 minutes in the room. With `-- --record DIR` the run is recorded, like a
//! flight; `-- replay FILE` replays it, and `-- report FILE` reports on it. A
//! run with `-- --live` can be watched with `-- top`.

#[cfg(test)]
#[path = "tests/conformance.rs"]
mod conformance;
#[cfg(test)]
#[path = "tests/one_more_reading.rs"]
mod one_more_reading;
mod recording;
mod replay;
mod room;
mod show;
mod thermostat;
mod values;

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

use clap::{Parser, Subcommand};
use fcc_record::{RecorderOf, RecordingPace};
use fcc_runtime::{Link, Loop, LoopCommand, LoopConfig, LoopReport, Message, Parts, RecordOf};
use fcc_telemetry::{Instance, printable, printable_json};
use fcc_timer::{RealtimeRequest, Timer, TimerKind};

use room::{Heater, Thermometer};
use show::Live;
use thermostat::{Config, Thermostat};

const PERIOD: Duration = Duration::from_millis(25);
const SECONDS: u64 = 8;
/// How often the loop's messages are received: the greatest delay of a watcher.
const LOOKS_A_SECOND: u32 = 20;

/// Heats a simulated room for eight seconds.
#[derive(Parser)]
struct Arguments {
    /// Record the run into this folder.
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    /// Publish the run for `thermostat top`, and accept commands.
    #[arg(long)]
    live: bool,
    /// The name under which it is published and watched.
    #[arg(long, global = true, default_value = "thermostat")]
    instance: Instance,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Replay a recording, and compare every output bit for bit.
    Replay {
        /// The recording, or its parts, oldest first.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Report on a recording.
    Report {
        /// The recording.
        file: PathBuf,
        /// Write a page with all plots.
        #[arg(long, value_name = "PAGE")]
        html: Option<PathBuf>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Watch a run that was started with --live.
    Top,
}

fn main() -> ExitCode {
    run(Arguments::parse()).unwrap_or_else(|error| {
        let text = printable(&error.to_string());
        let _ = writeln!(io::stderr(), "thermostat: {text}");
        ExitCode::FAILURE
    })
}

fn run(arguments: Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let out = &mut io::stdout();
    match arguments.command {
        None => {
            let timer = TimerKind::Timerfd.build(PERIOD)?;
            let folder = arguments.record.as_deref();
            let live = arguments.live.then_some(&arguments.instance);
            let report = heat(timer, SECONDS, folder, live, out)?;
            print_report(&report, out)?;
        }
        Some(Command::Replay { files }) => return replay::replay(&files, out),
        Some(Command::Report { file, html, json }) => {
            let report = show::report(&file, html.as_deref())?;
            let text = if json {
                printable_json(&serde_json::to_string_pretty(&report)?)
            } else {
                printable(&report.to_text())
            };
            writeln!(out, "{text}")?;
        }
        Some(Command::Top) => fcc_top::top::<Thermostat>(&arguments.instance)?,
    }
    Ok(ExitCode::SUCCESS)
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
        controller: Thermostat::new(&Config::default()),
        actuators: vec![Box::new(heater.clone())],
    }
}

/// Heats for some seconds, reports each second, and records if there is a
/// folder. Output that cannot be written does not end it.
fn heat(
    timer: Box<dyn Timer>,
    seconds: u64,
    folder: Option<&Path>,
    live: Option<&Instance>,
    out: &mut dyn Write,
) -> Result<LoopReport, Box<dyn Error>> {
    let parts = parts(timer, &Heater::default());
    let mut recorder = folder
        .map(|folder| recording::start(folder, &parts, RecordingPace::RealTime))
        .transpose()?;
    let mut live = live
        .map(|instance| Live::begin(instance, &parts))
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
        let mut last = None;
        for _ in 0..LOOKS_A_SECOND {
            thread::sleep(Duration::from_secs(1) / LOOKS_A_SECOND);
            let newest = receive(&mut link, recorder.as_mut(), live.as_mut(), out);
            last = newest.or(last);
        }
        if let Some(record) = last {
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
    receive(&mut link, recorder.as_mut(), live.as_mut(), &mut io::sink());
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
    mut live: Option<&mut Live>,
    out: &mut dyn Write,
) -> Option<RecordOf<Thermostat>> {
    let mut last = None;
    while let Some(message) = link.messages.receive() {
        if let Some(recorder) = &mut recorder {
            recorder.take(&message);
        }
        if let Some(live) = &mut live {
            live.take(&message);
        }
        match message {
            Message::Tick(record) => last = Some(record),
            Message::Event(event) => {
                let _ = writeln!(out, "{}", event.kind.description::<Thermostat>());
            }
        }
    }
    if let Some(live) = live {
        let status = recorder.map(|recorder| show::recorder(&recorder.status()));
        live.poll(status, &mut link.commands);
    }
    last
}

fn print_report(report: &LoopReport, out: &mut dyn Write) -> io::Result<()> {
    let timing = &report.timing;
    writeln!(out, "Ended: {}", report.ending)?;
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
    use values::Heating;

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
        let wanted_c = Config::default().wanted_c;
        let mut warmest_c = 0.0_f64;
        for _ in 0..40 * SECONDS {
            assert_eq!(machine.step(), State::Engaged);
            warmest_c = warmest_c.max(machine.record().measurements.room_c.value);
        }
        let room_c = machine.record().measurements.room_c.value;
        assert!((room_c - wanted_c).abs() < 0.01, "{room_c} °C");
        assert!(warmest_c < wanted_c + 0.1, "overshoot to {warmest_c} °C");
        let lost_w = (wanted_c - OUTSIDE_C) / RESISTANCE_K_PER_W;
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
        let report = heat(timer, 1, Some(folder.path()), None, &mut full).unwrap();
        assert!(matches!(report.ending, Ending::StopCommand));
        assert!(report.released);
        assert!(report.ticks > 1);
        assert!(report.timing.runtime_s >= 1.0);
        let file = fcc_record::files(folder.path()).unwrap().remove(0);
        let recording = Recording::open(file).unwrap();
        assert_eq!(recording.end().unwrap().ticks, report.ticks);
    }

    #[test]
    fn its_command_line_is_read_as_documented() {
        let parse = |words: &[&str]| Arguments::try_parse_from([&["thermostat"], words].concat());
        assert!(parse(&[]).unwrap().record.is_none());
        let recorded = parse(&["--record", "runs"]).unwrap().record;
        assert_eq!(recorded, Some("runs".into()));
        assert!(matches!(
            parse(&["replay", "run.mcap"]).unwrap().command,
            Some(Command::Replay { files }) if files == [PathBuf::from("run.mcap")]
        ));
        for wrong in [&["--record"][..], &["runs"], &["replay"]] {
            assert!(parse(wrong).is_err(), "{wrong:?}");
        }
    }
}

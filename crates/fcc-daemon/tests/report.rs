//! `fccd report` on flights that are flown for it in lockstep.
#![cfg(test)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use fcc_core::framework::State;
use fcc_daemon::config::{BuiltInSection, Config, GustsChoice};
use fcc_daemon::flight::assemble;
use fcc_runtime::{Machine, Parts};
use fcc_telemetry::recording::{About, Realtime, Recorder, RecorderSettings, RecordingPace};
use fcc_timer::ManualTimer;

/// Flies the built-in aircraft and records it into a folder.
fn fly(folder: &Path, rate_hz: u32, ticks: u32) -> PathBuf {
    let mut config = Config {
        built_in: Some(BuiltInSection {
            gusts: GustsChoice::Light,
            ..BuiltInSection::default()
        }),
        ..Config::default()
    };
    config.tick.rate_hz = f64::from(rate_hz);
    let assembly = assemble(&config).unwrap();
    let about = About {
        software: "fccd test".to_owned(),
        git_hash: "0123456789ab".to_owned(),
        host: "bench".to_owned(),
        kernel: "Linux".to_owned(),
        aircraft: "built-in".to_owned(),
        rate_hz: f64::from(rate_hz),
        timer: "manual".to_owned(),
        sensors: assembly
            .sensors
            .iter()
            .map(|s| s.name().to_owned())
            .collect(),
        actuators: assembly
            .actuators
            .iter()
            .map(|a| a.name().to_owned())
            .collect(),
        realtime: Realtime {
            policy: "SCHED_OTHER".to_owned(),
            refused: vec!["SCHED_FIFO 80 was refused: give the program CAP_SYS_NICE".to_owned()],
            ..Realtime::default()
        },
        started_unix_ns: 1_795_148_493_000_000_000,
        config: toml::to_string(&config).unwrap(),
        part: 1,
        ..About::default()
    };
    let parts = Parts {
        timer: Box::new(ManualTimer::new(Duration::from_secs(1) / rate_hz).unwrap()),
        sensors: assembly.sensors,
        controller: assembly.autopilot,
        actuators: assembly.actuators,
    };
    let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();
    let mut recorder = Recorder::start(
        about,
        RecorderSettings {
            pace: RecordingPace::Lockstep,
            ..RecorderSettings::new(folder)
        },
    )
    .unwrap();
    for tick in 0..ticks {
        if tick + 1 == ticks {
            link.stop.stop();
        }
        let state = machine.step();
        while let Some(message) = link.messages.receive() {
            recorder.take(&message);
        }
        if state == State::Stopped {
            break;
        }
    }
    let (status, _) = recorder.finish("told to stop");
    status.files[0].clone()
}

#[test]
fn flies() {
    let folder = std::env::var("OUT_FOLDER").unwrap();
    let rate: u32 = std::env::var("RATE").unwrap().parse().unwrap();
    let seconds: u32 = std::env::var("SECONDS").unwrap().parse().unwrap();
    println!(
        "{}",
        fly(Path::new(&folder), rate, rate * seconds).display()
    );
}

//! `fccd replay`, from the file to the exit code.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Output};
use std::time::Duration;

use fcc_core::framework::LoopCommand;
use fcc_fixed_wing::AutopilotCommand;
use fcc_flight::config::Config;
use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
use fcc_telemetry::FlightMessage;
use serde_json::Value;
use tempfile::TempDir;

use super::flights::{Happenings, fly, rough};
use super::flipped;

/// Records a flight with `config`, in parts of 10 s.
fn record(folder: &TempDir, config: &Config, messages: &[FlightMessage]) -> Vec<PathBuf> {
    let about = About {
        software: format!("fccd {}", env!("CARGO_PKG_VERSION")),
        git_hash: "unknown".to_owned(),
        plant: "built-in".to_owned(),
        rate_hz: config.tick.rate_hz,
        timer: "manual".to_owned(),
        sensors: vec!["built-in".to_owned()],
        actuators: vec!["built-in".to_owned()],
        started_unix_ns: 1_800_000_000_000_000_000,
        clock_offset_ns: 1_800_000_000_000_000_000,
        config: toml::to_string(config).unwrap(),
        ..About::default()
    };
    let settings = RecorderSettings {
        max_file_age: Some(Duration::from_secs(10)),
        pace: RecordingPace::Lockstep,
        ..RecorderSettings::new(folder.path())
    };
    let mut recorder = Recorder::start(about, settings).unwrap();
    for message in messages {
        recorder.take(message);
    }
    let (status, _) = recorder.finish("stop requested");
    assert_eq!((status.not_recorded, status.stopped), (0, None));
    status.files
}

/// 25 s, with commands, and stopped at the end.
fn flight() -> Vec<FlightMessage> {
    let happenings = Happenings {
        commands: vec![
            (400, LoopCommand::Controller(AutopilotCommand::Heading(1.0))),
            (600, LoopCommand::Disengage),
            (640, LoopCommand::Engage),
        ],
        stop_before: Some(1_000),
        steps: 1_100,
        ..Happenings::default()
    };
    fly(&rough(), &happenings)
}

fn fccd_replay(files: &[PathBuf], more: &[&str]) -> Output {
    Process::new(env!("CARGO_BIN_EXE_fccd"))
        .arg("replay")
        .args(files)
        .args(more)
        .output()
        .unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

#[test]
fn all_parts_of_a_recording_replay_identically() {
    let folder = TempDir::new().unwrap();
    let parts = record(&folder, &rough(), &flight());
    assert_eq!(parts.len(), 3);

    let output = fccd_replay(&parts, &["--json"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let result = json(&output);
    assert_eq!(result["ticks"], 1_000);
    assert_eq!(result["identity"]["outputs"], 1_000 * super::OUTPUTS);
    assert_eq!(result["identity"]["differing"], 0);
    assert_eq!(result["unflown"], Value::Null);

    let output = fccd_replay(&parts, &[]);
    let outputs = 1_000 * super::OUTPUTS;
    let expected = format!("{outputs} outputs compared bit for bit: 0 differ");
    assert!(stderr(&output).contains(&expected));
}

#[test]
fn parts_without_their_predecessors_are_not_replayed() {
    let folder = TempDir::new().unwrap();
    let parts = record(&folder, &rough(), &flight());

    let output = fccd_replay(&parts[1..], &["--json"]);
    assert_eq!(code(&output), Some(8));
    assert_eq!(json(&output)["ticks"], 0);
    let why = json(&output)["unflown"]["why"].to_string();
    assert!(why.contains("give the recordings before it too"), "{why}");

    let output = fccd_replay(&[parts[0].clone(), parts[2].clone()], &["--json"]);
    assert_eq!(code(&output), Some(8));
    assert_eq!(json(&output)["identity"]["differing"], 0);
    let ticks = json(&output)["ticks"].as_u64().unwrap();
    assert!((395..=405).contains(&ticks), "{ticks}");

    let reversed: Vec<_> = parts.iter().rev().cloned().collect();
    let output = fccd_replay(&reversed, &[]);
    assert_eq!(code(&output), Some(8));
    assert!(
        stderr(&output).contains("oldest first"),
        "{}",
        stderr(&output)
    );

    let output = fccd_replay(&[PathBuf::from("Cargo.toml")], &[]);
    assert_eq!(code(&output), Some(2));
    assert!(
        stderr(&output).contains("not a recording"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_first_difference_from_one_flipped_bit_in_a_gain_is_reported() {
    let folder = TempDir::new().unwrap();
    let mut config = rough();
    let gain = &mut config.autopilot.altitude.pitch_rate_gain;
    *gain = flipped(*gain);
    let parts = record(&folder, &config, &flight());
    let output = fccd_replay(&parts, &["--json"]);
    assert_eq!(code(&output), Some(7));
    let result = json(&output);
    assert_eq!(result["ticks"], 1_000);
    let first = &result["identity"]["first"];
    assert_eq!(first["field"], "outputs.elevator");
    let tick = first["tick"].as_u64().unwrap();
    assert!((80..120).contains(&tick), "{tick}");
    let text = stderr(&fccd_replay(&parts, &[]));
    assert!(text.contains(&format!("first in tick {tick}")), "{text}");
    assert!(text.contains(first["recorded_bits"].as_str().unwrap()));
    assert!(text.contains(first["again_bits"].as_str().unwrap()));
}

#[test]
fn a_recording_that_was_cut_is_replayed_up_to_its_cut() {
    let folder = TempDir::new().unwrap();
    let parts = record(&folder, &rough(), &flight());
    let last = &parts[2];
    let bytes = fs::metadata(last).unwrap().len();
    File::options()
        .write(true)
        .open(last)
        .unwrap()
        .set_len(bytes / 2)
        .unwrap();
    let output = fccd_replay(&parts, &["--json"]);
    assert_eq!(code(&output), Some(8));
    let result = json(&output);
    assert_eq!(result["identity"]["differing"], 0);
    assert!(result["ticks"].as_u64().unwrap() >= 795);
    assert!(result["cuts"][0].as_str().unwrap().contains("cut off"));
}

#[test]
fn another_configuration_is_compared_and_written_out() {
    let folder = TempDir::new().unwrap();
    let parts = record(&folder, &rough(), &flight());
    let mut other = rough();
    other.autopilot.heading.roll_rate_gain *= 1.5;
    other.tick.rate_hz = 50.0;
    let config = folder.path().join("other.toml");
    fs::write(&config, toml::to_string(&other).unwrap()).unwrap();
    let csv = folder.path().join("both.csv");
    let more = |json: bool| {
        let mut words = vec!["--config", text(&config), "--csv", text(&csv)];
        words.extend(json.then_some("--json"));
        words
    };

    let output = fccd_replay(&parts, &more(true));
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let result = json(&output);
    let quantities = result["deviation"]["quantities"].as_array().unwrap();
    let of = |name: &str| quantities.iter().find(|q| q["name"] == name).unwrap();
    assert!(of("commanded aileron")["rms"].as_f64().unwrap() > 0.1);
    // The gain of the roll rate does not affect the elevator.
    assert_eq!(of("commanded elevator")["differing"], 0);
    assert!(result["remarks"][0].as_str().unwrap().contains("40 Hz"));

    // The same value from the table.
    let rows = fs::read_to_string(&csv).unwrap();
    let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let column = |name: &str| header.iter().position(|cell| *cell == name).unwrap();
    let (was, is) = (
        column("commanded aileron recorded (%)"),
        column("commanded aileron other (%)"),
    );
    let squares: Vec<f64> = lines
        .filter(|cells| !cells[was].is_empty())
        .map(|cells| {
            let number = |at: usize| cells[at].parse::<f64>().unwrap();
            (number(is) - number(was)).powi(2)
        })
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((rms - of("commanded aileron")["rms"].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(rows.lines().count(), 1_001);

    let output = fccd_replay(&parts, &more(false));
    assert!(
        stderr(&output).contains("did not react"),
        "{}",
        stderr(&output)
    );
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

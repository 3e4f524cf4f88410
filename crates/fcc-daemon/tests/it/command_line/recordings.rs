//! Recordings that are not there yet, or not complete yet.

use std::fs;
use std::process::Stdio;
use std::time::Instant;

use serde_json::Value;

use super::{Flight, PATIENCE, fccd, fly};

/// As in a fresh clone.
#[test]
fn nothing_recorded_yet_is_an_empty_list() {
    let folder = tempfile::tempdir().unwrap();
    let listed = fccd(folder.path(), &["list"]).output().unwrap();
    assert_eq!(listed.status.code(), Some(0), "{listed:?}");
    let said = String::from_utf8(listed.stdout).unwrap();
    assert!(said.starts_with("no recordings: "), "{said}");
    assert!(listed.stderr.is_empty());
    let listed = fccd(folder.path(), &["list", "--json"]).output().unwrap();
    assert_eq!(listed.status.code(), Some(0));
    assert_eq!(listed.stdout, b"[]\n");
}

/// A missing input is a wrong command line, whatever kind of file it is.
#[test]
fn a_missing_file_has_one_exit_code_in_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("c.toml");
    fs::write(&config, "[built-in]\n").unwrap();
    for words in [
        "check no.toml",
        "check-controls no.toml",
        "calibrate gyroscope no.toml",
        "doctor --config no.toml",
        "fly --config no.toml",
        "fly --plan no.waypoints",
        "run --config no.toml",
        "run --config c.toml --plan no.waypoints",
        "x-plane check --config no.toml",
        "plan check no.waypoints",
        "plan show no.waypoints",
        "plan convert no.waypoints to.plan",
        "list no-folder",
        "probe --root no-folder",
        "recover no.mcap",
        "replay no.mcap",
        "replay --navigation no.mcap",
        "report no.mcap",
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let ended = fccd(folder.path(), &words).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(2), "{words:?}: {said}");
        let named = words.iter().find(|word| word.starts_with("no"));
        assert!(said.contains(*named.unwrap()), "{words:?}: {said}");
    }
}

#[test]
fn a_recording_that_is_being_written_is_not_said_to_be_cut() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["fly", "--quiet", "--seconds", "600"];
    let flight = fccd(folder.path(), &words)
        .args(["--instance", &format!("writes-{}", std::process::id())])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let _flight = Flight(flight);
    let begun = Instant::now();
    let file = loop {
        let listed = fccd(folder.path(), &["list", "--json"]).output().unwrap();
        let listed: Value = serde_json::from_slice(&listed.stdout).unwrap();
        if listed[0]["ticks"].as_u64().is_some_and(|ticks| ticks > 1) {
            assert_eq!(listed[0]["file"], "being-written");
            break listed[0]["path"].as_str().unwrap().to_owned();
        }
        assert!(begun.elapsed() < PATIENCE, "nothing was recorded");
    };
    let report = fccd(folder.path(), &["report", &file]).output().unwrap();
    let said = String::from_utf8(report.stdout).unwrap();
    assert_eq!(report.status.code(), Some(0), "{said}");
    assert!(
        said.contains("The recording is still being written, "),
        "{said}"
    );
    assert!(!said.contains("cut"), "{said}");
    let report = fccd(folder.path(), &["report", &file, "--json"])
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&report.stdout).unwrap();
    assert_eq!(report["end"]["kind"], "being_written");
    let replay = fccd(folder.path(), &["replay", &file]).output().unwrap();
    let said = String::from_utf8(replay.stdout).unwrap();
    assert_eq!(replay.status.code(), Some(8), "{said}");
    assert!(said.contains("still being written, "), "{said}");
}

/// The magic number of MCAP has 8 bytes.
#[test]
fn a_recording_that_is_cut_in_its_beginning_is_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    let whole = fcc_record::files(&folder.path().join("recordings")).unwrap();
    let whole = fs::read(&whole[0]).unwrap();
    for (bytes, is_one) in [(0, false), (7, false), (8, true), (9, true), (5_000, true)] {
        fs::write(folder.path().join("cut.mcap"), &whole[..bytes]).unwrap();
        for (command, exit) in [("report", 13), ("recover", 13), ("replay", 8)] {
            let ended = fccd(folder.path(), &[command, "cut.mcap"])
                .output()
                .unwrap();
            let said = String::from_utf8(ended.stderr).unwrap();
            let cut = format!("fccd: cut.mcap: cut off after {bytes} bytes: the description");
            assert_eq!(said.starts_with(&cut), is_one, "{command}: {said}");
            assert_eq!(said.contains("not a recording of fccd"), !is_one, "{said}");
            let exit = if is_one { exit } else { 2 };
            assert_eq!(ended.status.code(), Some(exit), "{command}: {said}");
        }
        let kept = fs::read(folder.path().join("cut.mcap")).unwrap();
        assert_eq!(kept, &whole[..bytes]);
    }
}

//! Commands on a damaged recording: output and exit codes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The exit code, as in `fccd --help`.
const INCOMPLETE: Option<i32> = Some(13);
/// Kinds of records (MCAP specification), and the length of the magic number at
/// both ends of a file.
const CHUNK: u8 = 6;
const CHUNK_INDEX: u8 = 8;
const MAGIC_BYTES: usize = 8;
const NOT_REPLAYED: Option<i32> = Some(8);

fn fccd(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_fccd"))
        .args(arguments)
        .output();
    output.unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn json(output: &Output) -> Value {
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

/// Flies for 150 s in lockstep: some megabytes, in several chunks.
fn recorded(folder: &Path) -> PathBuf {
    let output = fccd(&[
        "fly",
        "--lockstep",
        "--seconds",
        "150",
        "--recordings",
        text(folder),
    ]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    fcc_record::files(folder).unwrap().remove(0)
}

/// Offset and length of all records of a kind.
fn records(bytes: &[u8], opcode: u8) -> Vec<(usize, usize)> {
    let mut at = MAGIC_BYTES;
    let mut found = Vec::new();
    while at < bytes.len() - MAGIC_BYTES {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        if bytes[at] == opcode {
            found.push((at, 9 + length));
        }
        at += 9 + length;
    }
    found
}

#[test]
fn a_recording_without_a_tick_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let file = recorded(folder.path());
    let bytes = fs::read(&file).unwrap();
    // In the first chunk that has a tick.
    let (first, length) = records(&bytes, CHUNK)[1];
    fs::write(&file, &bytes[..first + length / 2]).unwrap();
    let output = fccd(&["recover", text(&file), "--json"]);
    assert_eq!(json(&output)["ticks"], 0);
    assert_eq!(output.status.code(), INCOMPLETE);
    let output = fccd(&["replay", text(&file)]);
    assert_eq!(output.status.code(), NOT_REPLAYED);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("nothing was compared"), "{said}");
}

#[test]
fn every_command_reports_damage_and_continues_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = recorded(folder.path());
    let ticks = json(&fccd(&["list", text(folder.path()), "--json"]))[0]["ticks"].clone();
    let ticks = ticks.as_u64().unwrap();
    let mut bytes = fs::read(&file).unwrap();
    let chunks = records(&bytes, CHUNK);
    assert!(chunks.len() >= 4, "{}", chunks.len());
    let (at, length) = chunks[2];
    bytes[at + length / 2] ^= 0x40;
    fs::write(&file, &bytes).unwrap();

    let output = fccd(&["list", text(folder.path()), "--json"]);
    assert_eq!(output.status.code(), INCOMPLETE);
    let entry = &json(&output)[0];
    assert_eq!(entry["file"], "damaged");
    let damage = &entry["damages"][0];
    assert_eq!(damage["from_byte"], at);
    assert_eq!(damage["to_byte"], at + length);
    let missing = damage["ticks"].as_u64().unwrap();
    let first = damage["first_tick"].as_u64().unwrap();
    let last = damage["last_tick"].as_u64().unwrap();
    assert_eq!(last - first + 1, missing);
    assert_eq!(entry["ticks"], ticks - missing);
    let output = fccd(&["list", text(folder.path())]);
    assert_eq!(output.status.code(), INCOMPLETE);
    let listed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        listed.contains(" damaged") && listed.contains("fccd recover FILE"),
        "{listed}"
    );
    let words = format!("ticks {first} to {last} are missing");
    assert!(String::from_utf8_lossy(&output.stderr).contains(&words));
    let quick = fccd(&["list", "--quick", text(folder.path())]);
    assert_eq!(quick.status.code(), Some(0));

    let page = folder.path().join("page.html");
    let output = fccd(&["report", text(&file), "--html", text(&page)]);
    assert_eq!(output.status.code(), INCOMPLETE);
    assert!(String::from_utf8_lossy(&output.stdout).contains(&words));
    assert!(fs::read_to_string(&page).unwrap().contains(&words));
    let output = fccd(&["report", text(&file), "--json"]);
    assert_eq!(output.status.code(), INCOMPLETE);
    assert_eq!(json(&output)["continuity"]["lost"], missing);
    assert_eq!(json(&output)["continuity"]["last_tick"], ticks);

    let output = fccd(&["replay", text(&file), "--json"]);
    assert_eq!(output.status.code(), NOT_REPLAYED);
    let replayed = json(&output);
    assert_eq!(replayed["last_tick"], first - 1);
    assert_eq!(replayed["identity"]["differing"], 0);
    assert_eq!(replayed["unflown"]["first"], last + 1);
    assert_eq!(replayed["unflown"]["last"], ticks);
    let output = fccd(&["replay", text(&file)]);
    let compared = format!("compared up to tick {}", first - 1);
    assert!(String::from_utf8_lossy(&output.stdout).contains(&compared));

    let output = fccd(&["recover", text(&file), "--json"]);
    assert_eq!(output.status.code(), INCOMPLETE);
    let recovered = json(&output);
    assert_eq!(recovered["was_whole"], false);
    assert_eq!(recovered["ticks"], ticks - missing);
    let kept = recovered["kept"].as_str().unwrap();
    assert_eq!(fs::read(kept).unwrap(), bytes);
    let output = fccd(&["list", text(folder.path()), "--json"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(json(&output)[0]["file"], "whole");
    assert_eq!(json(&output)[0]["not_recorded"], missing);
    // It still reports what is missing, and is replayed up to there.
    let output = fccd(&["replay", text(&file), "--json"]);
    assert_eq!(output.status.code(), NOT_REPLAYED);
    assert_eq!(json(&output)["last_tick"], first - 1);
}

/// The index of a chunk contains nothing of the flight.
#[test]
fn a_damaged_index_loses_nothing_of_the_flight() {
    let folder = tempfile::tempdir().unwrap();
    let file = recorded(folder.path());
    let ticks = json(&fccd(&["list", text(folder.path()), "--json"]))[0]["ticks"].clone();
    let mut bytes = fs::read(&file).unwrap();
    let (at, _) = records(&bytes, CHUNK_INDEX)[1];
    bytes[at + 12] ^= 1;
    fs::write(&file, &bytes).unwrap();
    let output = fccd(&["replay", text(&file), "--json"]);
    assert_eq!(output.status.code(), INCOMPLETE);
    let replayed = json(&output);
    assert_eq!(replayed["unflown"], Value::Null);
    assert_eq!(replayed["ticks"], ticks);
    assert_eq!(replayed["identity"]["differing"], 0);
    let recovered = json(&fccd(&["recover", text(&file), "--json"]));
    assert_eq!(recovered["ticks"], ticks);
    assert_eq!(recovered["damages"][0]["ticks"], 0);
}

/// Opening a FIFO would wait for somebody to write into it.
#[test]
fn a_fifo_and_a_device_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let fifo = folder.path().join("flight.mcap");
    nix::unistd::mkfifo(&fifo, nix::sys::stat::Mode::S_IRWXU).unwrap();
    for command in ["report", "recover", "replay"] {
        for file in [text(&fifo), "/dev/zero"] {
            let output = fccd(&[command, file]);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(!output.status.success(), "{command} {file}");
            assert!(
                said.contains(file) && said.contains("not a regular file"),
                "{said}"
            );
        }
    }
    let output = fccd(&["list", text(folder.path())]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("not a regular file"), "{said}");
    assert_eq!(output.status.code(), INCOMPLETE);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("no recordings that can be read"), "{said}");
}

/// Another user of the folder could choose what is read, and when it changes.
#[test]
fn a_link_in_a_folder_is_not_followed_and_a_named_one_is() {
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let file = recorded(elsewhere.path());
    let link = folder.path().join("flight.mcap");
    std::os::unix::fs::symlink(&file, &link).unwrap();
    let output = fccd(&["list", text(folder.path())]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("a symbolic link, which is not followed"),
        "{said}"
    );
    assert_eq!(output.status.code(), INCOMPLETE);
    assert!(fccd(&["report", text(&link)]).status.success());
}

/// Under any name: no output replaces what is read.
#[test]
fn an_input_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = recorded(folder.path());
    let whole = fs::read(&file).unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::hard_link(&file, at("page.html")).unwrap();
    fs::create_dir(at("tables")).unwrap();
    std::os::unix::fs::symlink(&file, at("link")).unwrap();
    std::os::unix::fs::symlink(&file, at("tables/events.csv")).unwrap();
    let config = at("c.toml");
    fs::write(&config, "[built-in]\n").unwrap();
    let (file_name, config_name) = (text(&file), text(&config));
    let replay = ["replay", file_name, "--config", config_name];
    for arguments in [
        &[&replay[..], &["--csv", file_name]].concat()[..],
        &[&replay[..], &["--csv", text(&at("link"))]].concat(),
        &[&replay[..], &["--csv", config_name]].concat(),
        &["report", file_name, "--html", text(&at("page.html"))],
        &["report", file_name, "--csv", text(&at("tables"))],
    ] {
        let output = fccd(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        assert!(
            said.contains("which this command uses, too: choose another name"),
            "{said}"
        );
    }
    assert!(fs::read(&file).unwrap() == whole);
    assert_eq!(fs::read_to_string(&config).unwrap(), "[built-in]\n");
}

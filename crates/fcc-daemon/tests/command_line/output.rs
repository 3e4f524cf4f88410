//! Output that cannot be written.

use std::fs::File;
use std::io;
use std::process::Stdio;

use super::{fccd, fly};

/// A device on which every write fails: no space left.
fn full() -> Stdio {
    File::options()
        .write(true)
        .open("/dev/full")
        .unwrap()
        .into()
}

/// A pipe whose reader has left.
fn left() -> Stdio {
    let (reader, writer) = io::pipe().unwrap();
    drop(reader);
    writer.into()
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    for words in [
        &["list"][..],
        &["list", "--json"],
        &["completions", "bash"],
        &["--help"],
        &["--version"],
    ] {
        let ended = fccd(folder.path(), words).stdout(left()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(
            (ended.status.code(), said.as_str()),
            (Some(0), ""),
            "{words:?}"
        );
    }
}

#[test]
fn a_result_that_cannot_be_printed_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    std::fs::write(folder.path().join("good.toml"), "[built-in]\n").unwrap();
    for words in [
        &["list"][..],
        &["list", "--json"],
        &["check", "good.toml"],
        &[
            "timing",
            "--rate",
            "100",
            "--seconds",
            "0.1",
            "--priority",
            "0",
        ],
        &["completions", "bash"],
        &["--help"],
    ] {
        let ended = fccd(folder.path(), words).stdout(full()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{words:?}: {said}");
        assert!(
            said.contains("could not be printed: No space left"),
            "{words:?}: {said}"
        );
    }
}

#[test]
fn the_exit_code_is_that_of_the_findings() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wrong.toml"), "[lop]\n").unwrap();
    for words in [
        &["check", "wrong.toml"][..],
        &["check", "wrong.toml", "--json"],
        &["land"],
    ] {
        let ended = fccd(folder.path(), words)
            .stdout(full())
            .stderr(full())
            .status();
        assert_eq!(ended.unwrap().code(), Some(2), "{words:?}");
    }
}

#[test]
fn a_flight_ends_with_its_own_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    for json in [&["--json"][..], &[]] {
        for output in [full, left] {
            let ended = fccd(
                folder.path(),
                &["fly", "--lockstep", "--seconds", "2", "--quiet"],
            )
            .args(json)
            .stdout(output())
            .status()
            .unwrap();
            assert_eq!(ended.code(), Some(0));
        }
    }
}

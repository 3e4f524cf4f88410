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

/// An output that is open for reading only (`fccd list 1< file`).
fn read_only() -> Stdio {
    File::open("/dev/null").unwrap().into()
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

/// As in `fccd report FILE --html /dev/stdout | head -1`.
#[test]
fn a_reader_of_a_written_file_that_leaves_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    std::fs::write(folder.path().join("c.toml"), "[built-in]\n").unwrap();
    let flown = fcc_record::files(&folder.path().join("recordings")).unwrap();
    let flown = flown[0].to_str().unwrap();
    for words in [
        &["report", flown, "--html", "/dev/stdout"][..],
        &[
            "replay",
            flown,
            "--config",
            "c.toml",
            "--csv",
            "/dev/stdout",
        ],
    ] {
        let ended = fccd(folder.path(), words).stdout(left()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!((ended.status.code(), said.as_str()), (Some(0), ""));
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
        &["--version"],
    ] {
        let ended = fccd(folder.path(), words).stdout(full()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{words:?}: {said}");
        assert!(
            said.contains("fccd: the result could not be printed: No space left"),
            "{words:?}: {said}"
        );
    }
}

#[test]
fn an_output_that_is_not_open_for_writing_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    for words in [&["list"][..], &["list", "--json"], &["completions", "bash"]] {
        let output = fccd(folder.path(), words).stdout(read_only()).output();
        let ended = output.unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{words:?}: {said}");
        assert!(said.contains("Bad file descriptor"), "{words:?}: {said}");
    }
}

/// What Rust's runtime opens in its place takes everything.
#[test]
fn an_output_that_is_closed_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    fly(folder.path());
    for words in ["list", "list --json", "completions bash", "--version"] {
        let mut shell = std::process::Command::new("sh");
        let closed = format!("\"$0\" {words} >&-");
        shell.args(["-c", &closed, env!("CARGO_BIN_EXE_fccd")]);
        let ended = shell.current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{words}: {said}");
        assert!(said.contains("Bad file descriptor"), "{words}: {said}");
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
fn a_flight_whose_result_cannot_be_printed_is_a_failure_and_a_reader_that_left_none() {
    let folder = tempfile::tempdir().unwrap();
    for json in [&["--json"][..], &[]] {
        for (output, code) in [(full as fn() -> Stdio, 1), (left, 0)] {
            let ended = fccd(
                folder.path(),
                &["fly", "--lockstep", "--seconds", "2", "--quiet"],
            )
            .args(json)
            .stdout(output())
            .status()
            .unwrap();
            assert_eq!(ended.code(), Some(code), "{json:?}");
        }
    }
}

/// A name of two lines does not look like two messages.
#[test]
fn the_end_of_a_line_in_a_name_is_escaped() {
    let folder = tempfile::tempdir().unwrap();
    for words in [
        &["check", "a\nb: valid"][..],
        &["plan", "check", "a\nb: valid"],
        &["fly", "--config=a\nb: valid"],
        &["report", "a\nb: valid"],
    ] {
        let ended = fccd(folder.path(), words).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert!(said.contains("a\\nb: valid: cannot be read"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

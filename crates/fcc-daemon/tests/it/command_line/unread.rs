//! An output that nobody reads, or late: a full pipe, as behind a terminal that Ctrl-S stopped.

use std::fs;
use std::io::{self, PipeReader, PipeWriter, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;

use super::{PATIENCE, fccd};

/// A process that ends at the latest with this.
struct Flown(Child);

impl Drop for Flown {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Flown {
    /// A flight with both outputs into a pipe.
    fn start(folder: &Path, into: PipeWriter) -> Self {
        let config = "[built-in]\n[telemetry]\nenabled = false\n";
        fs::write(folder.join("c.toml"), config).unwrap();
        let words = ["fly", "--config", "c.toml", "--seconds", "600", "--json"];
        let mut command = fccd(folder, &words);
        command.stdout(into.try_clone().unwrap()).stderr(into);
        Self(command.spawn().unwrap())
    }

    /// How it ends after SIGTERM, and after how long.
    fn end(&mut self) -> (ExitStatus, Duration) {
        let begun = Instant::now();
        kill(Pid::from_raw(self.0.id() as i32), Signal::SIGTERM).unwrap();
        loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                return (status, begun.elapsed());
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// A pipe that takes no more.
fn full_pipe() -> (PipeReader, PipeWriter) {
    let (reader, mut writer) = io::pipe().unwrap();
    fcntl(&writer, FcntlArg::F_SETFL(OFlag::O_NONBLOCK)).unwrap();
    while writer.write(&[b'.'; 4096]).is_ok() {}
    fcntl(&writer, FcntlArg::F_SETFL(OFlag::empty())).unwrap();
    (reader, writer)
}

/// Waits until ticks are on the disk.
fn wait_until_flown(folder: &Path) {
    let begun = Instant::now();
    let is_flown = || {
        let files = fcc_record::files(&folder.join("recordings")).unwrap_or_default();
        let sizes = files
            .iter()
            .map(|file| fs::metadata(file).map_or(0, |found| found.len()));
        sizes.sum::<u64>() > 200_000
    };
    while !is_flown() {
        assert!(begun.elapsed() < PATIENCE, "it does not fly");
        thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_flight_begins_and_ends_though_nobody_reads_its_output() {
    let folder = tempfile::tempdir().unwrap();
    let (_reader, writer) = full_pipe();
    let mut flown = Flown::start(folder.path(), writer);
    wait_until_flown(folder.path());
    let (status, took) = flown.end();
    assert_eq!(status.code(), Some(0));
    assert!(took < Duration::from_secs(5), "{took:?}");
    let listed = fccd(folder.path(), &["list", "--json"]).output().unwrap();
    let listed: Value = serde_json::from_slice(&listed.stdout).unwrap();
    assert_eq!(listed[0]["file"], "whole", "{listed}");
}

#[test]
fn a_reader_that_is_late_at_the_end_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (mut reader, writer) = full_pipe();
    let mut flown = Flown::start(folder.path(), writer);
    wait_until_flown(folder.path());
    let reading = thread::spawn(move || {
        // Of the 2 s that the end waits, from before the signal on.
        thread::sleep(Duration::from_millis(700));
        let mut all = String::new();
        reader.read_to_string(&mut all).unwrap();
        all
    });
    let (status, _) = flown.end();
    let all = reading.join().unwrap();
    assert_eq!(status.code(), Some(0));
    let (messages, result) = all.trim_start_matches('.').split_once("\n{\n").unwrap();
    assert!(messages.contains("standby -> engaged"), "{messages}");
    assert!(messages.contains("stop requested"), "{messages}");
    let result: Value = serde_json::from_str(&format!("{{\n{result}")).unwrap();
    assert_eq!(result["released"], true, "{result}");
}

//! The program as a shell uses it: what it prints, what happens when printing
//! fails, and how it ends.

mod calibrate;
mod check_controls;
mod damaged;
mod named_files;
mod output;
mod plans;
mod probe;
mod recordings;
mod remarks;
mod results;
mod servos;
mod setpoints;
mod top;
mod unread;
mod usage;

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Long after a healthy machine has answered.
const PATIENCE: Duration = Duration::from_secs(20);

/// The program with these arguments, in a folder.
fn fccd(folder: &std::path::Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fccd"));
    command.current_dir(folder).args(arguments);
    command
}

/// Flies briefly, recorded in `recordings`.
fn fly(folder: &std::path::Path) {
    let flown = fccd(folder, &["fly", "--lockstep", "--seconds", "2", "--quiet"])
        .output()
        .unwrap();
    assert!(flown.status.success(), "{flown:?}");
}

/// A flight that continues until this is dropped.
struct Flight(Child);

impl Flight {
    /// Starts it, and waits until it can be watched.
    fn start(folder: &std::path::Path, instance: &str) -> Self {
        let words = ["fly", "--no-recording", "--quiet", "--seconds", "600"];
        let flight = fccd(folder, &words)
            .args(["--instance", instance])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let flight = Self(flight);
        let begun = Instant::now();
        let snapshot = ["top", "--json", "--instance", instance];
        while !fccd(folder, &snapshot).output().unwrap().status.success() {
            assert!(begun.elapsed() < PATIENCE, "no flight was published");
        }
        flight
    }
}

impl Drop for Flight {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

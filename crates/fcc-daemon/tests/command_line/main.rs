//! The program as a shell sees it: what it prints, where that fails, and how it
//! ends.

#![cfg(test)]

mod damaged;
mod output;
mod top;

use std::process::Command;

/// The program with these arguments, in a folder of its own.
fn fccd(folder: &std::path::Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fccd"));
    command.current_dir(folder).args(arguments);
    command
}

/// Flies for a moment, recorded in `recordings`.
fn fly(folder: &std::path::Path) {
    let flown = fccd(folder, &["fly", "--lockstep", "--seconds", "2", "--quiet"])
        .output()
        .unwrap();
    assert!(flown.status.success(), "{flown:?}");
}

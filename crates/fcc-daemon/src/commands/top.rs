//! `fccd top`: a flight on this machine, live.
//!
//! | module | what it does |
//! |---|---|
//! | `picture` | what is known of the flight, from its live telemetry |
//! | `terminal` | the terminal: keys, redrawing, leaving it as it was |
//! | `screen`, `flight`, `horizon`, `timing`, `health` | the screen and its parts |
//! | `snapshot` | the same as JSON |

mod flight;
mod health;
mod horizon;
mod picture;
mod screen;
mod snapshot;
mod terminal;
mod timing;

#[cfg(test)]
mod tests;

use std::io::{self, IsTerminal};
use std::thread;
use std::time::{Duration, Instant};

use fcc_live::{WatchError, Watcher};

use self::picture::Picture;
use self::snapshot::Snapshot;
use super::fail;
use crate::cli::TopArgs;
use crate::exit::Exit;
use crate::output;

/// A status comes each second.
const PATIENCE: Duration = Duration::from_millis(1_500);

/// Watches a daemon.
pub(super) fn top(args: &TopArgs) -> Exit {
    let watcher = match Watcher::open(&args.instance) {
        Ok(watcher) => watcher,
        Err(error) => return fail(&error.to_string()),
    };
    if args.json {
        return match snapshot(watcher) {
            Ok(snapshot) => output::json(&snapshot, Exit::Success),
            Err(error) => fail(&error.to_string()),
        };
    }
    if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        return fail("fccd top needs a terminal: run it in one, or use --json");
    }
    match terminal::watch(&args.instance, watcher) {
        Ok(()) => Exit::Success,
        Err(error) => fail(&format!("the terminal: {error}")),
    }
}

fn snapshot(mut watcher: Watcher) -> Result<Snapshot, WatchError> {
    let mut picture = Picture::new(&watcher);
    let deadline = Instant::now() + PATIENCE;
    while !picture.is_whole() && Instant::now() < deadline {
        picture.update(&mut watcher)?;
        thread::sleep(Duration::from_millis(5));
    }
    Ok(Snapshot::of(&picture))
}

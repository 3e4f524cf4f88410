//! `fccd top`: a flight on this machine, live.

use fcc_core::flight::Autopilot;
use fcc_live::Watcher;

use super::fail;
use crate::cli::TopArgs;
use crate::exit::Exit;
use crate::output;

/// Watches a daemon.
pub(super) fn top(args: &TopArgs) -> Exit {
    if args.json {
        return match Watcher::open(&args.instance).and_then(fcc_top::snapshot) {
            Ok(snapshot) => output::json(&snapshot, Exit::Success),
            Err(error) => fail(&error.to_string()),
        };
    }
    match fcc_top::top::<Autopilot>(&args.instance) {
        Ok(()) => Exit::Success,
        Err(error) => fail(&error.to_string()),
    }
}

//! `fccd top`: a flight on this machine, live.

use fcc_core::flight::Autopilot;
use fcc_live::Watcher;

use super::failure::Failure;
use crate::cli::TopArgs;
use crate::exit::Exit;
use crate::output;

/// Watches a daemon.
pub(super) fn top(args: &TopArgs) -> Result<Exit, Failure> {
    if args.json {
        let snapshot = Watcher::open(&args.instance).and_then(fcc_top::snapshot);
        let snapshot = snapshot.map_err(Failure::new)?;
        return Ok(output::json(&snapshot, Exit::Success));
    }
    fcc_top::top::<Autopilot>(&args.instance).map_err(Failure::new)?;
    Ok(Exit::Success)
}

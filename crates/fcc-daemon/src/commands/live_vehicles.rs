//! Live telemetry of the vehicles beside the aeroplane.

use std::io::Stdin;

use fcc_flight::flight::Observer;
use fcc_flight::vehicle::{Vehicle, live_vehicle};
use fcc_live::{Commandable, RelayError, WatcherOf, run_publisher};
use fcc_report::Reported;
use fcc_telemetry::Instance;
use fcc_top::Watched;

use super::failure::Failure;
use crate::exit::Exit;
use crate::output;
use crate::process::own_program;

/// A vehicle that is flown, reported, watched and commanded.
pub(super) trait Shown: Vehicle + Reported<Addition = ()> + Commandable + Watched {}

impl<V: Vehicle + Reported<Addition = ()> + Commandable + Watched> Shown for V {}

/// What the commands do with a vehicle that is published.
pub(super) struct LiveKind {
    /// Watches it; as JSON once.
    pub(super) watch: fn(&Instance, bool) -> Result<Exit, Failure>,
    /// Publishes it, in a process of its own.
    pub(super) publish: fn(&Stdin) -> Result<(), RelayError>,
}

impl LiveKind {
    pub(super) const fn of<V: Watched>() -> Self {
        Self {
            watch: watch::<V>,
            publish: run_publisher::<V, _>,
        }
    }
}

fn watch<V: Watched>(instance: &Instance, is_json: bool) -> Result<Exit, Failure> {
    if is_json {
        let snapshot = WatcherOf::<V>::open(instance).and_then(fcc_top::snapshot);
        let snapshot = snapshot.map_err(Failure::new)?;
        return Ok(output::json(&snapshot, Exit::Success));
    }
    fcc_top::top::<V>(instance).map_err(Failure::new)?;
    Ok(Exit::Success)
}

/// Publishes a flight.
pub(super) fn publisher<V: Shown>(config: &V::Config) -> Option<Box<dyn Observer<V>>> {
    let start = || {
        let mut program = own_program("publisher");
        program.arg(V::NAME);
        Ok(program)
    };
    live_vehicle::<V>(config, Box::new(start))
}

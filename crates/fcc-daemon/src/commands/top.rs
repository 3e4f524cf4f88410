//! `fccd top`: a flight on this machine, live.

use fcc_fixed_wing::Autopilot;
use fcc_live::{WatcherOf, running};
use fcc_telemetry::Instance;
use fcc_top::Watched;

use super::failure::Failure;
use super::vehicles::Kind;
use crate::cli::TopArgs;
use crate::exit::Exit;
use crate::output;

/// Watches a daemon.
pub(super) fn top(args: &TopArgs) -> Result<Exit, Failure> {
    let instance = args.instance.clone();
    let instance = instance.unwrap_or_else(the_one);
    let kind = Kind::of_instance(&instance);
    kind.map_or(watch::<Autopilot> as _, |kind| kind.top)(&instance, args.json)
}

/// Watches a vehicle.
pub(super) fn watch<V: Watched>(instance: &Instance, is_json: bool) -> Result<Exit, Failure> {
    if is_json {
        let snapshot = WatcherOf::<V>::open(instance).and_then(fcc_top::snapshot);
        let snapshot = snapshot.map_err(Failure::new)?;
        return Ok(output::json(&snapshot, Exit::Success));
    }
    fcc_top::top::<V>(instance).map_err(Failure::new)?;
    Ok(Exit::Success)
}

/// The only daemon that runs, or else the one without another name.
pub(super) fn the_one() -> Instance {
    one_of(&running())
}

fn one_of(running: &[Instance]) -> Instance {
    match running {
        [one] => one.clone(),
        _ => Instance::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_daemon_is_meant_whatever_its_name() {
        let named = |names: &[&str]| names.iter().map(|name| name.parse().unwrap()).collect();
        let one = |names: &[&str]| -> String {
            let running: Vec<Instance> = named(names);
            one_of(&running).to_string()
        };
        assert_eq!(one(&[]), "fccd");
        assert_eq!(one(&["left"]), "left");
        assert_eq!(one(&["fccd", "left"]), "fccd");
        assert_eq!(one(&["left", "right"]), "fccd");
    }
}

//! `fccd run`: the aircraft of a configuration, until told to stop.

use super::fly::conduct;
use crate::cli::RunArgs;
use crate::config::Config;
use crate::exit::Exit;
use crate::flight::{Pace, Plan};

/// Flies a configuration until told to stop.
pub(super) fn run(args: &RunArgs) -> Exit {
    match Config::load(&args.config) {
        Ok(mut config) => {
            if let Some(instance) = &args.instance {
                config.telemetry.instance = instance.clone();
            }
            let plan = Plan {
                pace: Pace::RealTime,
                seconds: None,
                quiet: args.quiet,
                announce: true,
            };
            conduct(&config, plan, args.json)
        }
        Err(error) => {
            eprintln!("{error}");
            Exit::Usage
        }
    }
}

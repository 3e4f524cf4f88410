//! `fccd fly`: the built-in aircraft through the pattern.

use fcc_runtime::SpawnError;

use super::{fail, print_json};
use crate::cli::FlyArgs;
use crate::config::{BuiltInSection, Config, CourseSection};
use crate::exit::Exit;
use crate::flight::{FlyError, Outcome, Pace, Plan, assemble, fly as fly_assembly};

/// The legs that a flight has if nobody says how long it is to be.
const DEFAULT_LEGS: f64 = 8.0;
/// How long a flight without a pattern is if nobody says, s.
const DEFAULT_HOLD_S: f64 = 60.0;

/// Flies the built-in aircraft.
pub(super) fn fly(args: &FlyArgs) -> Exit {
    let config = match configuration(args) {
        Ok(config) => config,
        Err(message) => {
            eprintln!("{message}");
            return Exit::Usage;
        }
    };
    let plan = Plan {
        pace: if args.lockstep {
            Pace::Lockstep
        } else {
            Pace::RealTime
        },
        seconds: Some(args.seconds.unwrap_or(match config.course {
            CourseSection::Hold => DEFAULT_HOLD_S,
            CourseSection::TimedPattern { hold_s, leg_s, .. } => hold_s + DEFAULT_LEGS * leg_s,
        })),
        quiet: args.quiet,
        announce: true,
    };
    conduct(&config, plan, args.json)
}

/// Flies a configuration and prints how it ended.
pub(super) fn conduct(config: &Config, plan: Plan, json: bool) -> Exit {
    let assembly = match assemble(config) {
        Ok(assembly) => assembly,
        Err(error) => return fail(&error.to_string()),
    };
    match fly_assembly(assembly, &config.tick, plan) {
        Ok(outcome) => report(&outcome, json),
        Err(error) => {
            let exit = match error {
                FlyError::Spawn(SpawnError::Realtime(_)) => Exit::RealtimeRefused,
                _ => Exit::Failure,
            };
            fail(&error.to_string());
            exit
        }
    }
}

fn report(outcome: &Outcome, json: bool) -> Exit {
    if json {
        let printed = print_json(outcome);
        if printed != Exit::Success {
            return printed;
        }
    } else {
        println!("{}", outcome.to_text());
    }
    outcome.exit
}

fn configuration(args: &FlyArgs) -> Result<Config, String> {
    let mut config = match &args.config {
        Some(path) => Config::load(path).map_err(|error| error.to_string())?,
        None => Config {
            built_in: Some(BuiltInSection::default()),
            ..Config::default()
        },
    };
    let Some(built_in) = &mut config.built_in else {
        return Err(
            "fccd fly is for the built-in aircraft: give a file with a [built-in] section, \
             or use fccd run for another"
                .to_owned(),
        );
    };
    if let Some(instance) = &args.instance {
        config.telemetry.instance = instance.clone();
    }
    if let Some(seed) = args.seed {
        built_in.seed = seed;
    }
    if let Some(gusts) = args.gusts {
        built_in.gusts = gusts;
    }
    Ok(config)
}

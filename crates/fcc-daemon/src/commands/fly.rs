//! `fccd fly`: the built-in aircraft through the pattern.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_report::FlownPlan;
use fcc_runtime::SpawnError;
use fcc_telemetry::StationLink;
use serde::Serialize;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::calibrate::apply_calibration;
use super::failure::Failure;
use super::lookup::{LONG, looking_up};
use super::outcome;
use crate::cli::{FlyArgs, RecordingArgs};
use crate::exit::Exit;
use crate::observers::{Announcer, Beginning, PlanResult, Service, StatusLine, aircraft};
use crate::output::{self, Printer};
#[cfg(feature = "live")]
use crate::process::own_program;
use crate::process::{Process, tolerate};
use fcc_flight::config::{BuiltInSection, Config};
use fcc_flight::flight::{
    Assembly, FlyError, Length, Outcome, Pace, Plan, RecordingRequest, assemble,
    fly as fly_assembly,
};

/// Flies the built-in aircraft.
pub(super) fn fly(args: &FlyArgs) -> Result<Exit, Failure> {
    let (mut config, as_given) = configuration(args)?;
    direct(&mut config, &args.recording);
    apply_calibration(&mut config)?;
    use_plan(&mut config, args.plan.as_deref())?;
    let length_s = config.plan_length_s().filter(|_| config.flies_plan());
    let plan = Plan {
        pace: pace(args),
        length: match length_s.filter(|_| args.seconds.is_none()) {
            Some(length_s) => Length::Flown(length_s),
            None => Length::Engaged(
                args.seconds
                    .unwrap_or_else(|| config.guidance.default_length_s()),
            ),
        },
    };
    conduct(&config, as_given, plan, args.quiet, args.json)
}

/// The pace of `fccd fly`.
pub(super) const fn pace(args: &FlyArgs) -> Pace {
    if args.lockstep {
        Pace::Lockstep
    } else {
        Pace::RealTime
    }
}

/// Prepares the process for a flight, before its first message and its first thread. While
/// the returned value lives, nothing waits for the output.
pub(super) fn prepare(pace: Pace) -> Result<Option<Printer>, Failure> {
    tolerate().map_err(|error| Failure::new(format_args!("signals cannot be caught: {error}")))?;
    // In lockstep printing may wait: there is no real time.
    Ok(match pace {
        Pace::RealTime => output::in_background(),
        Pace::Lockstep => None,
    })
}

/// The sensors and actuators of a configuration.
pub(super) fn assembled(config: &Config) -> Result<Assembly, Failure> {
    let names = config.host_names();
    let assembled = looking_up(&names, LONG, output::message, || assemble(config));
    assembled.map_err(|error| {
        let exit = if error.is_taken() {
            Exit::Taken
        } else {
            Exit::Failure
        };
        Failure::of(exit, error)
    })
}

/// Flies a configuration and prints the result.
pub(super) fn conduct(
    config: &Config,
    as_given: Option<String>,
    plan: Plan,
    quiet: bool,
    json: bool,
) -> Result<Exit, Failure> {
    let mut assembly = assembled(config)?;
    #[cfg(feature = "live")]
    {
        assembly.publisher = Some(Box::new(|| Ok(own_program("publisher"))));
    }
    if plan.pace == Pace::RealTime {
        for link in StationLink::all() {
            output::message(format_args!("ground station: {link}"));
        }
    }
    let recording = RecordingRequest::of(config, as_given);
    let mut observers = assembly.observers(config, plan.pace, recording);
    observers.push(Box::new(Announcer::default()));
    observers.push(Box::new(Beginning(config.remarks_at_start())));
    if !quiet {
        let by_command = !config.engage.command_needs_switch;
        let line = StatusLine::new(aircraft::describe, aircraft::switch, by_command);
        observers.push(Box::new(line));
    }
    observers.push(Box::new(Service::from_environment()));
    let flown_plan = PlanResult::default();
    observers.push(Box::new(flown_plan.clone()));
    let flown = fly_assembly(
        assembly,
        &config.tick,
        plan,
        observers,
        &mut Process::new(config),
    );
    let outcome = flown.map_err(|error| {
        let exit = match error {
            FlyError::Spawn(SpawnError::Realtime(_)) => Exit::RealtimeDenied,
            FlyError::Taken(_) => Exit::Taken,
            _ => Exit::Failure,
        };
        Failure::of(exit, error)
    })?;
    Ok(report(&outcome, &flown_plan.0.borrow(), json))
}

pub(super) fn report(outcome: &Outcome, flown_plan: &FlownPlan, json: bool) -> Exit {
    #[derive(Serialize)]
    struct Printed<'a> {
        #[serde(flatten)]
        outcome: &'a Outcome,
        #[serde(skip_serializing_if = "FlownPlan::is_empty")]
        flown_plan: &'a FlownPlan,
    }
    // A reader that has left may end the program here: the controls are
    // released, and the recording is on the disk.
    for signal in [SIGTERM, SIGINT] {
        let over = Arc::new(AtomicBool::new(true));
        let _ = signal_hook::flag::register_conditional_default(signal, over);
    }
    let exit = outcome.conclusion.into();
    if json {
        let printed = Printed {
            outcome,
            flown_plan,
        };
        return output::json(&printed, exit);
    }
    output::result(outcome::text(outcome, flown_plan), exit)
}

/// Reads the plan of the command line, or of the configuration, and checks it.
pub(super) fn use_plan(config: &mut Config, file: Option<&Path>) -> Result<(), Failure> {
    if let Some(file) = file {
        config.fly_plan(file.to_owned());
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now_s = now.map_or(0, |since| since.as_secs());
    config.load_plan(now_s).map_err(|error| match file {
        Some(_) => Failure::of(Exit::Usage, error),
        None => Failure::of(Exit::Usage, format_args!("plan.file: {error}")),
    })
}

/// The command line has priority over the file.
pub(super) fn direct(config: &mut Config, args: &RecordingArgs) {
    if let Some(folder) = &args.recordings {
        config.recording.folder.clone_from(folder);
        config.recording.enabled = true;
    }
    config.recording.enabled &= !args.no_recording;
}

/// The configuration, and the text of its file, if there is one.
fn configuration(args: &FlyArgs) -> Result<(Config, Option<String>), Failure> {
    let (mut config, as_given) = match &args.config {
        Some(path) => {
            let (config, text) = Config::load_with_text(path)?;
            (config, Some(text))
        }
        None => (
            Config {
                built_in: Some(BuiltInSection::default()),
                ..Config::default()
            },
            None,
        ),
    };
    let Some(built_in) = &mut config.built_in else {
        return Err(Failure::usage(
            "fccd fly is for the built-in aircraft: give a file with a [built-in] section, \
             or use fccd run for another",
        ));
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
    Ok((config, as_given))
}

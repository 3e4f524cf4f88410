//! `fccd run`: flies the aircraft of a configuration until stopped.

use super::calibrate::apply_calibration;
use super::failure::Failure;
use super::fly::{conduct, direct, use_plan};
use crate::cli::RunArgs;
use crate::exit::Exit;
use crate::process::{RightsError, end_with_parent, give_up};
use fcc_flight::config::Config;
use fcc_flight::flight::{Length, Pace, Plan};

/// Gives up the rights of root, as the configuration says.
pub(super) fn give_up_rights(config: &Config) -> Result<(), Failure> {
    give_up(config).map_err(|error| {
        let exit = match error {
            RightsError::NoUser(_) => Exit::Usage,
            RightsError::System(..) => Exit::Failure,
        };
        Failure::of(exit, error)
    })
}

/// Flies a configuration until stopped.
pub(super) fn run(args: &RunArgs) -> Result<Exit, Failure> {
    let (mut config, text) = Config::load_with_text(&args.config)?;
    direct(&mut config, &args.recording);
    give_up_rights(&config)?;
    // A change of the user ends such an agreement.
    if let Some(parent) = args.end_with {
        end_with_parent(parent).map_err(|error| {
            Failure::new(format_args!("cannot end with process {parent}: {error}"))
        })?;
    }
    if let Some(instance) = &args.instance {
        config.telemetry.instance = instance.clone();
    }
    apply_calibration(&mut config)?;
    use_plan(&mut config, args.plan.as_deref())?;
    let plan = Plan {
        pace: Pace::RealTime,
        length: Length::Open,
    };
    conduct(&config, Some(text), plan, args.quiet, args.json)
}

//! `fccd command`: commands to a daemon on this machine.

use fcc_core::flight::Autopilot;
use fcc_core::units::{FOOT_M, HECTOPASCAL_PA, INHG_PA, KNOT_MPS};
use fcc_live::{Command, CommandError, Commander, PlantLimits};
use fcc_telemetry::units::{AVIATION, Shown};
use serde::Serialize;

use super::failure::Failure;
use crate::cli::{CommandArgs, CommandChoice, SetArgs};
use crate::exit::Exit;
use crate::output;

#[derive(Serialize)]
struct Sent {
    instance: String,
    carried_out: bool,
    /// The tick that carried it out.
    tick: Option<u64>,
    /// Why it was not carried out.
    why: Option<String>,
}

/// Sends a command and prints the result.
pub(super) fn command(args: &CommandArgs) -> Result<Exit, Failure> {
    let command = Command::from(&args.what);
    let units = units(&args.what);
    // By the limits for any aircraft; the daemon knows those of its own.
    command
        .for_the_loop::<Autopilot>(&PlantLimits::new())
        .map_err(|error| Failure::of(Exit::Usage, error.text_in(&units)))?;
    let result = Commander::open(&args.instance).and_then(|mut daemon| daemon.command(&command));
    let exit = match &result {
        Ok(_) => Exit::Success,
        Err(CommandError::Refused(_) | CommandError::InvalidCommand(_)) => Exit::Refused,
        Err(_) => Exit::Failure,
    };
    // In the units of the command line.
    let result = result.map_err(|error| match error {
        CommandError::InvalidCommand(why) => format!("refused: {}", why.text_in(&units)),
        other => other.to_string(),
    });
    if args.json {
        let result = Sent {
            instance: args.instance.to_string(),
            carried_out: result.is_ok(),
            tick: result.as_ref().ok().copied(),
            why: result.err(),
        };
        output::json(&result, exit);
    } else {
        match result {
            Ok(tick) => {
                output::result(format!("carried out in tick {tick}"), exit);
            }
            Err(text) => return Err(Failure::of(exit, text)),
        }
    }
    // A command that was carried out is a success, even if the result cannot be
    // printed.
    Ok(exit)
}

/// An altimeter setting in inches of mercury.
const INHG: Shown = Shown {
    end: "_pa",
    unit: "inHg",
    scale: 1.0 / INHG_PA,
};

/// The units of the command line, for messages.
fn units(what: &CommandChoice) -> Vec<Shown> {
    let is_inhg = matches!(what, CommandChoice::Set(set) if set.altimeter_inhg.is_some());
    let own = is_inhg.then_some(INHG);
    own.into_iter().chain(AVIATION.iter().copied()).collect()
}

impl From<&CommandChoice> for Command {
    fn from(what: &CommandChoice) -> Self {
        match what {
            CommandChoice::Engage => Self::Engage,
            CommandChoice::Disengage => Self::Disengage,
            CommandChoice::Stop => Self::Stop,
            CommandChoice::Set(set) => set.into(),
        }
    }
}

impl From<&SetArgs> for Command {
    fn from(set: &SetArgs) -> Self {
        let altimeter_setting_pa = set
            .altimeter_hpa
            .map(|hpa| hpa * HECTOPASCAL_PA)
            .or_else(|| set.altimeter_inhg.map(|inhg| inhg * INHG_PA));
        let setpoints = [
            ("airspeed_mps", set.airspeed_kt.map(|kt| kt * KNOT_MPS)),
            ("heading_rad", set.heading_deg.map(f64::to_radians)),
            ("altitude_m", set.altitude_ft.map(|ft| ft * FOOT_M)),
            (
                "pressure_altitude_m",
                set.pressure_altitude_ft.map(|ft| ft * FOOT_M),
            ),
            ("height_m", set.height_ft.map(|ft| ft * FOOT_M)),
            ("altimeter_setting_pa", altimeter_setting_pa),
        ];
        let given = setpoints.into_iter();
        Self::set(given.filter_map(|(name, value)| Some((name, value?))))
    }
}

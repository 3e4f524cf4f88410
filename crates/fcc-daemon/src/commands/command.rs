//! `fccd command`: commands to a daemon on this machine.

use fcc_live::{CommandError, Commander, FlightCommand, NewSetpoints};
use serde::Serialize;

use super::fail;
use crate::cli::{CommandArgs, CommandChoice, SetArgs};
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::{FOOT_M, KNOT_MPS};

#[derive(Serialize)]
struct Told {
    instance: String,
    carried_out: bool,
    /// The tick that carried it out.
    tick: Option<u64>,
    /// Why it was not carried out.
    why: Option<String>,
}

/// Gives a command, and says what became of it.
pub(super) fn command(args: &CommandArgs) -> Exit {
    let command = FlightCommand::from(&args.what);
    if let Err(error) = command.check() {
        fail(&error.in_knots_degrees_feet());
        return Exit::Usage;
    }
    let told = Commander::open(&args.instance).and_then(|mut daemon| daemon.command(command));
    let exit = match &told {
        Ok(_) => Exit::Success,
        Err(CommandError::Refused(_) | CommandError::Unflyable(_)) => Exit::Refused,
        Err(_) => Exit::Failure,
    };
    // In the units that it was given in.
    let told = told.map_err(|error| match error {
        CommandError::Unflyable(why) => format!("refused: {}", why.in_knots_degrees_feet()),
        other => other.to_string(),
    });
    if args.json {
        let told = Told {
            instance: args.instance.to_string(),
            carried_out: told.is_ok(),
            tick: told.as_ref().ok().copied(),
            why: told.err(),
        };
        output::json(&told, exit);
    } else {
        match told {
            Ok(tick) => {
                output::result(format!("carried out in tick {tick}"), exit);
            }
            Err(words) => {
                fail(&words);
            }
        }
    }
    // What was carried out stays so, even if that cannot be printed.
    exit
}

impl From<&CommandChoice> for FlightCommand {
    fn from(what: &CommandChoice) -> Self {
        match what {
            CommandChoice::Engage => Self::Engage,
            CommandChoice::Disengage => Self::Disengage,
            CommandChoice::Stop => Self::Stop,
            CommandChoice::Set(set) => Self::Set(NewSetpoints::from(set)),
        }
    }
}

impl From<&SetArgs> for NewSetpoints {
    fn from(set: &SetArgs) -> Self {
        Self {
            airspeed_mps: set.airspeed_kt.map(|kt| kt * KNOT_MPS),
            heading_rad: set.heading_deg.map(f64::to_radians),
            altitude_m: set.altitude_ft.map(|ft| ft * FOOT_M),
        }
    }
}

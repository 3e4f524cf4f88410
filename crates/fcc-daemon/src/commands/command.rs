//! `fccd command`: commands to a daemon on this machine.

use fcc_core::units::{FOOT_M, HECTOPASCAL_PA, INHG_PA, KNOT_MPS};
use fcc_fixed_wing::Autopilot;
use fcc_flight::flight::{OtherUserError, command_another_users};
use fcc_live::{Command, CommandError, Commander, PlantLimits, WatchError};
use fcc_telemetry::Instance;
use fcc_telemetry::units::{AVIATION, Shown};
use serde::Serialize;

use super::failure::Failure;
use super::top::the_one;
use crate::cli::plan::PlanOrder;
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
    let instance = &args.instance.clone().unwrap_or_else(the_one);
    if let CommandChoice::Plan { what } = &args.what
        && let PlanOrder::Replace { file, .. } = what
        && file.to_str().is_none()
    {
        return Err(Failure::usage(format_args!(
            "fccd: {}: the name is not UTF-8, and a command is: rename the file",
            file.display()
        )));
    }
    let command = Command::from(&args.what);
    let units = units(&args.what);
    // By the limits for any aircraft; the daemon knows those of its own, and reads plans.
    if !matches!(command, Command::ReplacePlan { .. }) {
        command
            .for_the_loop::<Autopilot>(&PlantLimits::new())
            .map_err(|error| Failure::of(Exit::Usage, error.text_in(&units)))?;
    }
    let (exit, result) = match send(args, instance, &command) {
        Ok(tick) => (Exit::Success, Ok(tick)),
        Err(Refusal::OfAnother(error)) => {
            let exit = match error {
                OtherUserError::Refused(_) => Exit::Refused,
                _ => Exit::Failure,
            };
            (exit, Err(error.to_string()))
        }
        // In the units of the command line.
        Err(Refusal::OfOwn(CommandError::InvalidCommand(why))) => {
            let why = why.text_in(&units);
            (Exit::Refused, Err(format!("refused: {why}")))
        }
        Err(Refusal::OfOwn(error @ CommandError::Refused(_))) => {
            (Exit::Refused, Err(error.to_string()))
        }
        Err(Refusal::OfOwn(CommandError::Unreachable(error))) => {
            let (which, user) = match &error {
                // A number, as #1000, would begin a comment.
                WatchError::Anothers { user, .. } => {
                    (format!("One runs for {user}, and"), format!("'{user}'"))
                }
                WatchError::PerhapsAnothers(_) => {
                    ("One of another user".to_owned(), "USER".to_owned())
                }
                _ => return print_result(args, instance, Exit::Failure, Err(error.to_string())),
            };
            let why = format!(
                "no fccd named '{instance}' runs here for this user. {which} is commanded with fccd \
                 command --of {user}, if its configuration names you in rights.commanders, or by \
                 sudo -u {user} fccd command"
            );
            (Exit::Failure, Err(why))
        }
        Err(Refusal::OfOwn(error)) => (Exit::Failure, Err(error.to_string())),
    };
    print_result(args, instance, exit, result)
}

/// Prints the tick that carried the command out, or why none did.
fn print_result(
    args: &CommandArgs,
    instance: &Instance,
    exit: Exit,
    result: Result<u64, String>,
) -> Result<Exit, Failure> {
    if args.json {
        let result = Sent {
            instance: instance.to_string(),
            carried_out: result.is_ok(),
            tick: result.as_ref().ok().copied(),
            why: result.err(),
        };
        return Ok(output::json(&result, exit));
    }
    match result {
        Ok(tick) => Ok(output::result(format!("carried out in tick {tick}"), exit)),
        Err(text) => Err(Failure::of(exit, text)),
    }
}

/// Why a command was not carried out, by a daemon of this user or of another.
enum Refusal {
    OfOwn(CommandError),
    OfAnother(OtherUserError),
}

/// To the daemon of this user or, if there is none, of the service; or to that
/// of the user who is given.
fn send(args: &CommandArgs, instance: &Instance, command: &Command) -> Result<u64, Refusal> {
    let another = |user| command_another_users(instance, user, command);
    if let Some(user) = &args.of {
        return another(Some(user)).map_err(Refusal::OfAnother);
    }
    let opened = Commander::open(instance, "fccd command");
    match opened.and_then(|mut daemon| daemon.command(command)) {
        Err(error @ CommandError::Unreachable(_)) => match another(None) {
            Err(OtherUserError::NotThere(..)) => Err(Refusal::OfOwn(error)),
            answered => answered.map_err(Refusal::OfAnother),
        },
        answered => answered.map_err(Refusal::OfOwn),
    }
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
            CommandChoice::Heartbeat { within_s } => Self::set([("heartbeat_s", *within_s)]),
            CommandChoice::Plan { what } => what.into(),
        }
    }
}

impl From<&PlanOrder> for Command {
    fn from(what: &PlanOrder) -> Self {
        match *what {
            PlanOrder::Replace { ref file, item } => Self::ReplacePlan {
                // The daemon was started elsewhere.
                file: std::path::absolute(file)
                    .as_ref()
                    .unwrap_or(file)
                    .display()
                    .to_string(),
                item,
            },
            PlanOrder::Pause => Self::set([("pause", 1.0)]),
            PlanOrder::Resume => Self::set([("plan_item", 0.0)]),
            PlanOrder::Item { number } => Self::set([("plan_item", f64::from(number))]),
            PlanOrder::GoTo {
                latitude_deg,
                longitude_deg,
                altitude_ft,
            } => Self::set([
                ("go_to_latitude_rad", latitude_deg.to_radians()),
                ("go_to_longitude_rad", longitude_deg.to_radians()),
                ("go_to_altitude_m", altitude_ft * FOOT_M),
            ]),
            PlanOrder::Return => Self::set([("return_home", 1.0)]),
            PlanOrder::Land => Self::set([("land", 1.0)]),
            PlanOrder::GoAround => Self::set([("go_around", 1.0)]),
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

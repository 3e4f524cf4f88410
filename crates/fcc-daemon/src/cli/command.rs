//! `fccd command`: commands to a flight.

use clap::{Args, Subcommand};
use fcc_telemetry::Instance;

use super::plan::PlanOrder;
use super::values::number;

/// `fccd command`.
#[derive(Args, Debug)]
pub struct CommandArgs {
    /// The command
    #[command(subcommand)]
    pub what: CommandChoice,
    /// The daemon's name, as given by --instance or in its configuration
    /// [default: that of the only one that runs, or else fccd]
    #[arg(long, value_name = "NAME", global = true)]
    pub instance: Option<Instance>,
    /// The user of the daemon, if it is another's and no service; it has to
    /// permit this one in rights.commanders
    #[arg(long, value_name = "USER", global = true)]
    pub of: Option<String>,
    /// Print the result as JSON
    #[arg(long, global = true)]
    pub json: bool,
}

/// Commands to a flight.
#[derive(Subcommand, Debug)]
pub enum CommandChoice {
    /// Take control with the present state as set points; engaged already, nothing changes
    Engage,
    /// Release the controls
    Disengage,
    /// Release the controls and end the daemon
    Stop,
    /// Fly to other set points; those not given keep their value
    Set(SetArgs),
    /// Promise another command in time; without it the aircraft returns, or does what
    /// the configuration says
    Heartbeat {
        /// Within which time, to 3600; 0 ends the promise
        #[arg(value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
        within_s: f64,
    },
    /// Pause the flight plan, resume it, or leave it
    Plan {
        /// What to fly
        #[command(subcommand)]
        what: PlanOrder,
    },
}

/// `fccd command set`.
#[derive(Args, Debug)]
#[command(override_usage = "fccd command set <OPTION> <VALUE>...")]
#[group(required = true, multiple = true)]
pub struct SetArgs {
    /// Magnetic heading, -720 to 720; turns the shorter way
    #[arg(long, value_parser = number, value_name = "DEG", allow_negative_numbers = true)]
    pub heading_deg: Option<f64>,
    /// Altitude above sea level by the altimeter setting
    #[arg(long, value_parser = number, value_name = "FT", allow_negative_numbers = true)]
    pub altitude_ft: Option<f64>,
    /// Pressure altitude: flight level 55 is 5500
    #[arg(long, value_parser = number, value_name = "FT", allow_negative_numbers = true)]
    pub pressure_altitude_ft: Option<f64>,
    /// Height above the configured field elevation
    #[arg(long, value_parser = number, value_name = "FT", allow_negative_numbers = true)]
    pub height_ft: Option<f64>,
    /// Altimeter setting (QNH), 940 to 1060; also in standby
    #[arg(long, value_parser = number, value_name = "HPA")]
    pub altimeter_hpa: Option<f64>,
    /// The same in inches of mercury, 27.76 to 31.3
    #[arg(long, value_parser = number, value_name = "INHG", conflicts_with = "altimeter_hpa")]
    pub altimeter_inhg: Option<f64>,
    /// Indicated airspeed
    #[arg(long, value_parser = number, value_name = "KT", allow_negative_numbers = true)]
    pub airspeed_kt: Option<f64>,
}

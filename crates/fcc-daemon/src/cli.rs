//! The command line.

mod airframe;
mod calibrate;
#[cfg(feature = "live")]
mod command;
pub mod plan;
mod values;
pub mod x_plane;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use fcc_flight::config::{CpuChoice, EarlyWakeChoice, GustsChoice};
use fcc_telemetry::Instance;
use fcc_timer::TimerKind;

use crate::exit::exit_codes;
pub use airframe::AirframeArgs;
pub use calibrate::CalibrateArgs;
#[cfg(feature = "live")]
pub use command::{CommandArgs, CommandChoice, SetArgs};
use plan::PlanArgs;
use values::{cpu_cap_percent, early_wake, gusts, margin_us, output, positive_seconds, rate_hz};
use x_plane::XPlaneArgs;

/// A real-time flight control computer in software.
#[derive(Parser, Debug)]
#[command(name = "fccd", version, after_help = exit_codes())]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Action,
}

/// `fccd ground`.
#[derive(Args, Debug)]
pub struct GroundArgs {
    /// The options of fcc-ground, see `fccd ground --help`
    #[arg(
        value_name = "OPTION",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    pub options: Vec<OsString>,
}

/// The commands of `fccd`.
#[derive(Subcommand, Debug)]
pub enum Action {
    /// Fly a built-in vehicle: an aeroplane through the timed pattern, a multicopter through a
    /// plan; failsafe ends it
    Fly(FlyArgs),
    /// Fly the aircraft of a configuration file until stopped
    Run(RunArgs),
    /// List recordings
    List(ListArgs),
    /// Recover a recording that is unfinished or damaged
    Recover(RecoverArgs),
    /// Measure how well the loop keeps time: the experiment of the thesis
    Timing(TimingArgs),
    /// Fly a recording again and compare every output bit for bit
    Replay(ReplayArgs),
    /// Watch a flight on this machine, live
    #[cfg(feature = "live")]
    Top(TopArgs),
    /// Send a command to a daemon on this machine
    #[cfg(feature = "live")]
    Command(CommandArgs),
    /// Calibrate a sensor of a configuration, guided step by step
    Calibrate(CalibrateArgs),
    /// Check configuration files
    Check(CheckArgs),
    /// Move each control of an aircraft that stands still, and check its direction
    CheckControls(CheckControlsArgs),
    /// Scale the keys of an airframe from its span, stalling speed and thrust
    Airframe(AirframeArgs),
    /// Check whether this machine suits a real-time loop
    Doctor(DoctorArgs),
    /// List the sensors that are connected to this board
    Probe(ProbeArgs),
    /// Check, show or convert flight plans
    Plan(PlanArgs),
    /// Check fccd against a running X-Plane
    XPlane(XPlaneArgs),
    /// Report on a recorded flight: tables, and a page with plots
    Report(ReportArgs),
    /// Start the ground station: plans, flights and health in a browser
    #[command(disable_help_flag = true)]
    Ground(GroundArgs),
    /// Release X-Plane's controls if the daemon is killed; started by the
    /// daemon itself
    #[command(hide = true)]
    ReleaseHelper,
    /// Publish live telemetry; started by the daemon itself
    #[cfg(feature = "live")]
    #[command(hide = true)]
    Publisher {
        /// Of whose records, if not an aeroplane's
        vehicle: Option<String>,
    },
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the JSON Schema of configuration files, by which editors complete and check them
    Schema,
    /// Write manual pages into a folder, for packages
    #[command(hide = true)]
    Man {
        /// The folder
        folder: PathBuf,
    },
}

/// `fccd fly`.
#[derive(Args, Debug)]
pub struct FlyArgs {
    /// The vehicle: aeroplane or multicopter [default: that of the configuration, or aeroplane]
    #[arg(long, value_name = "NAME")]
    pub vehicle: Option<String>,
    /// Configuration file with a [built-in] section [default: as
    /// config/built-in.toml, or config/multicopter.toml]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// How long to fly from the first engagement on; standby after it counts
    /// [default: the hold and 8 legs; of a plan until it has landed, or its time is over]
    #[arg(long, value_name = "S", value_parser = positive_seconds, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Seed of gusts and sensor noise
    // TOML has no larger numbers: the recording could not contain it.
    #[arg(long, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64),
          allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Flight plan to fly, of QGroundControl or QGC WPL 110, in place of the pattern
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Strength of the gusts
    #[arg(long, value_parser = gusts())]
    pub gusts: Option<GustsChoice>,
    /// Name of this flight for watchers [default: as configured]
    #[arg(long, value_name = "NAME")]
    pub instance: Option<Instance>,
    /// Fly in lockstep: as fast as the machine can, not in real time; the
    /// loop's rate stays the configured one
    #[arg(long)]
    pub lockstep: bool,
    /// Where to record
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// Print no status lines
    #[arg(long, short)]
    pub quiet: bool,
}

/// `fccd run`.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// Configuration file
    #[arg(long, value_name = "FILE")]
    pub config: PathBuf,
    /// Flight plan to fly once engaged, of QGroundControl or QGC WPL 110
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Where to record
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// Name of this daemon for watchers [default: as configured]
    #[arg(long, value_name = "NAME")]
    pub instance: Option<Instance>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// Print no status lines
    #[arg(long, short)]
    pub quiet: bool,
    /// End when the process that started this one ends, which has this number
    #[arg(long, value_name = "PID", hide = true)]
    pub end_with: Option<u32>,
}

/// Where a flight is recorded.
#[derive(Args, Debug)]
pub struct RecordingArgs {
    /// Folder of the recordings [default: recordings, or as configured]
    #[arg(long, value_name = "DIR", value_parser = output())]
    pub recordings: Option<PathBuf>,
    /// Do not record
    #[arg(long, conflicts_with = "recordings")]
    pub no_recording: bool,
}

/// `fccd list`.
#[derive(Args, Debug)]
pub struct ListArgs {
    /// Folder of recordings
    #[arg(value_name = "DIR", default_value = "recordings")]
    pub folder: PathBuf,
    /// Read only the beginning and the end of each file: damage between is not
    /// detected
    #[arg(long)]
    pub quick: bool,
    /// Print the list as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd recover`.
#[derive(Args, Debug)]
pub struct RecoverArgs {
    /// The recording; a finished one replaces it
    pub file: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd timing`.
#[derive(Args, Debug)]
pub struct TimingArgs {
    /// Ticks per second; may be given several times
    #[arg(long = "rate", value_name = "HZ", default_values_t = [40.0, 50.0, 100.0],
          value_parser = rate_hz, allow_negative_numbers = true)]
    pub rates: Vec<f64>,
    /// How long to measure at each rate
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive_seconds,
          allow_negative_numbers = true)]
    pub seconds: f64,
    /// The timer that wakes the loop: timerfd, posix or nanosleep
    #[arg(long, value_name = "TIMER", default_value_t = TimerKind::Timerfd)]
    pub timer: TimerKind,
    /// `SCHED_FIFO` priority of the loop's thread, 0 for the ordinary scheduler
    #[arg(long, default_value_t = 80, value_parser = clap::value_parser!(u8).range(0..=99))]
    pub priority: u8,
    /// The CPU that the loop's thread is bound to
    #[arg(long, value_name = "auto|N")]
    pub cpu: Option<CpuChoice>,
    /// Wake a margin before each deadline and spin until it; auto: if a
    /// real-time priority is granted
    #[arg(long, value_name = "auto|on|off", value_parser = early_wake(), default_value = "auto",
          default_missing_value = "on", num_args = 0..=1)]
    pub early_wake: EarlyWakeChoice,
    /// The longest margin
    #[arg(long, value_name = "US", value_parser = margin_us,
          allow_negative_numbers = true)]
    pub max_margin: Option<f64>,
    /// The largest share of a core to spend on spinning
    #[arg(long, value_name = "PERCENT", value_parser = cpu_cap_percent,
          allow_negative_numbers = true)]
    pub cpu_cap: Option<f64>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd replay`.
#[derive(Args, Debug)]
pub struct ReplayArgs {
    /// The recording; all its parts, oldest first, if it has several
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Show how this configuration would have commanded, instead of comparing
    /// with the recorded one
    #[arg(long, value_name = "OTHER")]
    pub config: Option<PathBuf>,
    /// Write both flights, tick by tick, into a CSV file
    #[arg(long, value_name = "OUT", requires = "config", value_parser = output())]
    pub csv: Option<PathBuf>,
    /// Print what the flight has learned of the aircraft: the section
    /// `[autopilot.airframe]` of a configuration for flights without an airspeed sensor
    #[arg(long, conflicts_with_all = ["config", "csv"])]
    pub airframe: bool,
    /// Run the recorded raw readings through navigation, and show its differences and
    /// its innovations
    #[arg(long, conflicts_with_all = ["config", "csv", "airframe"])]
    pub navigation: bool,
    /// With --navigation: write a page with its plots beside those of the flight
    #[arg(long, value_name = "OUT.html", requires = "navigation", value_parser = output())]
    pub html: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd top`.
#[cfg(feature = "live")]
#[derive(Args, Debug)]
pub struct TopArgs {
    /// The daemon's name, as given by --instance or in its configuration
    /// [default: that of the only one that runs, or else fccd]
    #[arg(long, value_name = "NAME")]
    pub instance: Option<Instance>,
    /// Print one snapshot as JSON and end
    #[arg(long)]
    pub json: bool,
}

/// `fccd check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Configuration files
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print the result as JSON; of several files, as a list
    #[arg(long)]
    pub json: bool,
}

/// `fccd check-controls`.
#[derive(Args, Debug)]
pub struct CheckControlsArgs {
    /// Configuration file
    #[arg(value_name = "CONFIG")]
    pub config: PathBuf,
    /// Move the throttle, too, to full: take the propeller off first
    #[arg(long)]
    pub throttle: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd probe`.
#[derive(Args, Debug)]
pub struct ProbeArgs {
    /// Root folder of the files to read
    #[arg(long, value_name = "DIR", default_value = "/")]
    pub root: PathBuf,
    /// Set up and read the chips as well, and show what they measure: not while
    /// another program reads them
    #[arg(long)]
    pub live: bool,
    /// Ask each SPI device which chip it is
    #[arg(long)]
    pub spi: bool,
    /// Print what was found as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd doctor`.
#[derive(Args, Debug)]
pub struct DoctorArgs {
    /// Configuration of the loop [default: that of `fccd fly`]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Root folder of the files to read: the disk of another machine, with its
    /// /proc and /sys copied
    #[arg(long, value_name = "DIR", default_value = "/")]
    pub root: PathBuf,
    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd report`.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// The recording
    pub file: PathBuf,
    /// Write a page with all tables and plots in one file
    #[arg(long, value_name = "OUT.html", value_parser = output())]
    pub html: Option<PathBuf>,
    /// Also write each plot as an SVG file, for papers
    #[arg(long, value_name = "DIR", value_parser = output())]
    pub svg: Option<PathBuf>,
    /// Write every tick and event into records.csv and events.csv
    #[arg(long, value_name = "DIR", value_parser = output())]
    pub csv: Option<PathBuf>,
    /// Print all statistics as JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_thesis_experiment_is_the_default() {
        let cli = Cli::parse_from(["fccd", "timing"]);
        let Action::Timing(args) = cli.command else {
            panic!("not timing");
        };
        assert_eq!(args.rates, [40.0, 50.0, 100.0]);
    }
}

//! What people type.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use fcc_telemetry::Instance;
use fcc_timer::TimerKind;

use crate::config::GustsChoice;
use crate::exit::EXIT_CODES;

/// A real-time flight control computer in software.
#[derive(Parser, Debug)]
#[command(name = "fccd", version, about, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What `fccd` can do.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Fly the built-in aircraft through the timed pattern
    Fly(FlyArgs),
    /// Fly the aircraft of a configuration file until told to stop
    Run(RunArgs),
    /// Measure how well the loop keeps time: the experiment of the thesis
    Timing(TimingArgs),
    /// Watch a flight on this machine, live
    #[cfg(feature = "live")]
    Top(TopArgs),
    /// Check a configuration file
    Check(CheckArgs),
    /// Give X-Plane's controls back if the daemon is killed; started by the
    /// daemon itself
    #[command(hide = true)]
    Guard,
    /// Print a completion script for a shell
    Completions {
        /// Which shell
        shell: Shell,
    },
}

/// `fccd fly`.
#[derive(Args, Debug)]
pub struct FlyArgs {
    /// Configuration file with a [built-in] section; without it, all is as in
    /// config/built-in.toml
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// How long to fly after engaging [default: the hold and 8 legs]
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    pub seconds: Option<f64>,
    /// Seed of gusts and sensor noise
    #[arg(long)]
    pub seed: Option<u64>,
    /// Strength of the gusts
    #[arg(long, value_enum)]
    pub gusts: Option<GustsChoice>,
    /// What watchers call this flight, instead of what the configuration says
    #[arg(long, value_name = "NAME")]
    pub instance: Option<Instance>,
    /// As fast as the machine can, instead of in real time
    #[arg(long)]
    pub lockstep: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// No status lines
    #[arg(long, short)]
    pub quiet: bool,
}

/// `fccd run`.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// Configuration file
    #[arg(long, value_name = "FILE")]
    pub config: PathBuf,
    /// What watchers call this daemon, instead of what the configuration says
    #[arg(long, value_name = "NAME")]
    pub instance: Option<Instance>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// No status lines
    #[arg(long, short)]
    pub quiet: bool,
}

/// `fccd timing`.
#[derive(Args, Debug)]
pub struct TimingArgs {
    /// Ticks a second; may be given several times
    #[arg(long = "rate", value_name = "HZ", default_values_t = [40.0, 50.0, 100.0],
          value_parser = rate_hz)]
    pub rates: Vec<f64>,
    /// How long to measure at each rate
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive_seconds)]
    pub seconds: f64,
    /// Which timer wakes the loop: timerfd, posix or nanosleep
    #[arg(long, value_name = "TIMER", default_value_t = TimerKind::Timerfd)]
    pub timer: TimerKind,
    /// `SCHED_FIFO` priority of the loop's thread, 0 for the ordinary scheduler
    #[arg(long, default_value_t = 80, value_parser = clap::value_parser!(u8).range(0..=99))]
    pub priority: u8,
    /// The CPU that the loop's thread is bound to
    #[arg(long)]
    pub cpu: Option<usize>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd top`.
#[cfg(feature = "live")]
#[derive(Args, Debug)]
pub struct TopArgs {
    /// Which daemon: the name that it was given by --instance, or in its configuration
    #[arg(long, value_name = "NAME", default_value_t = Instance::default())]
    pub instance: Instance,
    /// Print one snapshot as JSON and end
    #[arg(long)]
    pub json: bool,
}

/// `fccd check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Configuration file
    pub file: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

fn positive_seconds(text: &str) -> Result<f64, String> {
    number_within(text, 0.1, 1e6, "seconds")
}

fn rate_hz(text: &str) -> Result<f64, String> {
    number_within(text, 1.0, 2_000.0, "Hz")
}

fn number_within(text: &str, least: f64, most: f64, unit: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|number| (least..=most).contains(number))
        .ok_or_else(|| format!("give {least} to {most} {unit}"))
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
        let Command::Timing(args) = cli.command else {
            panic!("not timing");
        };
        assert_eq!(args.rates, [40.0, 50.0, 100.0]);
    }
}

//! The command line of `fccd x-plane`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::values::output;

/// `fccd x-plane`.
#[derive(Args, Debug)]
pub struct XPlaneArgs {
    /// The command
    #[command(subcommand)]
    pub what: XPlaneCommand,
}

/// The commands of `fccd x-plane`.
#[derive(Subcommand, Debug)]
pub enum XPlaneCommand {
    /// Check fccd against a running X-Plane, step by step, and write a report
    Check(XPlaneCheckArgs),
    /// List the steps of the check and their limits
    Steps {
        /// Print the list as JSON
        #[arg(long)]
        json: bool,
    },
    /// Measure how X-Plane's aircraft responds to its controls, in level flight
    /// in calm air, and print gains for it: a first guess
    Identify(IdentifyArgs),
}

/// Where X-Plane is.
#[derive(Args, Debug)]
pub struct ConnectionArgs {
    /// Configuration file with an [x-plane] section [default: X-Plane on this
    /// machine]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// UDP port to receive on, if a firewall has to know it [default: any that
    /// is free]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    pub local_port: u16,
}

/// `fccd x-plane check`.
#[derive(Args, Debug)]
pub struct XPlaneCheckArgs {
    /// Where X-Plane is
    #[command(flatten)]
    pub connection: ConnectionArgs,
    /// Ask nobody: a stand-in for X-Plane does what a person would
    #[arg(long)]
    pub yes: bool,
    /// Only these steps, as in 1,2,12
    #[arg(long, value_name = "N,N", value_delimiter = ',',
          value_parser = clap::value_parser!(u8).range(1..=20))]
    pub only: Vec<u8>,
    /// Shortened waits, for a quick look: the report says so
    #[arg(long)]
    pub quick: bool,
    /// The report, in Markdown, with the same as JSON beside it; both replace earlier ones
    #[arg(long, value_name = "FILE", default_value = "x-plane-check.md",
          value_parser = output())]
    pub report: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd x-plane identify`.
#[derive(Args, Debug)]
pub struct IdentifyArgs {
    /// Where X-Plane is
    #[command(flatten)]
    pub connection: ConnectionArgs,
    /// A person flies between the deflections, and not fccd: for an aircraft
    /// that its gains do not hold steady
    #[arg(long)]
    pub by_hand: bool,
    /// Folder for the recordings of its flights
    #[arg(long, value_name = "DIR", default_value = "x-plane-identify.files",
          value_parser = output())]
    pub files: PathBuf,
    /// Print the responses as JSON
    #[arg(long)]
    pub json: bool,
}

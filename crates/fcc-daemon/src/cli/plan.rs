//! `fccd plan` and `fccd command plan`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::values::{number, output};

/// `fccd plan`.
#[derive(Args, Debug)]
pub struct PlanArgs {
    /// What to do
    #[command(subcommand)]
    pub what: PlanAction,
}

/// The commands of `fccd plan`.
#[derive(Subcommand, Debug)]
pub enum PlanAction {
    /// Check whether the aircraft can fly plans
    Check(PlanCheckArgs),
    /// Show a plan as a table, and as a page with its map and height profile
    Show(PlanShowArgs),
    /// Write a plan in the other format
    Convert(PlanConvertArgs),
}

/// `fccd plan check`.
#[derive(Args, Debug)]
pub struct PlanCheckArgs {
    /// Plans, of QGroundControl or QGC WPL 110
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Configuration of the aircraft, and of what a plan is checked for [default: the
    /// Cessna 172 in 20 kt]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd plan show`.
#[derive(Args, Debug)]
pub struct PlanShowArgs {
    /// The plan, of QGroundControl or QGC WPL 110
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Configuration, by whose tiles the height profile shows the ground
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Write a page with map and height profile
    #[arg(long, value_name = "OUT.html", value_parser = output())]
    pub html: Option<PathBuf>,
    /// Print the plan as JSON
    #[arg(long)]
    pub json: bool,
}

/// `fccd plan convert`.
#[derive(Args, Debug)]
pub struct PlanConvertArgs {
    /// The plan, of QGroundControl or QGC WPL 110
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Where to write it: .plan, or .waypoints, .wpl or .txt
    #[arg(value_name = "OUT", value_parser = output())]
    pub out: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Commands to a flight with a plan.
#[derive(Subcommand, Debug)]
pub enum PlanOrder {
    /// Circle where the aircraft is
    Pause,
    /// Fly the plan from where it was left
    Resume,
    /// Fly the plan from an item on
    Item {
        /// Its number, from 1
        #[arg(value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1_000))]
        number: u16,
    },
    /// Fly another plan, from its first item or another one; refused low over a runway and
    /// in a landing
    Replace {
        /// The plan, of QGroundControl or QGC WPL 110; the daemon reads it
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// The item that is flown first
        #[arg(long, value_name = "N", default_value_t = 1,
              value_parser = clap::value_parser!(u16).range(1..=1_000))]
        item: u16,
    },
    /// Fly to a place, and circle around it
    GoTo {
        /// Latitude, -90 to 90
        #[arg(value_name = "LAT", value_parser = number, allow_negative_numbers = true)]
        latitude_deg: f64,
        /// Longitude, -180 to 180
        #[arg(value_name = "LON", value_parser = number, allow_negative_numbers = true)]
        longitude_deg: f64,
        /// Altitude above sea level by the altimeter setting
        #[arg(value_name = "ALT_FT", value_parser = number, allow_negative_numbers = true)]
        altitude_ft: f64,
    },
    /// Fly to the nearest of home and the rally points, and circle there
    Return,
    /// Land: at the nearest landing of the plan, or without one where the aircraft took off
    Land,
    /// Give the landing up: climb, and land again
    GoAround,
}

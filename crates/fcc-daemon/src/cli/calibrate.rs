//! `fccd calibrate`.

use std::path::PathBuf;

use clap::Args;
use fcc_flight::calibrate::{CalibrationKind, HandlingFault};

use super::values::{calibration_kind, handling_fault, positive_seconds};

/// `fccd calibrate`.
#[derive(Args, Debug)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
pub struct CalibrateArgs {
    /// What to calibrate
    #[arg(value_name = "KIND", value_parser = calibration_kind())]
    pub kind: CalibrationKind,
    /// Configuration file
    #[arg(value_name = "CONFIG")]
    pub config: PathBuf,
    /// The sensor, by its section in the configuration [default: the first
    /// that gives such readings]
    #[arg(long, value_name = "SECTION")]
    pub sensor: Option<String>,
    /// Of a mounting: only level the aircraft, and keep where the sensors point
    #[arg(long)]
    pub level_only: bool,
    /// Of a gyroscope: only its bias, of an aircraft that cannot be turned; scale
    /// and misalignment stay as they are
    #[arg(long)]
    pub bias_only: bool,
    /// Change nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Give up after this time
    #[arg(long, value_name = "S", default_value_t = 600.0, value_parser = positive_seconds,
          allow_negative_numbers = true)]
    pub seconds: f64,
    /// Of the built-in aircraft, which a simulated person handles: what that
    /// person does wrong
    #[arg(long, value_name = "FAULT", value_parser = handling_fault())]
    pub fault: Option<HandlingFault>,
    /// Of the built-in aircraft: as fast as the machine can
    #[arg(long)]
    pub lockstep: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

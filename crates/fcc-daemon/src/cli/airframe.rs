//! `fccd airframe`.

use clap::{ArgGroup, Args};

use super::values::number_within;

/// What was measured of an aircraft.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("stall").required(true).multiple(true).args(["stall_kt", "mass_kg"]))]
pub struct AirframeArgs {
    /// Span of the wing
    #[arg(long, value_name = "M", value_parser = span_m, allow_negative_numbers = true)]
    pub span_m: f64,
    /// Stalling speed at the greatest weight, without flaps [default: from mass and wing area]
    #[arg(long, value_name = "KT", value_parser = speed_kt, allow_negative_numbers = true)]
    pub stall_kt: Option<f64>,
    /// Greatest mass, where the stalling speed is not known
    #[arg(long, value_name = "KG", requires = "wing_area_m2", value_parser = mass_kg,
          allow_negative_numbers = true)]
    pub mass_kg: Option<f64>,
    /// Area of the wing
    #[arg(long, value_name = "M2", value_parser = area_m2, allow_negative_numbers = true)]
    pub wing_area_m2: Option<f64>,
    /// Cruising speed [default: twice the stalling speed]
    #[arg(long, value_name = "KT", value_parser = speed_kt, allow_negative_numbers = true)]
    pub cruise_kt: Option<f64>,
    /// Never-exceed speed [default: 1.8 times the cruising speed]
    #[arg(long, value_name = "KT", value_parser = speed_kt, allow_negative_numbers = true)]
    pub never_exceed_kt: Option<f64>,
    /// From the wing to the elevator [default: half the span]
    #[arg(long, value_name = "M", value_parser = span_m, allow_negative_numbers = true)]
    pub tail_arm_m: Option<f64>,
    /// Static thrust over weight
    #[arg(long, default_value_t = 0.57, value_parser = thrust, allow_negative_numbers = true)]
    pub thrust_over_weight: f64,
    /// Throttle in level cruise
    #[arg(long, default_value_t = 0.5, value_parser = throttle, allow_negative_numbers = true)]
    pub cruise_throttle: f64,
    /// Glide ratio at idle
    #[arg(long, default_value_t = 8.0, value_parser = glide, allow_negative_numbers = true)]
    pub glide_ratio: f64,
    /// Load that the structure bears
    #[arg(long, value_name = "G", default_value_t = 3.8, value_parser = load_g,
          allow_negative_numbers = true)]
    pub load_limit_g: f64,
    /// Print the keys as JSON
    #[arg(long)]
    pub json: bool,
}

fn span_m(text: &str) -> Result<f64, String> {
    number_within(text, 0.2, 100.0, "m")
}

fn speed_kt(text: &str) -> Result<f64, String> {
    number_within(text, 5.0, 1_000.0, "kt")
}

fn mass_kg(text: &str) -> Result<f64, String> {
    number_within(text, 0.1, 500_000.0, "kg")
}

fn area_m2(text: &str) -> Result<f64, String> {
    number_within(text, 0.02, 1_000.0, "m²")
}

fn thrust(text: &str) -> Result<f64, String> {
    number_within(text, 0.1, 2.0, "times the weight")
}

fn throttle(text: &str) -> Result<f64, String> {
    number_within(text, 0.05, 0.95, "of full throttle")
}

fn glide(text: &str) -> Result<f64, String> {
    number_within(text, 2.0, 60.0, "to 1")
}

fn load_g(text: &str) -> Result<f64, String> {
    number_within(text, 2.0, 15.0, "g")
}

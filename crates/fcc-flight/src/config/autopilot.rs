//! `[autopilot]`: gains and limits.

use std::time::Duration;

use fcc_core::flight::control::{AirspeedConfig, AltitudeConfig, Envelope, HeadingConfig};
use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::flight::navigation::NavigationConfig;
use fcc_core::flight::{AutopilotConfig, Scale};
use serde::{Deserialize, Serialize};

use super::GuidanceSection;
use super::units::{FOOT_PER_MINUTE_MPS, KNOT_MPS};

/// `[autopilot]`: gains and limits. What is left out is as for a Cessna 172.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct AutopilotSection {
    /// The airspeed at which the gains hold as they are.
    pub reference_airspeed_kt: f64,
    /// How the aircraft differs from the one that the gains were found on.
    pub scale: ScaleSection,
    /// What the loops may ask of the aircraft.
    pub envelope: EnvelopeSection,
    /// How sensors are blended.
    pub navigation: NavigationSection,
    /// Heading, bank, aileron, rudder.
    pub heading: HeadingSection,
    /// Altitude, climb rate, pitch, elevator.
    pub altitude: AltitudeSection,
    /// Airspeed, throttle.
    pub airspeed: AirspeedSection,
}

impl Default for AutopilotSection {
    fn default() -> Self {
        let core = AutopilotConfig::default();
        Self {
            reference_airspeed_kt: rounded(core.reference_airspeed_mps / KNOT_MPS),
            scale: ScaleSection::default(),
            envelope: EnvelopeSection::from(&core.envelope),
            navigation: NavigationSection::from(&core.navigation),
            heading: HeadingSection::from(&core.heading),
            altitude: AltitudeSection::from(&core.altitude),
            airspeed: AirspeedSection::from(&core.airspeed),
        }
    }
}

impl AutopilotSection {
    /// The core's configuration: this section, the guidance, and how old a reading
    /// may become.
    pub fn to_core(
        &self,
        guidance: &GuidanceSection,
        max_age: Duration,
        frozen_after: Duration,
    ) -> AutopilotConfig {
        AutopilotConfig {
            reference_airspeed_mps: self.reference_airspeed_kt * KNOT_MPS,
            max_age,
            frozen_after,
            navigation: NavigationConfig::from(&self.navigation),
            guidance: GuidanceConfig::from(guidance),
            heading: HeadingConfig::from(&self.heading),
            altitude: AltitudeConfig::from(&self.altitude),
            airspeed: AirspeedConfig::from(&self.airspeed),
            envelope: Envelope::from(&self.envelope),
            ..AutopilotConfig::default()
        }
        .scaled(&Scale::from(&self.scale))
    }
}

/// To five digits: the core's defaults are meant in the file's units, and a
/// conversion there and back must not show.
fn rounded(value: f64) -> f64 {
    if value == 0.0 {
        return value;
    }
    let digits = 4 - value.abs().log10().floor() as i32;
    let scale = 10_f64.powi(digits.abs());
    if digits >= 0 {
        (value * scale).round() / scale
    } else {
        (value / scale).round() * scale
    }
}

/// Declares a section of the file beside the core's struct: each field with
/// its unit in the file and the factor that leads to the core's.
macro_rules! section {
    (
        $(#[$meta:meta])*
        $section:ident for $core:ident {
            $( $(#[$doc:meta])* $file_field:ident => $core_field:ident * $factor:expr ),* $(,)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Deserialize, Serialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $section {
            $( $(#[$doc])* pub $file_field: f64, )*
        }

        impl From<&$core> for $section {
            fn from(core: &$core) -> Self {
                Self { $( $file_field: rounded(core.$core_field / $factor), )* }
            }
        }

        impl From<&$section> for $core {
            fn from(section: &$section) -> Self {
                Self { $( $core_field: section.$file_field * $factor, )* }
            }
        }

        impl Default for $section {
            fn default() -> Self {
                Self::from(&$core::default())
            }
        }
    };
}

/// One degree in rad.
const DEGREE_RAD: f64 = std::f64::consts::PI / 180.0;
/// Standard gravity, m/s².
const G_MPS2: f64 = 9.806_65;
/// The core's unit.
const SI: f64 = 1.0;

section! {
    /// `[autopilot.scale]`: factors on the gains below.
    ScaleSection for Scale {
        /// More where the elevator does less.
        elevator => elevator * SI,
        /// More where the aileron does less.
        aileron => aileron * SI,
        /// More where the rudder does less.
        rudder => rudder * SI,
        /// More where the engine does less for the aircraft's weight.
        throttle => throttle * SI,
        /// Less than 1 for an aircraft that answers slowly.
        pace => pace * SI,
    }
}

section! {
    /// `[autopilot.envelope]`.
    EnvelopeSection for Envelope {
        /// Largest bank.
        max_bank_deg => max_bank_rad * DEGREE_RAD,
        /// Largest load factor.
        max_load_factor_g => max_load_factor * SI,
        /// Largest pitch.
        max_pitch_deg => max_pitch_rad * DEGREE_RAD,
        /// Smallest pitch, negative.
        min_pitch_deg => min_pitch_rad * DEGREE_RAD,
        /// Slowest indicated airspeed: below, altitude is traded for speed.
        min_airspeed_kt => min_airspeed_mps * KNOT_MPS,
        /// Fastest indicated airspeed.
        max_airspeed_kt => max_airspeed_mps * KNOT_MPS,
        /// Fastest climb.
        max_climb_fpm => max_climb_mps * FOOT_PER_MINUTE_MPS,
        /// Fastest descent.
        max_sink_fpm => max_sink_mps * FOOT_PER_MINUTE_MPS,
        /// Within this of an airspeed limit the climb limits close in.
        airspeed_margin_kt => airspeed_margin_mps * KNOT_MPS,
    }
}

section! {
    /// `[autopilot.navigation]`.
    NavigationSection for NavigationConfig {
        /// Gyroscopes against measured pitch and roll.
        attitude_tau_s => attitude_tau_s * SI,
        /// Gyroscopes against the compass.
        heading_tau_s => heading_tau_s * SI,
        /// Accelerometers against the barometer.
        vertical_bandwidth_radps => vertical_bandwidth_radps * SI,
        /// Accelerometers against the airspeed sensor.
        airspeed_tau_s => airspeed_tau_s * SI,
        /// Low pass on the side force.
        side_force_tau_s => side_force_tau_s * SI,
    }
}

section! {
    /// `[autopilot.heading]`; surfaces are -1..1, rates in rad/s.
    HeadingSection for HeadingConfig {
        /// Turn rate per heading error.
        heading_gain_per_s => heading_gain_per_s * SI,
        /// Roll rate to plan the roll-out with.
        rollout_rate_degps => rollout_rate_radps * DEGREE_RAD,
        /// How far ahead the heading is looked at.
        lead_s => lead_s * SI,
        /// Roll rate per bank error.
        roll_gain_per_s => roll_gain_per_s * SI,
        /// Largest roll rate asked for.
        max_roll_rate_degps => max_roll_rate_radps * DEGREE_RAD,
        /// Fastest change of the roll rate asked for.
        max_roll_acceleration_degps2 => max_roll_acceleration_radps2 * DEGREE_RAD,
        /// Aileron that keeps up a roll rate.
        aileron_per_roll_rate => aileron_per_roll_rate * SI,
        /// Aileron per roll-rate error.
        roll_rate_gain => roll_rate_gain * SI,
        /// Aileron per integrated roll-rate error.
        roll_rate_integral_gain => roll_rate_integral_gain * SI,
        /// Rudder that goes with the aileron.
        rudder_per_aileron => rudder_per_aileron * SI,
        /// Rudder per g of side force.
        rudder_per_side_g => side_force_gain * (1.0 / G_MPS2),
        /// Rudder per g of side force and second.
        rudder_per_side_g_s => side_force_integral_gain * (1.0 / G_MPS2),
        /// Rudder per yaw rate in excess of the turn's.
        yaw_damping => yaw_damping * SI,
    }
}

section! {
    /// `[autopilot.altitude]`; surfaces are -1..1, rates in rad/s.
    AltitudeSection for AltitudeConfig {
        /// Climb rate per altitude error.
        altitude_gain_per_s => altitude_gain_per_s * SI,
        /// Vertical deceleration to plan the capture with.
        capture_g => capture_mps2 * G_MPS2,
        /// Fastest change of the climb rate asked for.
        climb_acceleration_g => climb_acceleration_mps2 * G_MPS2,
        /// Path angle per climb-rate error over airspeed.
        climb_rate_gain => climb_rate_gain * SI,
        /// The same, integrated.
        climb_rate_integral_gain_per_s => climb_rate_integral_gain_per_s * SI,
        /// How far the flight path lags behind the one asked for.
        flight_path_lag_s => flight_path_lag_s * SI,
        /// Angle of attack that carries 1 g at the reference airspeed.
        angle_of_attack_per_g_deg => angle_of_attack_per_g_rad * DEGREE_RAD,
        /// Pitch rate per pitch error.
        pitch_gain_per_s => pitch_gain_per_s * SI,
        /// Largest pitch rate asked for besides the turn's own.
        max_pitch_rate_degps => max_pitch_rate_radps * DEGREE_RAD,
        /// Elevator per pitch-rate error.
        pitch_rate_gain => pitch_rate_gain * SI,
        /// Elevator per integrated pitch-rate error.
        pitch_rate_integral_gain => pitch_rate_integral_gain * SI,
        /// Elevator that goes with the turn's load.
        elevator_per_g => elevator_per_g * SI,
    }
}

section! {
    /// `[autopilot.airspeed]`; throttle is 0..1.
    AirspeedSection for AirspeedConfig {
        /// Acceleration per airspeed error.
        airspeed_gain_per_s => airspeed_gain_per_s * SI,
        /// The same, integrated.
        airspeed_integral_gain_per_s2 => airspeed_integral_gain_per_s2 * SI,
        /// Throttle that accelerates the aircraft by 1 g.
        throttle_per_g => throttle_per_mps2 * (1.0 / G_MPS2),
        /// Drag of lift over weight at 1 g.
        induced_drag_ratio => induced_drag_ratio * SI,
        /// Fastest throttle.
        max_throttle_rate_per_s => max_throttle_rate_per_s * SI,
        /// Throttle for level flight at the reference airspeed.
        trim_throttle => trim_throttle * SI,
    }
}

//! `[autopilot]`: gains and limits.

use std::time::Duration;

use fcc_core::units::{FOOT_M, FOOT_PER_MINUTE_MPS, GRAVITY_MPS2, KNOT_MPS};
use fcc_fixed_wing::control::{AirspeedConfig, AltitudeConfig, Envelope, HeadingConfig};
use fcc_fixed_wing::{AutopilotConfig, Scale};
use fcc_guidance::GuidanceConfig;
use fcc_guidance::route::RunwayConfig;
use fcc_navigation::NavigationConfig;
use serde::{Deserialize, Serialize};

use super::{AirframeSection, GuidanceSection};

/// `[autopilot]`: gains and limits. Omitted keys have the values for a Cessna
/// 172.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct AutopilotSection {
    /// The reference airspeed of the gains.
    pub reference_airspeed_kt: f64,
    /// The latency from an output to its effect that is assumed until it has
    /// been measured.
    pub assumed_latency_ms: f64,
    /// Whether the elevator's trim takes over what the elevator holds.
    pub trim: bool,
    /// How the aircraft differs from the one for which the gains were tuned.
    pub scale: ScaleSection,
    /// The limits of the loops' commands.
    pub envelope: EnvelopeSection,
    /// What was learned of the aircraft, for flights without an airspeed sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub airframe: Option<AirframeSection>,
    /// How sensors are combined.
    pub navigation: NavigationSection,
    /// Heading, bank, aileron, rudder.
    pub heading: HeadingSection,
    /// Altitude, climb rate, pitch, elevator.
    pub altitude: AltitudeSection,
    /// Airspeed, throttle.
    pub airspeed: AirspeedSection,
    /// Take-off and landing.
    pub runway: RunwaySection,
}

impl Default for AutopilotSection {
    fn default() -> Self {
        let core = AutopilotConfig::default();
        Self {
            reference_airspeed_kt: rounded(core.reference_airspeed_mps / KNOT_MPS),
            assumed_latency_ms: rounded(core.assumed_latency_s * 1e3),
            trim: core.trims,
            scale: ScaleSection::default(),
            envelope: EnvelopeSection::from(&core.envelope),
            airframe: None,
            navigation: NavigationSection::from(&core.navigation),
            heading: HeadingSection::from(&core.heading),
            altitude: AltitudeSection::from(&core.altitude),
            airspeed: AirspeedSection::from(&core.airspeed),
            runway: RunwaySection::from(&core.route.runway),
        }
    }
}

impl AutopilotSection {
    /// The core's configuration: this section, the guidance, and the maximum
    /// age of readings.
    pub fn to_core(
        &self,
        guidance: &GuidanceSection,
        max_age: Duration,
        frozen_after: Duration,
    ) -> AutopilotConfig {
        AutopilotConfig {
            reference_airspeed_mps: self.reference_airspeed_kt * KNOT_MPS,
            assumed_latency_s: self.assumed_latency_ms * 1e-3,
            trims: self.trim,
            airframe: self.airframe.map(Into::into),
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

/// To five digits: the core's defaults are defined in the file's units, and
/// conversion must not change their digits.
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

/// Declares a section of the file for a struct of the core: each field with its
/// unit in the file, its smallest and largest value and the conversion factor to the core's
/// unit.
macro_rules! section {
    (
        $(#[$meta:meta])*
        $section:ident for $core:ident in $key:literal {
            $(
                $(#[$doc:meta])*
                $file_field:ident ($least:literal to $most:literal) =>
                    $core_field:ident * $factor:expr
            ),* $(,)?
            $(; $( $(#[$flag_doc:meta])* $flag:ident ),* $(,)? )?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Deserialize, Serialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $section {
            $( $(#[$doc])* pub $file_field: f64, )*
            $( $( $(#[$flag_doc])* pub $flag: bool, )* )?
        }

        impl $section {
            const RANGES: &'static [(&'static str, f64, f64)] =
                &[ $( (concat!($key, ".", stringify!($file_field)), $least, $most) ),* ];
        }

        impl From<&$core> for $section {
            fn from(core: &$core) -> Self {
                Self {
                    $( $file_field: rounded(core.$core_field / $factor), )*
                    $( $( $flag: core.$flag, )* )?
                }
            }
        }

        impl From<&$section> for $core {
            fn from(section: &$section) -> Self {
                Self {
                    $( $core_field: section.$file_field * $factor, )*
                    $( $( $flag: section.$flag, )* )?
                }
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
/// The core's unit.
const SI: f64 = 1.0;

section! {
    /// `[autopilot.scale]`: factors on the gains below.
    ScaleSection for Scale in "autopilot.scale" {
        /// Larger where the elevator is less effective.
        elevator (0.01 to 100.0) => elevator * SI,
        /// Larger where the aileron is less effective.
        aileron (0.01 to 100.0) => aileron * SI,
        /// Larger where the rudder is less effective.
        rudder (0.0 to 100.0) => rudder * SI,
        /// Larger where the engine has less power for the aircraft's weight.
        throttle (0.01 to 100.0) => throttle * SI,
        /// Less than 1 for an aircraft that responds slowly.
        pace (0.05 to 5.0) => pace * SI,
    }
}

section! {
    /// `[autopilot.envelope]`.
    EnvelopeSection for Envelope in "autopilot.envelope" {
        /// Largest bank.
        max_bank_deg (5.0 to 60.0) => max_bank_rad * DEGREE_RAD,
        /// Largest load factor.
        max_load_factor_g (1.0 to 6.0) => max_load_factor * SI,
        /// Largest pitch.
        max_pitch_deg (2.0 to 45.0) => max_pitch_rad * DEGREE_RAD,
        /// Smallest pitch, negative.
        min_pitch_deg (-45.0 to -2.0) => min_pitch_rad * DEGREE_RAD,
        /// Lowest indicated airspeed: below it, the aircraft descends to gain
        /// speed.
        min_airspeed_kt (5.0 to 400.0) => min_airspeed_mps * KNOT_MPS,
        /// Highest indicated airspeed.
        max_airspeed_kt (10.0 to 600.0) => max_airspeed_mps * KNOT_MPS,
        /// Largest climb rate.
        max_climb_fpm (10.0 to 10_000.0) => max_climb_mps * FOOT_PER_MINUTE_MPS,
        /// Largest descent rate.
        max_sink_fpm (10.0 to 10_000.0) => max_sink_mps * FOOT_PER_MINUTE_MPS,
        /// Commanded airspeeds keep this margin from both limits.
        airspeed_margin_kt (0.5 to 100.0) => airspeed_margin_mps * KNOT_MPS,
        /// The floor: nothing that is flown leads below this altitude above mean
        /// sea level, by the altimeter setting; -1500 for none.
        floor_ft (-1_500.0 to 60_000.0) => floor_m * FOOT_M,
        /// Altitudes that are flown to keep this margin above the floor.
        floor_margin_ft (0.0 to 1_000.0) => floor_margin_m * FOOT_M,
        /// Stalling speed, clean, without power, at the heaviest weight flown.
        stall_airspeed_kt (5.0 to 300.0) => stall_airspeed_mps * KNOT_MPS,
        /// Airspeed of the longest glide.
        best_glide_airspeed_kt (5.0 to 400.0) => best_glide_airspeed_mps * KNOT_MPS,
        /// Manoeuvring speed, Va.
        maneuvering_airspeed_kt (10.0 to 600.0) => maneuvering_airspeed_mps * KNOT_MPS,
        /// Never-exceed speed, Vne.
        never_exceed_airspeed_kt (10.0 to 700.0) => never_exceed_airspeed_mps * KNOT_MPS,
        /// Limit load factor of the structure.
        limit_load_factor_g (1.5 to 12.0) => limit_load_factor * SI,
        /// The same, negative.
        limit_negative_load_factor_g (-10.0 to 0.0) => limit_negative_load_factor * SI,
        /// Largest angle of attack, below that of the stall.
        max_angle_of_attack_deg (3.0 to 45.0) => max_angle_of_attack_rad * DEGREE_RAD,
    }
}

section! {
    /// `[autopilot.navigation]`.
    NavigationSection for NavigationConfig in "autopilot.navigation" {
        /// Gyroscopes against measured pitch and roll.
        attitude_tau_s (0.01 to 100.0) => attitude_tau_s * SI,
        /// Gyroscopes against the compass.
        heading_tau_s (0.01 to 100.0) => heading_tau_s * SI,
        /// Accelerometers against the barometer.
        vertical_bandwidth_radps (0.01 to 10.0) => vertical_bandwidth_radps * SI,
        /// Accelerometers against the airspeed sensor.
        airspeed_tau_s (0.01 to 100.0) => airspeed_tau_s * SI,
        /// Low pass on the side force.
        side_force_tau_s (0.0 to 10.0) => side_force_tau_s * SI,
    }
}

section! {
    /// `[autopilot.heading]`; surfaces are -1..1, rates in rad/s.
    HeadingSection for HeadingConfig in "autopilot.heading" {
        /// Turn rate per heading error.
        heading_gain_per_s (0.01 to 10.0) => heading_gain_per_s * SI,
        /// Planned roll rate of the roll-out.
        rollout_rate_degps (0.5 to 180.0) => rollout_rate_radps * DEGREE_RAD,
        /// Prediction time of the heading.
        lead_s (0.0 to 5.0) => lead_s * SI,
        /// Roll rate per bank error.
        roll_gain_per_s (0.1 to 20.0) => roll_gain_per_s * SI,
        /// Largest commanded roll rate.
        max_roll_rate_degps (1.0 to 360.0) => max_roll_rate_radps * DEGREE_RAD,
        /// Largest rate of change of the commanded roll rate.
        max_roll_acceleration_degps2 (1.0 to 3_600.0) => max_roll_acceleration_radps2 * DEGREE_RAD,
        /// Aileron for a steady roll rate.
        aileron_per_roll_rate (0.0 to 10.0) => aileron_per_roll_rate * SI,
        /// Aileron per roll-rate error.
        roll_rate_gain (0.0 to 10.0) => roll_rate_gain * SI,
        /// Aileron per integrated roll-rate error.
        roll_rate_integral_gain (0.0 to 50.0) => roll_rate_integral_gain * SI,
        /// Rudder per aileron.
        rudder_per_aileron (-2.0 to 2.0) => rudder_per_aileron * SI,
        /// Time constant of its washout.
        rudder_washout_s (0.1 to 60.0) => rudder_washout_s * SI,
        /// Rudder per g of side force.
        rudder_per_side_g (0.0 to 100.0) => side_force_gain * (1.0 / GRAVITY_MPS2),
        /// Rudder per g of side force and second.
        rudder_per_side_g_s (0.0 to 100.0) => side_force_integral_gain * (1.0 / GRAVITY_MPS2),
        /// Rudder per yaw rate in excess of the turn's.
        yaw_damping (0.0 to 20.0) => yaw_damping * SI,
    }
}

section! {
    /// `[autopilot.altitude]`; surfaces are -1..1, rates in rad/s.
    AltitudeSection for AltitudeConfig in "autopilot.altitude" {
        /// Climb rate per altitude error.
        altitude_gain_per_s (0.01 to 5.0) => altitude_gain_per_s * SI,
        /// Planned vertical deceleration of the altitude capture.
        capture_g (0.002 to 1.0) => capture_mps2 * GRAVITY_MPS2,
        /// Largest rate of change of the commanded climb rate.
        climb_acceleration_g (0.002 to 1.0) => climb_acceleration_mps2 * GRAVITY_MPS2,
        /// Path angle per climb-rate error over airspeed.
        climb_rate_gain (0.0 to 20.0) => climb_rate_gain * SI,
        /// The same, integrated.
        climb_rate_integral_gain_per_s (0.0 to 20.0) => climb_rate_integral_gain_per_s * SI,
        /// Lag of the flight path behind the commanded one.
        flight_path_lag_s (0.0 to 10.0) => flight_path_lag_s * SI,
        /// Angle of attack for 1 g at the reference airspeed.
        angle_of_attack_per_g_deg (0.0 to 20.0) => angle_of_attack_per_g_rad * DEGREE_RAD,
        /// Pitch rate per pitch error.
        pitch_gain_per_s (0.1 to 20.0) => pitch_gain_per_s * SI,
        /// Largest commanded pitch rate in addition to that of the turn.
        max_pitch_rate_degps (0.5 to 90.0) => max_pitch_rate_radps * DEGREE_RAD,
        /// Elevator per pitch-rate error.
        pitch_rate_gain (0.0 to 20.0) => pitch_rate_gain * SI,
        /// Elevator per integrated pitch-rate error.
        pitch_rate_integral_gain (0.0 to 100.0) => pitch_rate_integral_gain * SI,
        /// Elevator for the load of a turn.
        elevator_per_g (0.0 to 10.0) => elevator_per_g * SI,
    }
}

section! {
    /// `[autopilot.runway]`: speeds and limits of take-off and landing.
    RunwaySection for RunwayConfig in "autopilot.runway" {
        /// Indicated airspeed at which the nose is raised.
        rotate_kt (5.0 to 300.0) => rotate_mps * KNOT_MPS,
        /// A take-off from the hand begins with this acceleration along the aircraft; 0: it
        /// takes off on its wheels.
        launch_g (0.0 to 10.0) => launch_mps2 * GRAVITY_MPS2,
        /// A take-off that has not reached it within this way, or its time, brakes.
        longest_roll_m (1.0 to 5000.0) => longest_roll_m * SI,
        /// Indicated airspeed of the climb: below it, its pitch is reduced.
        climb_kt (5.0 to 600.0) => climb_mps * KNOT_MPS,
        /// Pitch of the climb, unless the plan gives one.
        climb_pitch_deg (1.0 to 30.0) => climb_pitch_rad * DEGREE_RAD,
        /// Indicated airspeed of the approach, to which half of the head wind is added.
        approach_kt (5.0 to 600.0) => approach_mps * KNOT_MPS,
        /// Angle of the glide path.
        glide_path_deg (1.0 to 10.0) => glide_path_rad * DEGREE_RAD,
        /// In the flare the sink rate is the height over this.
        flare_s (0.5 to 10.0) => flare_s * SI,
        /// The sink rate in which the flare ends.
        touchdown_fpm (1.0 to 400.0) => touchdown_mps * FOOT_PER_MINUTE_MPS,
        /// Without a range finder the height over the runway may be off by this.
        height_uncertainty_ft (0.0 to 100.0) => height_uncertainty_m * FOOT_M,
        /// Flaps of the take-off, 0 to 1.
        takeoff_flaps (0.0 to 1.0) => takeoff_flaps * SI,
        /// Flaps of the landing, 0 to 1.
        landing_flaps (0.0 to 1.0) => landing_flaps * SI,
        /// Brake of the roll-out, 0 to 1.
        brake (0.0 to 1.0) => brake * SI,
        /// The radius of a turn with the nose wheel fully deflected.
        steering_radius_m (0.1 to 100.0) => steering_radius_m * SI,
        /// What the range finder reads on the wheels.
        height_on_wheels_m (0.0 to 20.0) => height_on_wheels_m * SI,
        /// Below this height a landing outside the following limits is given up.
        decision_height_ft (0.0 to 1000.0) => decision_height_m * FOOT_M,
        /// Off the centre line.
        most_cross_track_m (1.0 to 1000.0) => most_cross_track_m * SI,
        /// Off the glide path.
        most_off_path_m (1.0 to 1000.0) => most_off_path_m * SI,
        /// Off the airspeed of the approach.
        most_off_airspeed_kt (1.0 to 100.0) => most_off_airspeed_mps * KNOT_MPS,
        /// Bank.
        most_bank_deg (1.0 to 60.0) => most_bank_rad * DEGREE_RAD;
        /// Whether the gear is retracted in flight.
        retractable_gear,
    }
}

section! {
    /// `[autopilot.airspeed]`; throttle is 0..1.
    AirspeedSection for AirspeedConfig in "autopilot.airspeed" {
        /// Acceleration per airspeed error.
        airspeed_gain_per_s (0.0 to 10.0) => airspeed_gain_per_s * SI,
        /// The same, integrated.
        airspeed_integral_gain_per_s2 (0.0 to 10.0) => airspeed_integral_gain_per_s2 * SI,
        /// Acceleration against the present one.
        acceleration_gain (0.0 to 5.0) => acceleration_gain * SI,
        /// Throttle that accelerates the aircraft by 1 g.
        throttle_per_g (0.0 to 100.0) => throttle_per_mps2 * (1.0 / GRAVITY_MPS2),
        /// Induced drag over weight at 1 g.
        induced_drag_ratio (0.0 to 1.0) => induced_drag_ratio * SI,
        /// Largest throttle rate.
        max_throttle_rate_per_s (0.01 to 100.0) => max_throttle_rate_per_s * SI,
        /// Throttle for level flight at the reference airspeed.
        trim_throttle (0.0 to 1.0) => trim_throttle * SI,
    }
}

/// Key, smallest and largest value of all of them, as in the table of all keys.
pub(super) fn ranges() -> impl Iterator<Item = &'static (&'static str, f64, f64)> {
    let sections = [
        ScaleSection::RANGES,
        EnvelopeSection::RANGES,
        NavigationSection::RANGES,
        HeadingSection::RANGES,
        AltitudeSection::RANGES,
        RunwaySection::RANGES,
        AirspeedSection::RANGES,
    ];
    sections.into_iter().flatten()
}

/// A nose that is held up shows up to 1 g along the aircraft: 0.7 g at 45°.
const LEAST_LAUNCH_G: f64 = 0.8;

/// Of `[autopilot.runway]`: a throw is more than what a hand does otherwise.
pub(super) fn launch(runway: &RunwaySection, report: &mut impl FnMut(&[&str], String)) {
    let launch_g = runway.launch_g;
    if launch_g > 0.0 && launch_g < LEAST_LAUNCH_G {
        let message = format!(
            "is {launch_g}: choose at least {LEAST_LAUNCH_G}, or 0 for a take-off on wheels; \
             holding the nose up shows 0.7"
        );
        report(&["autopilot.runway.launch_g"], message);
    }
}

//! `[built-in]`: the aircraft is the built-in one.

use fcc_core::units::{FOOT_M, KNOT_MPS};
use fcc_sim::{
    Channels, Electrical, RawSensorSet, SensorConfig, Severity, SimConfig, SwitchScript, TrimError,
    Wind, trim,
};
use serde::{Deserialize, Serialize};

use super::{CalibrationSection, NavigationMethod};

/// `[built-in]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct BuiltInSection {
    /// At the start.
    pub altitude_ft: f64,
    /// The level ground, above mean sea level: a flight ends on it, unless it lands.
    pub ground_ft: f64,
    /// Whether it begins on the ground, on its wheels; so does a plan with a take-off.
    pub on_runway: bool,
    /// Indicated, at the start.
    pub airspeed_kt: f64,
    /// At the start.
    pub heading_deg: f64,
    /// Where it begins; none: where the plan does, or on the equator.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latitude_deg: Option<f64>,
    /// Likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longitude_deg: Option<f64>,
    /// Where the wind comes from.
    pub wind_from_deg: f64,
    /// Steady wind.
    pub wind_kt: f64,
    /// Turbulence.
    pub gusts: GustsChoice,
    /// Whether the sensors are noisy, like those of a phone.
    pub noise: bool,
    /// The delay of the sensors.
    pub delay_ms: u16,
    /// When the engage switch is switched on; none for
    /// [`BuiltInSection::engages_at_s`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engage_at_s: Option<f64>,
    /// When the engine stops for good; none: never.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine_stops_at_s: Option<f64>,
    /// When the alternator fails; none: never.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alternator_stops_at_s: Option<f64>,
    /// What is left in the battery at the start.
    pub battery_charge_percent: f64,
    /// What the battery gives when it is full.
    pub battery_capacity_ah: f64,
    /// What everything on board takes.
    pub electrical_load_a: f64,
    /// The seed: the same seed gives the same flight.
    pub seed: u64,
    /// The raw sensors, in addition to those that give attitude and altitude.
    pub raw_sensors: RawSensorsChoice,
    /// The calibration of the raw sensors.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

/// The raw sensors.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RawSensorsChoice {
    /// None.
    #[default]
    None,
    /// Those of the thesis' phone.
    Phone,
    /// Those of a present board.
    Board,
}

/// The severity of the gusts (MIL-F-8785C).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GustsChoice {
    /// Still air.
    #[default]
    None,
    /// Light.
    Light,
    /// Moderate.
    Moderate,
    /// Severe.
    Severe,
}

impl GustsChoice {
    /// Every choice, by its name in a configuration.
    pub const ALL: [(&str, Self); 4] = [
        ("none", Self::None),
        ("light", Self::Light),
        ("moderate", Self::Moderate),
        ("severe", Self::Severe),
    ];

    /// The core's; none for still air.
    pub(crate) const fn severity(self) -> Option<Severity> {
        match self {
            Self::None => None,
            Self::Light => Some(Severity::Light),
            Self::Moderate => Some(Severity::Moderate),
            Self::Severe => Some(Severity::Severe),
        }
    }
}

impl Default for BuiltInSection {
    fn default() -> Self {
        Self {
            altitude_ft: 3_000.0,
            ground_ft: 0.0,
            on_runway: false,
            airspeed_kt: 100.0,
            heading_deg: 0.0,
            latitude_deg: None,
            longitude_deg: None,
            wind_from_deg: 0.0,
            wind_kt: 0.0,
            gusts: GustsChoice::None,
            noise: true,
            delay_ms: 0,
            engage_at_s: None,
            engine_stops_at_s: None,
            alternator_stops_at_s: None,
            battery_charge_percent: 100.0,
            battery_capacity_ah: 12.75,
            electrical_load_a: 15.0,
            seed: 1,
            raw_sensors: RawSensorsChoice::None,
            calibration: CalibrationSection::default(),
        }
    }
}

/// When the engage switch is switched on by default, s: sensors that measure
/// attitude have settled after 1.1 s. Navigation by raw readings has after 2.1 to
/// 3 s in gusts, and its gyroscopes are compared with the magnetic field after some 11 s.
const ENGAGES_AT_S: f64 = 2.0;
const ENGAGES_BY_RAW_AT_S: f64 = 15.0;

impl BuiltInSection {
    /// When the engage switch is switched on, with this navigation.
    pub fn engages_at_s(&self, navigation: NavigationMethod) -> f64 {
        self.engage_at_s.unwrap_or(match navigation {
            NavigationMethod::Measured => ENGAGES_AT_S,
            NavigationMethod::Kalman => ENGAGES_BY_RAW_AT_S,
        })
    }

    /// The simulation, with the navigation that it is flown by.
    pub fn simulation(&self, navigation: NavigationMethod) -> SimConfig {
        SimConfig {
            switch: SwitchScript {
                on_at_s: Some(self.engages_at_s(navigation)),
                off_at_s: None,
            },
            ..SimConfig::from(self)
        }
    }

    /// Why the aircraft cannot begin in level flight at this airspeed and
    /// altitude, if it cannot.
    pub(super) fn why_not_level(&self) -> Option<String> {
        let start = SimConfig::from(self);
        let error = trim(
            &start.airframe,
            start.indicated_airspeed_mps,
            start.altitude_m,
        )
        .err()?;
        let (airspeed_kt, altitude_ft) = (self.airspeed_kt, self.altitude_ft);
        let why = match error {
            TrimError::Throttle { throttle, .. } => format!(
                "at {altitude_ft:.0} ft level flight takes a throttle of {throttle:.2}, and there is \
                 0 to 1: choose a lower airspeed or altitude"
            ),
            other => other.to_string(),
        };
        Some(format!("is {airspeed_kt}: {why}"))
    }
}

/// Without the engage switch, which depends on the navigation.
impl From<&BuiltInSection> for SimConfig {
    fn from(section: &BuiltInSection) -> Self {
        Self {
            altitude_m: section.altitude_ft * FOOT_M,
            ground_m: section.ground_ft * FOOT_M,
            on_runway: section.on_runway,
            indicated_airspeed_mps: section.airspeed_kt * KNOT_MPS,
            heading_rad: section.heading_deg.to_radians(),
            latitude_rad: section.latitude_deg.unwrap_or(0.0).to_radians(),
            longitude_rad: section.longitude_deg.unwrap_or(0.0).to_radians(),
            wind: Wind {
                from_rad: section.wind_from_deg.to_radians(),
                speed_mps: section.wind_kt * KNOT_MPS,
            },
            gusts: section.gusts.severity(),
            sensors: SensorConfig {
                noise: if section.noise {
                    Channels::TYPICAL_NOISE
                } else {
                    Channels::default()
                },
                delay_ms: section.delay_ms,
                ..SensorConfig::default()
            },
            engine_stops_at_s: section.engine_stops_at_s,
            electrical: Electrical {
                capacity_ah: section.battery_capacity_ah,
                charge: section.battery_charge_percent / 100.0,
                load_a: section.electrical_load_a,
                alternator_stops_at_s: section.alternator_stops_at_s,
            },
            seed: section.seed,
            raw_sensors: match section.raw_sensors {
                RawSensorsChoice::None => None,
                RawSensorsChoice::Phone => Some(RawSensorSet::phone()),
                RawSensorsChoice::Board => Some(RawSensorSet::board()),
            },
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    /// In gusts navigation by raw readings was not settled after 2 s in 8 of 8
    /// flights.
    #[test]
    fn the_switch_waits_until_navigation_has_settled() {
        for (text, expected_s) in [
            ("[built-in]\n", 2.0),
            ("[built-in]\n[navigation]\nmethod = \"kalman\"\n", 15.0),
            (
                "[built-in]\nengage_at_s = 3\n[navigation]\nmethod = \"kalman\"\n",
                3.0,
            ),
        ] {
            let config = Config::parse(text, "test").unwrap();
            let section = config.built_in.as_ref().unwrap();
            let simulated = section.simulation(config.navigation.method);
            assert_eq!(simulated.switch.on_at_s, Some(expected_s), "{text}");
        }
    }
}

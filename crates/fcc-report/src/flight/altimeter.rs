//! The altimeter settings of a flight.

use fcc_core::flight::atmosphere::SEA_LEVEL_PRESSURE_PA;
use fcc_telemetry::units::PA_HPA;
use serde::Serialize;

/// At most this many are kept.
const MOST_SETTINGS: usize = 16;

/// The standard altimeter setting.
const STANDARD_HPA: f64 = SEA_LEVEL_PRESSURE_PA * PA_HPA;

/// The altimeter settings of a flight, each once, in their order, hPa.
#[derive(Clone, Debug, Default, Serialize)]
pub struct AltimeterSettings(Vec<f64>);

impl AltimeterSettings {
    /// Notes the present one.
    pub(super) fn push(&mut self, setting_hpa: f64) {
        let Self(settings) = self;
        if setting_hpa > 0.0
            && settings.last() != Some(&setting_hpa)
            && settings.len() < MOST_SETTINGS
        {
            settings.push(setting_hpa);
        }
    }

    /// What the altimeter was set to, if that was not the standard pressure.
    pub(super) fn finding(&self) -> Option<String> {
        let Self(settings) = self;
        if settings.iter().all(|hpa| *hpa == STANDARD_HPA) {
            return None;
        }
        let settings: Vec<_> = settings.iter().map(|hpa| format!("{hpa:.2}")).collect();
        Some(format!(
            "The altimeter was set to {} hPa: the altitudes below are pressure altitudes.",
            settings.join(", then ")
        ))
    }
}

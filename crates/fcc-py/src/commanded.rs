//! Set points that Python commands, checked.

use fcc_core::flight::{AutopilotCommand, AutopilotConfig};
use fcc_flight::flight::{altitudes_m, heights_m};
use fcc_telemetry::units::{
    COMMANDED_ALTIMETER_SETTING_PA, COMMANDED_ALTITUDE_M, COMMANDED_HEADING_RAD,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{finite, within};

/// The set points given; none stays as it is.
pub(crate) struct Commanded {
    /// As the envelope allows.
    pub(crate) airspeed_mps: Option<f64>,
    /// -4π to 4π.
    pub(crate) heading_rad: Option<f64>,
    /// -500 to 20,000, like the other altitudes, of which one is given at most.
    pub(crate) altitude_m: Option<f64>,
    pub(crate) pressure_altitude_m: Option<f64>,
    /// Only with a field's elevation in the configuration.
    pub(crate) height_m: Option<f64>,
    /// 94,000 to 106,000.
    pub(crate) altimeter_setting_pa: Option<f64>,
}

impl Commanded {
    fn altitudes(&self) -> usize {
        let all = [self.altitude_m, self.pressure_altitude_m, self.height_m];
        all.iter().flatten().count()
    }

    /// Whether it has a set point, which is flown only while engaged.
    pub(crate) fn is_more_than_a_setting(&self) -> bool {
        self.altimeter_setting_pa.is_none()
            || self.airspeed_mps.is_some()
            || self.heading_rad.is_some()
            || self.altitudes() > 0
    }

    /// Commands for the controller, in the order of execution.
    pub(crate) fn checked(&self, config: &AutopilotConfig) -> PyResult<Vec<AutopilotCommand>> {
        if self.altitudes() > 1 {
            return Err(PyValueError::new_err(
                "several altitudes are given: choose one of altitude_m, pressure_altitude_m and \
                 height_m",
            ));
        }
        if self.height_m.is_some() && config.altimeter.field_elevation_m.is_none() {
            return Err(PyValueError::new_err(
                "height_m needs the elevation of its field: set altimeter.field_elevation_ft in \
                 the configuration, or give altitude_m",
            ));
        }
        let airspeeds_mps = config.envelope.allowed_airspeeds();
        // The limits as the message gives them: they are whole in knots.
        let [least, most] =
            [airspeeds_mps.start(), airspeeds_mps.end()].map(|mps| (mps * 100.0).round() / 100.0);
        let given = [
            (
                "altimeter_setting_pa",
                self.altimeter_setting_pa,
                COMMANDED_ALTIMETER_SETTING_PA,
                AutopilotCommand::AltimeterSetting as fn(f64) -> _,
            ),
            (
                "airspeed_mps",
                self.airspeed_mps,
                least..=most,
                AutopilotCommand::Airspeed,
            ),
            (
                "heading_rad",
                self.heading_rad,
                // The sum of two headings, too.
                2.0 * COMMANDED_HEADING_RAD.start()..=2.0 * COMMANDED_HEADING_RAD.end(),
                AutopilotCommand::Heading,
            ),
            (
                "altitude_m",
                self.altitude_m,
                altitudes_m(config),
                AutopilotCommand::Altitude,
            ),
            (
                "pressure_altitude_m",
                self.pressure_altitude_m,
                COMMANDED_ALTITUDE_M,
                AutopilotCommand::PressureAltitude,
            ),
            (
                "height_m",
                self.height_m,
                heights_m(config).unwrap_or(COMMANDED_ALTITUDE_M),
                AutopilotCommand::Height,
            ),
        ];
        let given = given
            .into_iter()
            .filter_map(|(name, value, range, command)| {
                let (value, least, most) = (value?, *range.start(), *range.end());
                Some(
                    finite(name, value)
                        .and_then(|value| within(name, value, least, most))
                        .map(command),
                )
            });
        given.collect()
    }
}

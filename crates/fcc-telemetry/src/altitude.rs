//! The altitude as people read it: above what the set point refers to.

use fcc_core::flight::{Altimeter, AltitudeReference};
use fcc_fixed_wing::Setpoints;

use crate::FlightRecord;
use crate::units::PA_HPA;

/// What an altitude in a display is above.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShownAltitude {
    /// `altitude`, `pressure altitude` or `height`.
    pub name: &'static str,
    /// What it is above, by its name.
    pub reference: &'static str,
    /// The pressure altitude of what it is above, m.
    pub datum_m: f64,
    /// The altimeter setting, hPa; none if it is the standard one.
    pub setting_hpa: Option<f64>,
}

impl ShownAltitude {
    /// How the altitudes of a record are shown: in control, above what the set
    /// point refers to, otherwise above sea level by the altimeter setting.
    pub fn of(record: &FlightRecord) -> Self {
        let Setpoints {
            altimeter_setting_pa: setting_pa,
            altitude_reference: reference,
            altitude_m,
            altitude_above_reference_m: above_m,
            ..
        } = record.setpoints;
        let altimeter = Altimeter {
            setting_pa,
            field_elevation_m: None,
        };
        // A record of an earlier version has no setting.
        let is_standard = setting_pa <= 0.0 || altimeter == Altimeter::default();
        let shown = |name, reference: AltitudeReference, datum_m| Self {
            name,
            reference: reference.name(),
            datum_m,
            setting_hpa: (!is_standard).then_some(setting_pa * PA_HPA),
        };
        let in_control = record.state.state().holds_control();
        match reference {
            AltitudeReference::PressureLevel if is_standard => shown("altitude", reference, 0.0),
            AltitudeReference::PressureLevel if in_control => {
                shown("pressure altitude", reference, 0.0)
            }
            AltitudeReference::Field => shown("height", reference, altitude_m - above_m),
            AltitudeReference::PressureLevel | AltitudeReference::SeaLevel => {
                let datum_m = altimeter.datum_m(AltitudeReference::SeaLevel);
                shown(
                    "altitude",
                    AltitudeReference::SeaLevel,
                    datum_m.unwrap_or(0.0),
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::State;

    use super::*;

    use AltitudeReference::{Field, PressureLevel, SeaLevel};

    const FOOT_M: f64 = 0.304_8;
    /// 30.2 inHg: by the pilots' table (FAA-H-8083-25C, figure 11-3) a pressure
    /// altitude of -257 ft.
    const SETTING_PA: f64 = 102_268.9;

    fn shown(state: State, setpoints: Setpoints) -> (&'static str, f64, Option<f64>) {
        let shown = ShownAltitude::of(&FlightRecord {
            state: state.into(),
            setpoints,
            ..FlightRecord::default()
        });
        let datum_ft = (shown.datum_m / FOOT_M).round();
        (shown.name, datum_ft, shown.setting_hpa.map(f64::round))
    }

    #[test]
    fn an_altitude_is_shown_as_it_was_commanded() {
        let set = |altimeter_setting_pa, altitude_reference| Setpoints {
            altimeter_setting_pa,
            altitude_reference,
            altitude_m: 443.0 * FOOT_M,
            ..Setpoints::default()
        };
        let hpa = Some(1_023.0);
        for (state, setpoints, expected) in [
            (
                State::Engaged,
                Setpoints::default(),
                ("altitude", 0.0, None),
            ),
            (
                State::Engaged,
                set(101_325.0, PressureLevel),
                ("altitude", 0.0, None),
            ),
            (
                State::Standby,
                set(SETTING_PA, PressureLevel),
                ("altitude", -257.0, hpa),
            ),
            (
                State::Engaged,
                set(SETTING_PA, PressureLevel),
                ("pressure altitude", 0.0, hpa),
            ),
            (
                State::Engaged,
                set(SETTING_PA, SeaLevel),
                ("altitude", -257.0, hpa),
            ),
            (
                State::Engaged,
                set(SETTING_PA, Field),
                ("height", 443.0, hpa),
            ),
        ] {
            assert_eq!(shown(state, setpoints), expected, "{setpoints:?}");
        }
    }
}

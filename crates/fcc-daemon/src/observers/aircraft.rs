//! The aircraft in a status line.

use fcc_core::framework::{Reading, State, Switch};
use fcc_telemetry::units::{M_FT, MPS_KT};
use fcc_telemetry::{FlightRecord, ShownAltitude};

/// Heading, altitude and airspeed, and while engaged the mode and what is commanded; none
/// before they are known. What no sensor measures, navigation knows from raw readings.
pub(crate) fn describe(record: &FlightRecord) -> Option<String> {
    let measured = &record.measurements;
    let estimate = &record.estimate;
    let is_raw = measured.airspeed_mps.is_never();
    // Before anything arrives, the estimate is of zeros.
    if is_raw && estimate.airspeed_mps == 0.0 && estimate.altitude_m == 0.0 {
        return None;
    }
    let known = |reading: &Reading<f64>, estimated: f64| {
        if reading.is_never() {
            estimated
        } else {
            reading.value
        }
    };
    let heading = compass(known(&measured.heading_rad, estimate.heading_rad));
    let shown = ShownAltitude::of(record);
    let name = match (shown.name, shown.setting_hpa) {
        // As in a METAR, where it is not the standard one.
        ("altitude", Some(hpa)) => &format!("Q{hpa:.0}"),
        ("pressure altitude", _) => "p.alt",
        ("altitude", None) => "alt",
        (name, _) => name,
    };
    let altitude = if measured.altitude_m.is_never() && !is_raw {
        "   –".to_owned()
    } else {
        let altitude_m = known(&measured.altitude_m, estimate.altitude_m);
        format!("{:4.0}", (altitude_m - shown.datum_m) * M_FT)
    };
    let airspeed = known(&measured.airspeed_mps, estimate.airspeed_mps) * MPS_KT;
    let desired = &record.setpoints;
    Some(if record.state == State::Engaged {
        let mode = desired.guidance.to_string();
        format!(
            "{:<8}  hdg {heading:3.0}→{:3.0}°  {name} {altitude}→{:4.0} ft  \
             {airspeed:3.0}→{:3.0} kt",
            mode.replace("timed-pattern ", "").replace("item ", ""),
            compass(desired.heading_rad),
            (desired.altitude_m - shown.datum_m) * M_FT,
            desired.airspeed_mps * MPS_KT,
        )
    } else {
        format!("hdg {heading:3.0}°  {name} {altitude} ft  {airspeed:3.0} kt")
    })
}

/// The position of the engage switch; none if it was never read.
pub(crate) fn switch(record: &FlightRecord) -> Option<Switch> {
    let switch = &record.measurements.engage_switch;
    (!switch.is_never()).then_some(switch.value)
}

/// Whole degrees, 0 to 359, as on a compass card.
fn compass(heading_rad: f64) -> f64 {
    heading_rad.to_degrees().round().rem_euclid(360.0) + 0.0
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::AltitudeReference;
    use fcc_core::framework::Time;

    use super::*;

    /// A pressure altitude of 900 m is 984 m with 1023 hPa: 9.8 hPa are 84 m lower
    /// (ICAO Doc 7488, 8.5 m/hPa near sea level).
    #[test]
    fn an_altitude_by_another_setting_names_it() {
        let mut record = FlightRecord::default();
        record.measurements.airspeed_mps = Reading::new(50.0, Time::from_nanos(1));
        record.measurements.altitude_m = Reading::new(900.0, Time::from_nanos(1));
        record.setpoints.altimeter_setting_pa = 101_325.0;
        assert!(describe(&record).unwrap().contains("alt 2953 ft"));
        record.setpoints.altimeter_setting_pa = 102_300.0;
        record.setpoints.altitude_reference = AltitudeReference::SeaLevel;
        let line = describe(&record).unwrap();
        let (_, after) = line.split_once("Q1023 ").unwrap();
        let shown_ft: f64 = after.split(' ').next().unwrap().parse().unwrap();
        assert!((shown_ft - 984.0 * M_FT).abs() < 20.0, "{line}");
    }
}

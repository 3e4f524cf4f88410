//! The aircraft in a status line.

use fcc_core::framework::State;
use fcc_telemetry::units::{M_FT, MPS_KT};
use fcc_telemetry::{FlightRecord, ShownAltitude};

/// Attitude, altitude and airspeed, and while engaged what is commanded; none
/// before they are measured.
pub(crate) fn describe(record: &FlightRecord) -> Option<String> {
    let measured = &record.measurements;
    if measured.airspeed_mps.is_never() {
        return None;
    }
    let heading = compass(measured.heading_rad.value);
    let shown = ShownAltitude::of(record);
    let name = shown.name;
    let altitude = if measured.altitude_m.is_never() {
        "    –".to_owned()
    } else {
        format!("{:5.0}", (measured.altitude_m.value - shown.datum_m) * M_FT)
    };
    let qnh = shown
        .setting_hpa
        .map_or_else(String::new, |hpa| format!("  QNH {hpa:.1} hPa"));
    let airspeed = measured.airspeed_mps.value * MPS_KT;
    // Plus zero, because a rounded -0 looks like an error.
    let bank = measured.attitude.value.roll_rad.to_degrees().round() + 0.0;
    let desired = &record.setpoints;
    Some(if record.state == State::Engaged {
        format!(
            "{}  heading {heading:3.0}° → {:3.0}°  bank {bank:3.0}°  \
             {name} {altitude} → {:5.0} ft{qnh}  airspeed {airspeed:5.1} → {:5.1} kt  \
             throttle {:3.0} %",
            desired.guidance,
            compass(desired.heading_rad),
            (desired.altitude_m - shown.datum_m) * M_FT,
            desired.airspeed_mps * MPS_KT,
            record.outputs.throttle * 100.0,
        )
    } else {
        format!(
            "heading {heading:3.0}°  bank {bank:3.0}°  {name} {altitude} ft{qnh}  \
             airspeed {airspeed:5.1} kt"
        )
    })
}

/// Whole degrees, 0 to 359, as on a compass card.
fn compass(heading_rad: f64) -> f64 {
    heading_rad.to_degrees().round().rem_euclid(360.0)
}

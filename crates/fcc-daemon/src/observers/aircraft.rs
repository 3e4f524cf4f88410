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
    let name = match shown.name {
        "pressure altitude" => "p.alt",
        "altitude" => "alt",
        name => name,
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

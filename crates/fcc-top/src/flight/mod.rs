//! What only an aircraft's screen has: the horizon, and a table in feet, knots
//! and degrees.

mod horizon;
mod table;

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Reading, RecordOf, State};
use fcc_telemetry::units::{M_FT, MPS_KT};
use serde_json::{Map, Value, json};

use super::watched::{Part, Watched};

impl Watched for Autopilot {
    const PROGRAM: &'static str = "fccd";

    const READINGS: &'static [&'static str] = &[
        "attitude", "heading", "rates", "force", "airspeed", "altitude", "AoA", "pos.", "vel.",
        "surf.", "switch", "plant",
    ];

    fn parts(record: Option<&RecordOf<Self>>) -> Vec<(String, u16, Part<Self>)> {
        // Engaged, the mode of guidance and where it is.
        let flown = match record {
            Some(record) if record.state == State::Engaged => record.setpoints.guidance.to_string(),
            _ => "Flight".to_owned(),
        };
        vec![
            ("Attitude".to_owned(), 23, horizon::draw),
            (flown, 27, table::draw),
        ]
    }

    fn values(record: &RecordOf<Self>) -> Map<String, Value> {
        let (measured, wanted) = (&record.measurements, &record.setpoints);
        let number = |of: &Reading<f64>, factor: f64| known(of).map(|value| value * factor);
        let compass_deg = |rad: f64| rad.to_degrees().rem_euclid(360.0);
        let attitude = known(&measured.attitude);
        let engaged = record.state == State::Engaged;
        let values = json!({
            "actual": {
                "heading_deg": known(&measured.heading_rad).map(compass_deg),
                "altitude_ft": number(&measured.altitude_m, M_FT),
                "airspeed_kt": number(&measured.airspeed_mps, MPS_KT),
                "bank_deg": attitude.map(|attitude| attitude.roll_rad.to_degrees()),
                "pitch_deg": attitude.map(|attitude| attitude.pitch_rad.to_degrees()),
            },
            "setpoints": engaged.then(|| json!({
                "heading_deg": compass_deg(wanted.heading_rad),
                "altitude_ft": wanted.altitude_m * M_FT,
                "airspeed_kt": wanted.airspeed_mps * MPS_KT,
                "bank_deg": wanted.roll_rad.to_degrees(),
                "pitch_deg": wanted.pitch_rad.to_degrees(),
            })),
            "guidance": engaged.then(|| json!({
                "mode": wanted.guidance.mode.name(),
                "item": wanted.guidance.item,
                "elapsed_s": wanted.guidance.elapsed_s,
            })),
            "outputs": record.sent.then(|| json!({
                "throttle": record.outputs.throttle,
                "elevator": record.outputs.elevator,
                "aileron": record.outputs.aileron,
                "rudder": record.outputs.rudder,
            })),
        });
        match values {
            Value::Object(values) => values,
            _ => Map::new(),
        }
    }
}

/// What was ever measured.
fn known<T: Copy>(reading: &Reading<T>) -> Option<T> {
    (!reading.is_never()).then_some(reading.value)
}

//! The parts of the screen for an aircraft: the horizon, and a table in feet,
//! knots and degrees.

mod horizon;
mod table;

use fcc_core::framework::{RecordOf, State};
use fcc_fixed_wing::Autopilot;
use fcc_multicopter::Multicopter;
use fcc_telemetry::ShownAltitude;
use fcc_telemetry::units::PA_HPA;
use serde_json::{Map, Value, json};

use self::table::Quantity;
use super::watched::{ScreenPart, Watched};

impl Watched for Multicopter {
    const PROGRAM: &'static str = "fccd";
}

impl Watched for Autopilot {
    const PROGRAM: &'static str = "fccd";

    const READINGS: &'static [&'static str] = &[
        "attitude", "heading", "rates", "force", "airspeed", "altitude", "AoA", "pos.", "vel.",
        "surf.", "switch", "plant",
    ];

    fn parts(record: Option<&RecordOf<Self>>) -> Vec<(String, u16, ScreenPart<Self>)> {
        // When engaged, the mode of guidance and its progress; the altimeter
        // setting if it is not the standard one.
        let flown = match record {
            Some(record) if record.state == State::Engaged => record.setpoints.guidance.to_string(),
            _ => "Flight".to_owned(),
        };
        let setting_hpa = record.and_then(|record| ShownAltitude::of(record).setting_hpa);
        let flown = match (record, setting_hpa) {
            (Some(record), Some(hpa)) if record.state == State::Engaged => {
                format!("{}, QNH {hpa:.0}", record.setpoints.guidance.mode)
            }
            (_, Some(hpa)) => format!("Flight, QNH {hpa:.0}"),
            (_, None) => flown,
        };
        vec![
            ("Attitude".to_owned(), 23, horizon::draw),
            (flown, 27, table::draw),
        ]
    }

    fn values(record: &RecordOf<Self>) -> Map<String, Value> {
        let progress = record.setpoints.guidance;
        let engaged = record.state == State::Engaged;
        let all = |of: fn(&Quantity) -> Option<f64>| -> Map<String, Value> {
            let quantities = table::quantities(record);
            let pair = |quantity: Quantity| (quantity.key.to_owned(), of(&quantity).into());
            quantities.map(pair).into_iter().collect()
        };
        let values = json!({
            "actual": all(|quantity| quantity.actual),
            "setpoints": engaged.then(|| all(|quantity| Some(quantity.desired))),
            "altimeter_setting_hpa": record.setpoints.altimeter_setting_pa * PA_HPA,
            "altitude_above": ShownAltitude::of(record).reference,
            "guidance": engaged.then(|| json!({
                "mode": progress.mode.name(),
                "item": progress.item,
                "elapsed_s": progress.elapsed_s,
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

//! The parts of the screen for an aircraft: the horizon, and a table in feet,
//! knots and degrees.

mod horizon;
mod table;

use fcc_core::flight::Autopilot;
use fcc_core::framework::{RecordOf, State};
use serde_json::{Map, Value, json};

use self::table::Quantity;
use super::watched::{ScreenPart, Watched};

impl Watched for Autopilot {
    const PROGRAM: &'static str = "fccd";

    const READINGS: &'static [&'static str] = &[
        "attitude", "heading", "rates", "force", "airspeed", "altitude", "AoA", "pos.", "vel.",
        "surf.", "switch", "plant",
    ];

    fn parts(record: Option<&RecordOf<Self>>) -> Vec<(String, u16, ScreenPart<Self>)> {
        // When engaged, the mode of guidance and its progress.
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

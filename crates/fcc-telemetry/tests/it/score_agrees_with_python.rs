//! Two independent implementations of the score agree to the last digits: this
//! one and the one in `hil/`, whose result is in the fixture.

use fcc_telemetry::{Leg, Sample, score};
use serde_json::Value;

const CASE: &str = include_str!("../../../../hil/tests/data/score_case.json");

#[test]
fn agrees_with_the_python_score() {
    let case: Value = serde_json::from_str(CASE).unwrap();
    let trace = &case["trace"];
    let count = trace["time_s"].as_array().unwrap().len();
    let samples: Vec<Sample> = (0..count)
        .map(|n| {
            let of = |column: &str| trace[column][n].as_f64().unwrap();
            Sample {
                time_s: of("time_s"),
                heading_deg: of("heading_deg"),
                altitude_ft: of("altitude_ft"),
                airspeed_kt: of("airspeed_kt"),
                lateral_g: of("lateral_g"),
            }
        })
        .collect();
    let legs: Vec<Leg> = case["legs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|leg| {
            let of = |key: &str| leg[key].as_f64().unwrap();
            Leg {
                start_s: of("start_s"),
                end_s: of("end_s"),
                heading_from_deg: of("heading_from_deg"),
                heading_deg: of("heading_deg"),
                altitude_from_ft: of("altitude_from_ft"),
                altitude_ft: of("altitude_ft"),
                airspeed_kt: of("airspeed_kt"),
            }
        })
        .collect();

    let ours = serde_json::to_value(score(&samples, &legs).unwrap()).unwrap();
    assert!(legs.len() >= 3);
    for (n, expected) in case["expected"]["legs"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        assert_same(&format!("leg {n}"), &ours["legs"][n], expected);
    }
    assert_same("worst", &ours["worst"], &case["expected"]["worst"]);
}

fn assert_same(name: &str, ours: &Value, expected: &Value) {
    for (key, expected) in expected.as_object().unwrap() {
        match expected.as_f64() {
            None => assert!(ours[key].is_null(), "{name} {key}: {} not null", ours[key]),
            Some(expected) => {
                let ours = ours[key].as_f64().unwrap();
                assert!(
                    (ours - expected).abs() < 1e-9,
                    "{name} {key}: {ours} against {expected}"
                );
            }
        }
    }
}

//! The legs of a timed pattern as a table.

use comfy_table::Table;
use fcc_telemetry::{FlightScore, LegScore, ScoredBy};

use crate::table::table;

/// The columns of a leg's figures.
const LEG_COLUMNS: [&str; 10] = [
    "Leg",
    "≤2° s",
    "overshoot °",
    "hdg RMS °",
    "≤10 ft s",
    "overshoot ft",
    "alt RMS ft",
    "turn loss ft",
    "airspeed kt",
    "lateral g",
];

/// Meanings of the columns.
const LEG_LEGEND: &str = "\
≤2° s, ≤10 ft s  seconds into the leg after which heading and altitude stay that near
overshoot        how far past the set point, in the direction of the turn or climb
hdg RMS, alt RMS root mean square of the error in the leg's last 3 s, last 8 s
turn loss        how far below the lower of the two altitudes that the leg joins
airspeed         largest error either way
lateral          largest sideways acceleration";

/// Source of the score, a row per leg and the worst of each column, and the
/// meanings of the columns.
pub fn flight_table(score: &FlightScore, by: ScoredBy) -> String {
    let by = match by {
        ScoredBy::Truth => {
            "the true values of the simulated aircraft (fccd report: by the measurements)"
        }
        ScoredBy::Measurement => "the measurements of the sensors, noise included",
    };
    let table = legs(score);
    format!("Legs, scored by {by}:\n{table}\n\n{LEG_LEGEND}")
}

/// A row per leg, and the worst of each column.
pub(super) fn legs(score: &FlightScore) -> Table {
    let mut table = table(&LEG_COLUMNS);
    for (index, leg) in score.legs.iter().enumerate() {
        table.add_row(leg_cells((index + 1).to_string(), leg));
    }
    if let Some(worst) = &score.worst {
        table.add_row(leg_cells("worst".to_owned(), worst));
    }
    table
}

/// The cells of a leg, under [`LEG_COLUMNS`].
fn leg_cells(name: String, leg: &LegScore) -> Vec<String> {
    let settle = |time: Option<f64>| time.map_or("never".to_owned(), |s| format!("{s:.1}"));
    vec![
        name,
        settle(leg.heading_settle_s),
        format!("{:.2}", leg.heading_overshoot_deg),
        format!("{:.2}", leg.heading_rms_deg),
        settle(leg.altitude_settle_s),
        format!("{:.2}", leg.altitude_overshoot_ft),
        format!("{:.2}", leg.altitude_rms_ft),
        format!("{:.2}", leg.turn_loss_ft),
        format!("{:.2}", leg.airspeed_error_kt),
        format!("{:.3}", leg.lateral_acceleration_g),
    ]
}

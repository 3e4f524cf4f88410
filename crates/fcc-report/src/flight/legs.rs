//! The legs of a timed pattern as a table.

use comfy_table::Table;
use fcc_telemetry::{FlightScore, LegScore, ScoredBy};

use crate::table::table;

/// The columns of a leg's figures, with their units: of heading, of altitude, and the others.
const LEG_COLUMNS: [&str; 10] = [
    "Leg",
    "≤2°\ns",
    "over\n°",
    "RMS\n°",
    "≤10 ft\ns",
    "over\nft",
    "RMS\nft",
    "loss\nft",
    "speed\nkt",
    "side\ng",
];

/// Meanings of the columns.
const LEG_LEGEND: &str = "\
≤2°, ≤10 ft  seconds of the leg until heading and altitude stay that near
over         how far past the set point, in the direction of the turn or climb
RMS          root mean square error: of the heading in the leg's last 3 s,
             of the altitude in the last 8 s
loss         how far below the lower of the two altitudes that the leg joins
speed, side  largest error of the airspeed either way, sideways acceleration";

/// Source of the score, a row per leg and the worst of each column, and the
/// meanings of the columns.
pub fn flight_table(score: &FlightScore, by: ScoredBy) -> String {
    let by = match by {
        ScoredBy::Truth => "the true values (fccd report: by the measurements)",
        ScoredBy::Measurement => "the measurements of the sensors, noise included",
    };
    let table = legs(score);
    format!("Legs, scored by {by}:\n{table}\n\n{LEG_LEGEND}")
}

/// A row per leg, and the worst of each column.
pub(super) fn legs(score: &FlightScore) -> Table {
    let mut table = table(&LEG_COLUMNS);
    for leg in &score.legs {
        let number = leg.number.map(|number| number.to_string());
        table.add_row(leg_cells(number.unwrap_or_default(), leg));
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
        format!("{:.1}", leg.altitude_overshoot_ft),
        format!("{:.1}", leg.altitude_rms_ft),
        format!("{:.1}", leg.turn_loss_ft),
        format!("{:.2}", leg.airspeed_error_kt),
        format!("{:.3}", leg.lateral_acceleration_g),
    ]
}

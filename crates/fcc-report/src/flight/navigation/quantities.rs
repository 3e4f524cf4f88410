//! What navigation by different methods is compared in, in display units.

use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, RecordOf, Time};
use fcc_fixed_wing::Autopilot;
use fcc_navigation::inertial::Solution;
use fcc_telemetry::units::M_FT;

use crate::plots::{Panel, Plot, Scale};

/// A quantity: its name, its unit, and the scale of its plot.
pub(super) struct Quantity {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) scale: Scale,
}

const fn quantity(name: &'static str, unit: &'static str, scale: Scale) -> Quantity {
    Quantity { name, unit, scale }
}

/// All of them, in the order of [`Values`].
pub(super) const ALL: [Quantity; 7] = [
    quantity("roll", "°", Scale::Together(5.0)),
    quantity("pitch", "°", Scale::Together(2.0)),
    quantity("heading", "°", Scale::Compass),
    quantity("altitude", "ft", Scale::Together(20.0)),
    quantity("velocity north", "m/s", Scale::Together(1.0)),
    quantity("velocity east", "m/s", Scale::Together(1.0)),
    quantity("velocity down", "m/s", Scale::Together(1.0)),
];

/// Of each quantity its value, if it is known.
pub(super) type Values = [Option<f64>; ALL.len()];

/// The quantity that is counted through full turns.
pub(super) const HEADING: usize = 2;

/// A reading older than this, s, says nothing of now: attitude and the like; and
/// the readings of a receiver.
const OLDEST_S: f64 = 0.25;
const OLDEST_VELOCITY_S: f64 = 0.5;

fn fresh<T: Copy>(reading: &Reading<T>, now: Time, oldest_s: f64) -> Option<T> {
    let age_s = now.since(reading.taken).as_secs_f64();
    (!reading.is_never() && age_s <= oldest_s).then_some(reading.value)
}

/// What readings of the quantities themselves say.
pub(super) fn measured(of: &Measurements, now: Time) -> Values {
    let attitude = fresh(&of.attitude, now, OLDEST_S);
    let velocity = fresh(&of.velocity, now, OLDEST_VELOCITY_S);
    [
        attitude.map(|angles| angles.roll_rad.to_degrees()),
        attitude.map(|angles| angles.pitch_rad.to_degrees()),
        fresh(&of.heading_rad, now, OLDEST_S).map(f64::to_degrees),
        fresh(&of.altitude_m, now, OLDEST_S).map(|m| m * M_FT),
        velocity.map(|of| of.north_mps),
        velocity.map(|of| of.east_mps),
        velocity.map(|of| of.down_mps),
    ]
}

/// What a method found: the readings that it gives, and its own velocity.
pub(super) fn found(of: &Measurements, solution: &Solution, now: Time) -> Values {
    let [roll, pitch, heading, altitude, ..] = measured(of, now);
    let is_now = now.since(solution.time).as_secs_f64() <= OLDEST_S;
    let [north, east, down] = solution
        .velocity_mps
        .map(|mps| Some(mps).filter(|mps| is_now && mps.is_finite()));
    [roll, pitch, heading, altitude, north, east, down]
}

/// What was flown by, while the loop had control.
pub(super) fn flown(record: &RecordOf<Autopilot>) -> Values {
    let of = &record.estimate;
    let value = |value: f64| Some(value).filter(|_| record.sent);
    [
        value(of.roll_rad.to_degrees()),
        value(of.pitch_rad.to_degrees()),
        value(of.heading_rad.to_degrees()),
        value(of.altitude_m * M_FT),
        None,
        None,
        None,
    ]
}

/// The plot of a quantity.
pub(super) fn plot(at: usize, panels: Vec<Panel>) -> Plot {
    let name = ALL.get(at).map_or("", |of| of.name);
    Plot {
        title: format!("Navigation: {name}"),
        caption: format!(
            "The {name} by each method, from the recorded raw readings, with what was flown and \
             what sensors measured."
        ),
        panels,
    }
}

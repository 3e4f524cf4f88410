//! How closely a flight followed its legs.
//!
//! Angles are compared the shorter way. A sample on the border of two legs
//! counts for the later one.

use fcc_core::flight::Measurements;
use serde::Serialize;

use crate::units::{G_MPS2, M_FT, MPS_KT};

/// The state at one instant, in the units of the score.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample {
    /// On any clock, ascending.
    pub time_s: f64,
    /// Any number of turns.
    pub heading_deg: f64,
    /// Altitude.
    pub altitude_ft: f64,
    /// Indicated airspeed.
    pub airspeed_kt: f64,
    /// Specific force to the right over gravity.
    pub lateral_g: f64,
}

impl Sample {
    /// From the measurements of a tick.
    pub fn measured(measured: &Measurements, time_s: f64) -> Self {
        Self {
            time_s,
            heading_deg: measured.heading_rad.value.to_degrees(),
            altitude_ft: measured.altitude_m.value * M_FT,
            airspeed_kt: measured.airspeed_mps.value * MPS_KT,
            lateral_g: measured.specific_force.value.y_mps2 / G_MPS2,
        }
    }
}

/// A stretch of a flight with constant set points, with those before it. It
/// covers `start_s <= time < end_s`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Leg {
    /// On the samples' clock.
    pub start_s: f64,
    /// On the samples' clock.
    pub end_s: f64,
    /// Set point before the leg.
    pub heading_from_deg: f64,
    /// Set point of the leg.
    pub heading_deg: f64,
    /// Set point before the leg.
    pub altitude_from_ft: f64,
    /// Set point of the leg.
    pub altitude_ft: f64,
    /// Set point of the leg.
    pub airspeed_kt: f64,
}

/// The score of one leg, or the worst of each value over all legs.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct LegScore {
    /// Number of the leg in its flight, from 1; none for the worst.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<usize>,
    /// Time after the leg's start from which the heading stays within 2° until
    /// its end; none if it does not.
    pub heading_settle_s: Option<f64>,
    /// How far the heading passes its set point in the direction of the turn.
    pub heading_overshoot_deg: f64,
    /// Root mean square of the heading error in the last 3 s.
    pub heading_rms_deg: f64,
    /// As for the heading, within 10 ft.
    pub altitude_settle_s: Option<f64>,
    /// How far the altitude passes its set point in the direction of the climb.
    pub altitude_overshoot_ft: f64,
    /// Root mean square of the altitude error in the last 8 s.
    pub altitude_rms_ft: f64,
    /// How far the altitude falls below the lower of the leg's two set points:
    /// in a level turn, the height lost.
    pub turn_loss_ft: f64,
    /// Largest airspeed error, absolute.
    pub airspeed_error_kt: f64,
    /// Largest lateral acceleration, absolute.
    pub lateral_acceleration_g: f64,
}

/// A flight's score.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FlightScore {
    /// By leg, in order.
    pub legs: Vec<LegScore>,
    /// The worst of each value; none without a complete leg.
    pub worst: Option<LegScore>,
}

/// Why a flight could not be scored.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// A part of a leg has no samples.
    #[error(
        "the leg from {start_s:.1} s to {end_s:.1} s has no samples from {from_s:.1} s to \
         {to_s:.1} s: fly longer, or a part of the recording is lost"
    )]
    NotFlown {
        /// The leg's start.
        start_s: f64,
        /// The leg's end.
        end_s: f64,
        /// The last sample before the part, or the leg's start.
        from_s: f64,
        /// The first sample after the part, or the leg's end.
        to_s: f64,
    },
}

const HEADING_BAND_DEG: f64 = 2.0;
const ALTITUDE_BAND_FT: f64 = 10.0;
/// A leg has a sample in each of its windows of this length.
const HEADING_WINDOW_S: f64 = 3.0;
const ALTITUDE_WINDOW_S: f64 = 8.0;
/// Rounding of sums of periods: a leg's end is met within this.
pub(crate) const ROUNDING_S: f64 = 1e-6;

/// Scores a flight: samples in ascending time, one score per leg.
///
/// # Errors
/// When a leg was not flown to its end.
pub fn score(samples: &[Sample], legs: &[Leg]) -> Result<FlightScore, ScoreError> {
    let legs = legs
        .iter()
        .enumerate()
        .map(|(index, leg)| score_leg(samples, leg, index + 1))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(FlightScore::of(legs))
}

/// What a score is computed from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScoredBy {
    /// The true state of the simulated aircraft.
    Truth,
    /// The measurements of its sensors.
    Measurement,
}

impl FlightScore {
    /// From the scores of legs.
    pub fn of(legs: Vec<LegScore>) -> Self {
        let worst = legs.iter().copied().reduce(LegScore::worst);
        let worst = worst.map(|worst| LegScore {
            number: None,
            ..worst
        });
        Self { legs, worst }
    }
}

impl LegScore {
    fn worst(self, other: Self) -> Self {
        let later = |a: Option<f64>, b: Option<f64>| Some(a?.max(b?));
        Self {
            number: None,
            heading_settle_s: later(self.heading_settle_s, other.heading_settle_s),
            heading_overshoot_deg: self.heading_overshoot_deg.max(other.heading_overshoot_deg),
            heading_rms_deg: self.heading_rms_deg.max(other.heading_rms_deg),
            altitude_settle_s: later(self.altitude_settle_s, other.altitude_settle_s),
            altitude_overshoot_ft: self.altitude_overshoot_ft.max(other.altitude_overshoot_ft),
            altitude_rms_ft: self.altitude_rms_ft.max(other.altitude_rms_ft),
            turn_loss_ft: self.turn_loss_ft.max(other.turn_loss_ft),
            airspeed_error_kt: self.airspeed_error_kt.max(other.airspeed_error_kt),
            lateral_acceleration_g: self
                .lateral_acceleration_g
                .max(other.lateral_acceleration_g),
        }
    }
}

fn score_leg(samples: &[Sample], leg: &Leg, number: usize) -> Result<LegScore, ScoreError> {
    let from = samples.partition_point(|s| s.time_s < leg.start_s - ROUNDING_S);
    let to = samples.partition_point(|s| s.time_s < leg.end_s - ROUNDING_S);
    let flown = samples.get(from..to).unwrap_or_default();
    let mut from_s = leg.start_s;
    for to_s in flown.iter().map(|s| s.time_s).chain([leg.end_s]) {
        if to_s - from_s >= HEADING_WINDOW_S {
            return Err(ScoreError::NotFlown {
                start_s: leg.start_s,
                end_s: leg.end_s,
                from_s,
                to_s,
            });
        }
        from_s = to_s;
    }

    let heading: Vec<(f64, f64)> = flown
        .iter()
        .map(|s| (s.time_s, wrap_degrees(s.heading_deg - leg.heading_deg)))
        .collect();
    let altitude: Vec<(f64, f64)> = flown
        .iter()
        .map(|s| (s.time_s, s.altitude_ft - leg.altitude_ft))
        .collect();
    let floor_ft = leg.altitude_from_ft.min(leg.altitude_ft);
    let largest =
        |of: fn(&Sample, &Leg) -> f64| flown.iter().map(|s| of(s, leg).abs()).fold(0.0, f64::max);
    Ok(LegScore {
        number: Some(number),
        heading_settle_s: settle(&heading, HEADING_BAND_DEG, leg),
        heading_overshoot_deg: overshoot(
            &heading,
            wrap_degrees(leg.heading_deg - leg.heading_from_deg),
        ),
        heading_rms_deg: rms_at_end(&heading, HEADING_WINDOW_S, leg),
        altitude_settle_s: settle(&altitude, ALTITUDE_BAND_FT, leg),
        altitude_overshoot_ft: overshoot(&altitude, leg.altitude_ft - leg.altitude_from_ft),
        altitude_rms_ft: rms_at_end(&altitude, ALTITUDE_WINDOW_S, leg),
        turn_loss_ft: flown
            .iter()
            .map(|s| floor_ft - s.altitude_ft)
            .fold(0.0, f64::max),
        airspeed_error_kt: largest(|s, leg| s.airspeed_kt - leg.airspeed_kt),
        lateral_acceleration_g: largest(|s, _| s.lateral_g),
    })
}

/// Time after the leg's start from which the error stays within the band.
fn settle(errors: &[(f64, f64)], band: f64, leg: &Leg) -> Option<f64> {
    let settled = errors
        .iter()
        .rposition(|(_, error)| error.abs() > band)
        .map_or(0, |last_outside| last_outside + 1);
    errors
        .get(settled)
        .map(|(time_s, _)| (time_s - leg.start_s).max(0.0))
}

fn overshoot(errors: &[(f64, f64)], change: f64) -> f64 {
    let past = |error: f64| {
        if change == 0.0 {
            error.abs()
        } else {
            error * change.signum()
        }
    };
    errors
        .iter()
        .map(|(_, error)| past(*error))
        .fold(0.0, f64::max)
}

fn rms_at_end(errors: &[(f64, f64)], window_s: f64, leg: &Leg) -> f64 {
    let last = errors
        .iter()
        .filter(|(time_s, _)| leg.end_s - time_s <= window_s + ROUNDING_S);
    let (count, sum) = last.fold((0_u32, 0.0), |(count, sum), (_, error)| {
        (count + 1, sum + error * error)
    });
    (sum / f64::from(count)).sqrt()
}

/// The angle in -180..180.
fn wrap_degrees(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}

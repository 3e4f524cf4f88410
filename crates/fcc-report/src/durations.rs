//! What takes time in a tick, and how old the measurements are.

use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{StageTimes, Time};
use serde::Serialize;

use super::spread::{Percentiles, Spread};
use fcc_telemetry::FlightRecord;

/// Percentiles of one stage's time or of one measurement's age.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct NamedPercentiles {
    /// Which stage or measurement.
    pub name: &'static str,
    /// Its times or ages.
    #[serde(flatten)]
    pub of: Percentiles,
}

type StageTime = fn(&StageTimes) -> u64;

/// In the order of a tick.
const STAGES: [(&str, StageTime); 6] = [
    ("sensors", |stages| stages.sensors_ns),
    ("estimate", |stages| stages.estimate_ns),
    ("guide", |stages| stages.guide_ns),
    ("control", |stages| stages.control_ns),
    ("actuators", |stages| stages.actuators_ns),
    ("whole tick", |stages| stages.total_ns),
];

type Taken = fn(&Measurements) -> Time;

/// In the order of a record.
const MEASUREMENTS: [(&str, Taken); 12] = [
    ("attitude", |m| m.attitude.taken),
    ("heading", |m| m.heading_rad.taken),
    ("body rates", |m| m.body_rates.taken),
    ("specific force", |m| m.specific_force.taken),
    ("airspeed", |m| m.airspeed_mps.taken),
    ("altitude", |m| m.altitude_m.taken),
    ("angle of attack", |m| m.angle_of_attack_rad.taken),
    ("position", |m| m.position.taken),
    ("ground velocity", |m| m.velocity.taken),
    ("surfaces", |m| m.surfaces.taken),
    ("engage switch", |m| m.engage_switch.taken),
    ("simulator's clock", |m| m.plant.taken),
];

/// Counts the times of all stages and the ages of all measurements.
#[derive(Clone, Debug, Default)]
pub(super) struct Durations {
    stages: [Spread; STAGES.len()],
    ages: [Spread; MEASUREMENTS.len()],
}

impl Durations {
    pub(super) fn record(&mut self, record: &FlightRecord) {
        for ((_, time_ns), spread) in STAGES.iter().zip(&mut self.stages) {
            let time_ns = time_ns(&record.stages);
            // A stage that was left out took no time, and tells nothing.
            if time_ns > 0 {
                spread.record(time_ns);
            }
        }
        for ((_, taken), spread) in MEASUREMENTS.iter().zip(&mut self.ages) {
            let taken = taken(&record.measurements);
            if !taken.is_never() {
                let age: Duration = record.tick.woke.since(taken);
                spread.record(u64::try_from(age.as_nanos()).unwrap_or(u64::MAX));
            }
        }
    }

    /// Of the stages that were timed, in the order of a tick.
    pub(super) fn stages(&self) -> Vec<NamedPercentiles> {
        named(STAGES.iter().map(|(name, _)| *name), &self.stages)
    }

    /// Of what was ever measured: how old it was when the loop woke.
    pub(super) fn ages(&self) -> Vec<NamedPercentiles> {
        named(MEASUREMENTS.iter().map(|(name, _)| *name), &self.ages)
    }
}

fn named<'a>(
    names: impl Iterator<Item = &'static str>,
    spreads: impl IntoIterator<Item = &'a Spread>,
) -> Vec<NamedPercentiles> {
    names
        .zip(spreads)
        .filter_map(|(name, spread)| {
            let of = spread.percentiles()?;
            Some(NamedPercentiles { name, of })
        })
        .collect()
}

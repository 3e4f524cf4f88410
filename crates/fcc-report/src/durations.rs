//! How long the stages of a tick take, and how old the measurements are.

use fcc_core::framework::{Readings, Record, Stage};
use serde::Serialize;

use super::spread::{Percentiles, Spread};

/// Percentiles of one stage's time or of one measurement's age.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct NamedPercentiles {
    /// Which stage or measurement.
    pub name: String,
    /// Its times or ages.
    #[serde(flatten)]
    pub of: Percentiles,
}

/// In the order of a tick.
const STAGES: [Stage; 6] = [
    Stage::Sensors,
    Stage::Estimate,
    Stage::Guide,
    Stage::Control,
    Stage::Actuators,
    Stage::Tick,
];

/// Counts the times of all stages and the ages of all readings.
#[derive(Clone, Debug, Default)]
pub(super) struct Durations {
    stages: [Spread; STAGES.len()],
    ages: Vec<Spread>,
}

impl Durations {
    pub(super) fn record<M: Readings, E, S, O>(&mut self, record: &Record<M, E, S, O>) {
        for (stage, spread) in STAGES.into_iter().zip(&mut self.stages) {
            let time_ns = record.stages.of(stage);
            // A stage that was left out took no time.
            if time_ns > 0 {
                spread.record(time_ns);
            }
        }
        self.ages.resize_with(M::NAMES.len(), Spread::default);
        let mut ages = self.ages.iter_mut();
        record.measurements.each_source(&mut |_, taken| {
            if let Some(age) = ages.next().filter(|_| !taken.is_never()) {
                let age_ns = record.tick.woke.since(taken).as_nanos();
                age.record(u64::try_from(age_ns).unwrap_or(u64::MAX));
            }
        });
    }

    /// The stages that were measured, in the order of a tick.
    pub(super) fn stages(&self) -> Vec<NamedPercentiles> {
        named(&self.stages, |place| match STAGES.get(place) {
            Some(Stage::Tick) | None => "whole tick".to_owned(),
            Some(stage) => stage.to_string(),
        })
    }

    /// Ages of the measurements when the loop woke; readings that were never
    /// measured are left out.
    pub(super) fn ages(&self, names: &[&str]) -> Vec<NamedPercentiles> {
        named(&self.ages, |place| {
            names.get(place).copied().unwrap_or_default().to_owned()
        })
    }
}

fn named(spreads: &[Spread], name: impl Fn(usize) -> String) -> Vec<NamedPercentiles> {
    let spreads = spreads.iter().enumerate();
    spreads
        .filter_map(|(place, spread)| {
            let of = spread.percentiles()?;
            Some(NamedPercentiles {
                name: name(place),
                of,
            })
        })
        .collect()
}

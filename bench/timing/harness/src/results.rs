//! All results, round by round, and their medians.

use serde::{Deserialize, Serialize};

use crate::load::Load;
use crate::peer::Peer;
use crate::stats::{Figures, Spread, median};

/// One run of one peer.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub(crate) struct Run {
    pub(crate) round: u32,
    pub(crate) load: Load,
    pub(crate) rate_hz: u32,
    pub(crate) peer: Peer,
    /// Policy and priority that the kernel read back.
    pub(crate) scheduling: String,
    pub(crate) figures: Figures,
}

/// All runs, and the machine.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub(crate) struct Results {
    /// Kernel, processor and clock source.
    pub(crate) machine: String,
    /// Of each run, without its warm-up.
    pub(crate) seconds: f64,
    pub(crate) rounds: u32,
    pub(crate) runs: Vec<Run>,
}

/// The rounds of one peer under one load at one rate.
pub(crate) struct Case<'a> {
    pub(crate) load: Load,
    pub(crate) rate_hz: u32,
    pub(crate) peer: Peer,
    pub(crate) runs: Vec<&'a Run>,
}

impl Results {
    /// Load by load, rate by rate, in the order in which they were first run.
    pub(crate) fn cases(&self) -> Vec<Case<'_>> {
        let mut cases: Vec<Case<'_>> = Vec::new();
        for run in &self.runs {
            let known = cases.iter_mut().find(|case| {
                (case.load, case.rate_hz, case.peer) == (run.load, run.rate_hz, run.peer)
            });
            match known {
                Some(case) => case.runs.push(run),
                None => cases.push(Case {
                    load: run.load,
                    rate_hz: run.rate_hz,
                    peer: run.peer,
                    runs: vec![run],
                }),
            }
        }
        cases
    }
}

impl Case<'_> {
    /// The median over the rounds of one figure.
    pub(crate) fn median(&self, figure: impl Fn(&Figures) -> f64) -> f64 {
        median(self.runs.iter().map(|run| figure(&run.figures)).collect())
    }

    /// The median over the rounds, percentile by percentile.
    pub(crate) fn spread(&self, of: impl Fn(&Figures) -> Spread) -> Spread {
        Spread {
            p50: self.median(|figures| of(figures).p50),
            p99: self.median(|figures| of(figures).p99),
            p99_9: self.median(|figures| of(figures).p99_9),
            max: self.median(|figures| of(figures).max),
        }
    }
}

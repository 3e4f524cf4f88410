//! The plans that replaced the first one in flight.

use fcc_fixed_wing::Setpoints;
use fcc_record::timestamp;
use serde::Serialize;

/// At most this many are listed.
const MOST: usize = 100;

/// The plans that replaced the first one, in their order.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub struct ReplacedPlans {
    plans: Vec<ReplacedPlan>,
    /// Of the last record.
    #[serde(skip)]
    last: Option<(u64, u64)>,
}

/// One of them.
#[derive(Clone, Debug, Serialize)]
pub struct ReplacedPlan {
    /// The first 12 digits of its hash.
    pub hash: String,
    /// When it was uploaded (UTC).
    pub uploaded: String,
    /// The first tick with it.
    pub tick: u64,
    /// The same, s since the begin of the recording.
    pub time_s: f64,
}

impl ReplacedPlans {
    pub(super) fn take(&mut self, setpoints: &Setpoints, tick: u64, time_s: f64) {
        let now = (setpoints.plan_hash, setpoints.plan_uploaded_unix_s);
        let before = self.last.replace(now);
        if before.is_some_and(|before| before != now) && self.plans.len() < MOST {
            self.plans.push(ReplacedPlan {
                hash: format!("{:012x}", now.0 >> 16),
                uploaded: timestamp(now.1.saturating_mul(1_000_000_000)),
                tick,
                time_s,
            });
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.plans.is_empty()
    }

    pub(super) fn findings(&self) -> impl Iterator<Item = String> + '_ {
        self.plans.iter().map(|plan| {
            let ReplacedPlan {
                hash,
                uploaded,
                tick,
                time_s,
            } = plan;
            format!(
                "From tick {tick}, {time_s:.1} s, on the flight plan was {hash}, uploaded {uploaded}."
            )
        })
    }
}

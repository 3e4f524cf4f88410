//! What the flight intends, and what ends that: contingencies, failsafe, release, the pilot.

use super::AutopilotConfig;
use super::contingency::{Contingencies, Delayed, Engine};
use super::degraded::Degraded;
use super::following::Following;
use super::ground_contact::ToldOnce;
use super::pilot_takeover::PilotTakeover;
use super::release::Release;
use fcc_guidance::OverGroundMode;
use fcc_guidance::route::TookOff;

/// What the flight intends, and what ends that.
#[derive(Clone, Debug)]
pub(super) struct Supervisor {
    /// The plan that was left for another mode.
    pub(super) left_plan: Option<OverGroundMode>,
    pub(super) took_off: Option<TookOff>,
    pub(super) contingencies: Contingencies,
    /// Whether the battery is low, and the engine out.
    pub(super) battery: Delayed,
    pub(super) engine: Engine,
    pub(super) pilot: PilotTakeover,
    /// A release that is being prepared.
    pub(super) release: Option<Release>,
    pub(super) degraded: Degraded,
    pub(super) following: Following,
    pub(super) told_once: ToldOnce,
}

impl Supervisor {
    pub(super) fn new(config: &AutopilotConfig) -> Self {
        Self {
            left_plan: None,
            took_off: None,
            contingencies: Contingencies::default(),
            battery: Delayed::default(),
            engine: Engine::new(),
            pilot: PilotTakeover::new(config.stick_takeover),
            release: None,
            degraded: Degraded::default(),
            following: Following::default(),
            told_once: ToldOnce::default(),
        }
    }
}

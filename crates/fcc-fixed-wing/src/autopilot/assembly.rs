//! The autopilot's parts, put together by its configuration.

use super::estimator::Estimator;
use super::guidance::GuidanceState;
use super::intake::Intake;
use super::journal::Journal;
use super::loops::Loops;
use super::supervisor::Supervisor;
use super::{Autopilot, AutopilotConfig};
use fcc_navigation::LearnedAirframe;

impl Autopilot {
    /// An autopilot that is not engaged.
    pub fn new(config: AutopilotConfig) -> Self {
        Self {
            intake: Intake::new(),
            estimator: Estimator::new(&config),
            supervisor: Supervisor::new(&config),
            guidance: GuidanceState::new(&config),
            loops: Loops::new(&config),
            journal: Journal::NEW,
            config,
        }
    }

    /// What this flight has learned of the aircraft, as
    /// [`AutopilotConfig::airframe`] of another one takes it; none before a minute with
    /// an airspeed sensor that is believed and a known throttle.
    pub fn learned_airframe(&self) -> Option<LearnedAirframe> {
        self.estimator.navigation.learned_airframe()
    }

    /// The configuration.
    pub const fn config(&self) -> &AutopilotConfig {
        &self.config
    }
}

//! The autopilot's parts, put together by its configuration.

use super::contingency::{Contingencies, Delayed, Engine};
use super::degraded::Degraded;
use super::following::Following;
use super::ground_contact::ToldOnce;
use super::ground_motion::GroundMotion;
use super::intake::Intake;
use super::journal::Journal;
use super::loops::Loops;
use super::pilot_takeover::PilotTakeover;
use super::release::Release;
use super::runway::RunwayControl;
use super::{Autopilot, AutopilotConfig, Capture};
use crate::Setpoints;
use fcc_core::flight::{Altimeter, AltitudeReference};
use fcc_guidance::route::TookOff;
use fcc_guidance::{ActiveMode, OverGroundMode, Targets};
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{FrozenDetector, LearnedAirframe, Navigation, Replacement};

/// Where the aircraft is and how it moves.
#[derive(Clone, Debug)]
pub(super) struct Estimator {
    /// Navigation from raw readings, if it is flown by them.
    pub(super) raw: Option<RawNavigation>,
    pub(super) navigation: Navigation,
    pub(super) replacement: Replacement,
    pub(super) frozen: FrozenDetector,
    /// Where it is over the ground.
    pub(super) ground: GroundMotion,
}

impl Estimator {
    fn new(config: &AutopilotConfig) -> Self {
        Self {
            raw: config.raw_navigation.map(RawNavigation::new),
            navigation: Navigation::new(&config.navigation)
                .for_stall_airspeed(config.envelope.stall_airspeed_mps)
                .for_aircraft(
                    config.reference_airspeed_mps,
                    config.airspeed.throttle_per_mps2,
                )
                .for_learned(config.airframe),
            replacement: Replacement::new(config.navigation.attitude_tau_s),
            frozen: FrozenDetector::new(config.frozen_after.as_secs_f64()),
            ground: if config.raw_navigation.is_some() {
                GroundMotion::default()
            } else {
                GroundMotion::judging(config.envelope.min_airspeed_mps)
            },
        }
    }
}

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
    fn new(config: &AutopilotConfig) -> Self {
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

/// Where to go next.
#[derive(Clone, Debug)]
pub(super) struct GuidanceState {
    pub(super) mode: ActiveMode,
    pub(super) targets: Targets,
    pub(super) capture: Option<Capture>,
    pub(super) altimeter: Altimeter,
    /// What the target altitude refers to.
    pub(super) reference: AltitudeReference,
    pub(super) on_runway: RunwayControl,
    /// Whether the target altitude is limited by the floor.
    pub(super) is_at_floor: bool,
    pub(super) setpoints: Setpoints,
}

impl GuidanceState {
    fn new(config: &AutopilotConfig) -> Self {
        Self {
            mode: ActiveMode::None,
            targets: Targets::default(),
            capture: None,
            altimeter: config.altimeter,
            reference: AltitudeReference::PressureLevel,
            on_runway: RunwayControl::default(),
            is_at_floor: false,
            setpoints: Setpoints::default(),
        }
    }
}

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

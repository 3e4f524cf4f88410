//! The autopilot's parts, put together by its configuration.

use super::{
    ActiveMode, Actuation, AltitudeReference, Autopilot, AutopilotConfig, BankCommand,
    Contingencies, Degraded, Delayed, Engine, Following, GroundMotion, Journal, KeptTrims,
    Measurements, PilotTakeover, PlantClock, ReadingAges, Recovery, RunwayControl, Setpoints,
    StraightTrims, Surfaces, Targets, Time, ToldOnce, Whereabouts,
};
use crate::control::{AirspeedLoop, AltitudeLoop, ElevatorTrim, HeadingLoop};
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{
    FrozenDetector, LearnedAirframe, Navigation, Quantities, Replacement, ReturningAltitude,
};

impl Autopilot {
    /// An autopilot that is not engaged.
    pub fn new(config: AutopilotConfig) -> Self {
        Self {
            raw: config.raw_navigation.map(RawNavigation::new),
            accepted: Measurements::default(),
            navigation: Navigation::new(&config.navigation)
                .for_stall_airspeed(config.envelope.stall_airspeed_mps)
                .for_aircraft(
                    config.reference_airspeed_mps,
                    config.airspeed.throttle_per_mps2,
                )
                .for_learned(config.airframe),
            replacement: Replacement::new(config.navigation.attitude_tau_s),
            frozen: FrozenDetector::new(config.frozen_after.as_secs_f64()),
            guidance: ActiveMode::None,
            ground: if config.raw_navigation.is_some() {
                GroundMotion::default()
            } else {
                GroundMotion::judging(config.envelope.min_airspeed_mps)
            },
            bank: BankCommand::new(config.route.bank_rad, config.route.bank_rate_radps),
            on_runway: RunwayControl::default(),
            left_plan: None,
            took_off: None,
            told_once: ToldOnce::default(),
            contingencies: Contingencies::default(),
            battery: Delayed::default(),
            engine: Engine::new(),
            glides: false,
            journal: Journal::NEW,
            targets: Targets::default(),
            capture: None,
            altimeter: config.altimeter,
            reference: AltitudeReference::PressureLevel,
            heading: HeadingLoop::new(config.heading),
            altitude: AltitudeLoop::new(config.altitude, &config.envelope),
            airspeed: AirspeedLoop::new(config.airspeed),
            actuation: Actuation::new(config.assumed_latency_s, config.pace),
            recovery: Recovery::new(),
            trim: ElevatorTrim::new(None),
            pilot: PilotTakeover::new(config.stick_takeover),
            release: None,
            setpoints: Setpoints::default(),
            clock: PlantClock::default(),
            ages: ReadingAges::default(),
            whereabouts: Whereabouts::default(),
            before: Time::NEVER,
            settled_s: None,
            renewed_since: Time::NEVER,
            last: Surfaces::default(),
            kept_trims: KeptTrims::default(),
            straight: StraightTrims::default(),
            degraded: Degraded::default(),
            following: Following::default(),
            distrusted: Quantities::NONE,
            returning_altitude: ReturningAltitude::default(),
            is_at_floor: false,
            config,
        }
    }

    /// What this flight has learned of the aircraft, as
    /// [`AutopilotConfig::airframe`] of another one takes it; none before a minute with
    /// an airspeed sensor that is believed and a known throttle.
    pub fn learned_airframe(&self) -> Option<LearnedAirframe> {
        self.navigation.learned_airframe()
    }

    /// The configuration.
    pub const fn config(&self) -> &AutopilotConfig {
        &self.config
    }
}

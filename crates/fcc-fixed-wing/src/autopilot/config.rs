//! The autopilot's configuration.

use core::time::Duration;

use crate::control::{AirspeedConfig, AltitudeConfig, Envelope, HeadingConfig};
use fcc_core::flight::Altimeter;
use fcc_core::flight::terrain::Terrain;
use fcc_guidance::route::{Route, RouteConfig, RouteSource};
use fcc_guidance::{GuidanceConfig, TimedPatternConfig};
use fcc_navigation::inertial::RawNavigationConfig;
use fcc_navigation::{LearnedAirframe, NavigationConfig};

use super::{ContingencyConfig, FailsafeConfig, StickTakeover};

/// The autopilot's configuration.
///
/// ```
/// use core::time::Duration;
/// use fcc_fixed_wing::AutopilotConfig;
///
/// // A slower sensor, whose readings are valid for half a second.
/// let config = AutopilotConfig {
///     max_age: Duration::from_millis(500),
///     ..AutopilotConfig::default()
/// };
/// // 100 kt.
/// assert!((config.reference_airspeed_mps * 3.6 / 1.852 - 100.0).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AutopilotConfig {
    /// The reference airspeed of the gains, m/s.
    pub reference_airspeed_mps: f64,
    /// The latency from an output to its effect that is assumed until it has
    /// been measured in flight, s.
    pub assumed_latency_s: f64,
    /// The pace of the gains, as [`Scale`](super::Scale) has it: a slower loop
    /// stands more latency.
    pub pace: f64,
    /// Readings older than this count as a loss of their sensor.
    pub max_age: Duration,
    /// If a simulated plant falls silent, so that none of its readings arrives,
    /// its time is taken to stand still for as long as this; no shorter than
    /// `max_age`. Then all of them count as lost.
    pub max_silence: Duration,
    /// Readings that stay the same to the last bit for this long, while others
    /// show that the aircraft moved, are frozen; zero switches the check off.
    pub frozen_after: Duration,
    /// The time that navigation needs to settle before the autopilot can
    /// engage.
    pub settling: Duration,
    /// Whether it may engage in an upset, from which it recovers first.
    pub permits_upset: bool,
    /// When the pilot's controls end the engagement; `None` for never.
    pub stick_takeover: Option<StickTakeover>,
    /// Whether the elevator's trim is moved, where it is measured.
    pub trims: bool,
    /// For how long at most a release that is ours to time levels and trims the
    /// aircraft first; zero for not at all.
    pub level_and_trim: Duration,
    /// How a flight goes on without a sensor, and how it ends.
    pub failsafe: FailsafeConfig,
    /// How attitude and the other quantities that control needs are computed
    /// from raw readings; `None` if sensors measure them.
    pub raw_navigation: Option<RawNavigationConfig>,
    /// What another flight has learned of the aircraft: where no sensor measures the
    /// airspeed, it is flown by forces, motion and the velocity over the ground. `None`:
    /// without an airspeed sensor it does not engage.
    pub airframe: Option<LearnedAirframe>,
    /// Navigation's time constants.
    pub navigation: NavigationConfig,
    /// The mode that is flown once engaged.
    pub guidance: GuidanceConfig,
    /// The flight plan, if there is one.
    pub plan: Option<Route<'static>>,
    /// Where plans are prepared that may replace it.
    pub prepared: RouteSource,
    /// How routes over the ground are flown.
    pub route: RouteConfig,
    /// What is done when a flight cannot go on as commanded.
    pub contingency: ContingencyConfig,
    /// Gains of the heading loop.
    pub heading: HeadingConfig,
    /// Gains of the altitude loop.
    pub altitude: AltitudeConfig,
    /// Gains of the airspeed loop.
    pub airspeed: AirspeedConfig,
    /// The limits of the loops' commands.
    pub envelope: Envelope,
    /// The altimeter; a command changes its setting.
    pub altimeter: Altimeter,
    /// The ground that is watched.
    pub terrain: Terrain<'static>,
}

impl Default for AutopilotConfig {
    /// A Cessna 172 and the thesis' pattern.
    fn default() -> Self {
        Self {
            reference_airspeed_mps: 51.444_444, // 100 kt
            assumed_latency_s: 0.025,
            pace: 1.0,
            max_age: Duration::from_millis(250),
            max_silence: Duration::from_secs(30),
            frozen_after: Duration::from_secs(2),
            settling: Duration::from_secs(1),
            permits_upset: false,
            stick_takeover: None,
            trims: true,
            level_and_trim: Duration::from_secs(10),
            failsafe: FailsafeConfig::default(),
            raw_navigation: None,
            airframe: None,
            navigation: NavigationConfig::default(),
            guidance: GuidanceConfig::TimedPattern(TimedPatternConfig::default()),
            plan: None,
            prepared: RouteSource::default(),
            route: RouteConfig::default(),
            contingency: ContingencyConfig::default(),
            heading: HeadingConfig::default(),
            altitude: AltitudeConfig::default(),
            airspeed: AirspeedConfig::default(),
            envelope: Envelope::default(),
            altimeter: Altimeter::default(),
            terrain: Terrain::default(),
        }
    }
}

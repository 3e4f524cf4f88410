//! The autopilot's configuration.

use core::time::Duration;

use super::Resume;
use crate::flight::control::{AirspeedConfig, AltitudeConfig, Envelope, HeadingConfig};
use crate::flight::guidance::{GuidanceConfig, TimedPatternConfig};
use crate::flight::navigation::NavigationConfig;
use crate::schema;

/// The autopilot's configuration.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::flight::AutopilotConfig;
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
    /// Navigation's time constants.
    pub navigation: NavigationConfig,
    /// The mode that is flown once engaged.
    pub guidance: GuidanceConfig,
    /// Gains of the heading loop.
    pub heading: HeadingConfig,
    /// Gains of the altitude loop.
    pub altitude: AltitudeConfig,
    /// Gains of the airspeed loop.
    pub airspeed: AirspeedConfig,
    /// The limits of the loops' commands.
    pub envelope: Envelope,
}

impl Default for AutopilotConfig {
    /// A Cessna 172 and the thesis' pattern.
    fn default() -> Self {
        Self {
            reference_airspeed_mps: 51.444_444, // 100 kt
            max_age: Duration::from_millis(250),
            max_silence: Duration::from_secs(30),
            frozen_after: Duration::from_secs(2),
            settling: Duration::from_secs(1),
            navigation: NavigationConfig::default(),
            guidance: GuidanceConfig::TimedPattern(TimedPatternConfig::default()),
            heading: HeadingConfig::default(),
            altitude: AltitudeConfig::default(),
            airspeed: AirspeedConfig::default(),
            envelope: Envelope::default(),
        }
    }
}

schema! {
    /// A command to the engaged autopilot. Each but the last changes one set
    /// point, ends a pattern and leaves the other set points unchanged.
    ///
    /// ```
    /// use fcc_core::flight::{Autopilot, AutopilotCommand, AutopilotConfig};
    /// use fcc_core::framework::Controller;
    ///
    /// let mut autopilot = Autopilot::new(AutopilotConfig::default());
    /// autopilot.command(&AutopilotCommand::Altitude(960.12));
    /// // Without being engaged it ignores commands.
    /// assert_eq!(autopilot.setpoints().altitude_m, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug)]
    #[name("Command")]
    #[non_exhaustive]
    pub enum AutopilotCommand {
        /// Indicated airspeed, m/s; limited to the envelope.
        #[field(1)]
        Airspeed(airspeed_mps: f64),
        /// Magnetic heading, rad; the turn takes the shorter way from the
        /// present heading.
        #[field(2)]
        Heading(heading_rad: f64),
        /// Barometric altitude, m.
        #[field(3)]
        Altitude(altitude_m: f64),
        /// Continue what was flown before a restart.
        #[field(4)]
        Resume(resume: Resume),
    }
}

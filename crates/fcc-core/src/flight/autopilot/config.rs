//! Everything about the autopilot that is the user's choice.

use core::time::Duration;

use super::Resume;
use crate::flight::control::{AirspeedConfig, AltitudeConfig, Envelope, HeadingConfig};
use crate::flight::guidance::{GuidanceConfig, TimedPatternConfig};
use crate::flight::navigation::NavigationConfig;
use crate::schema;

/// Everything about the autopilot that is the user's choice.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::flight::AutopilotConfig;
///
/// // A slower sensor, that is still good after half a second.
/// let config = AutopilotConfig {
///     max_age: Duration::from_millis(500),
///     ..AutopilotConfig::default()
/// };
/// // 100 kt.
/// assert!((config.reference_airspeed_mps * 3.6 / 1.852 - 100.0).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AutopilotConfig {
    /// The airspeed at which the gains hold as they are, m/s.
    pub reference_airspeed_mps: f64,
    /// Older readings than this are a loss of their sensor.
    pub max_age: Duration,
    /// Readings that stay the same to the last bit for so long, while others
    /// say that the aircraft moved, are frozen; zero never calls one so.
    pub frozen_after: Duration,
    /// Navigation has to have watched for so long before the autopilot takes
    /// over.
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
    /// What the loops may ask of the aircraft.
    pub envelope: Envelope,
}

impl Default for AutopilotConfig {
    /// A Cessna 172 and the thesis' pattern.
    fn default() -> Self {
        Self {
            reference_airspeed_mps: 51.444_444, // 100 kt
            max_age: Duration::from_millis(250),
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
    /// What may be asked of the autopilot while it is engaged. Each but the last
    /// changes one set point, ends a pattern and keeps the other set points as they
    /// are.
    ///
    /// ```
    /// use fcc_core::flight::{Autopilot, AutopilotCommand, AutopilotConfig};
    /// use fcc_core::framework::Controller;
    ///
    /// let mut autopilot = Autopilot::new(AutopilotConfig::default());
    /// autopilot.command(&AutopilotCommand::Altitude(960.12));
    /// // Not engaged, it flies nothing.
    /// assert_eq!(autopilot.setpoints().altitude_m, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug)]
    #[name("Command")]
    #[non_exhaustive]
    pub enum AutopilotCommand {
        /// Indicated airspeed, m/s; held to what the envelope allows.
        #[field(1)]
        Airspeed(airspeed_mps: f64),
        /// Magnetic heading, rad; turned to the shorter way from where the nose
        /// points now.
        #[field(2)]
        Heading(heading_rad: f64),
        /// Barometric altitude, m.
        #[field(3)]
        Altitude(altitude_m: f64),
        /// Take up what was flown before a restart.
        #[field(4)]
        Resume(resume: Resume),
    }
}

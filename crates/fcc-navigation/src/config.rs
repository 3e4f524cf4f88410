//! The time constants of navigation.

/// Time constants of navigation's channels.
///
/// ```
/// use fcc_navigation::{Navigation, NavigationConfig};
///
/// let smooth = NavigationConfig { airspeed_tau_s: 2.0, ..NavigationConfig::default() };
/// assert_eq!(Navigation::new(&smooth).estimate().airspeed_mps, 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NavigationConfig {
    /// Time constant of the attitude, s: the gyroscopes determine it over
    /// shorter times, the measured pitch and roll over longer times.
    pub attitude_tau_s: f64,
    /// Time constant of the heading, s, likewise.
    pub heading_tau_s: f64,
    /// Bandwidth of the climb rate, rad/s: above it the accelerometers
    /// determine it, below it the barometer.
    pub vertical_bandwidth_radps: f64,
    /// Time constant of the airspeed, s: the accelerometers determine it over
    /// shorter times, the airspeed sensor over longer times.
    pub airspeed_tau_s: f64,
    /// Time constant of the low pass of the side force, s.
    pub side_force_tau_s: f64,
}

impl Default for NavigationConfig {
    fn default() -> Self {
        Self {
            attitude_tau_s: 1.36,
            heading_tau_s: 1.44,
            vertical_bandwidth_radps: 0.68,
            airspeed_tau_s: 0.89,
            side_force_tau_s: 0.19,
        }
    }
}

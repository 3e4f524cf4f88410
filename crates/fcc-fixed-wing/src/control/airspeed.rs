//! Airspeed → throttle.

use super::SURFACE;
use fcc_core::blocks::{LowPass, Pid, PidConfig, limit};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::Estimate;

/// Gains of the airspeed loop.
///
/// ```
/// use fcc_fixed_wing::control::AirspeedConfig;
///
/// // Throttle that accelerates by 1 g, as a configuration file has it.
/// let per_g = AirspeedConfig::default().throttle_per_mps2 * 9.806_65;
/// assert!((per_g - 3.63).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AirspeedConfig {
    /// Commanded acceleration per airspeed error, 1/s.
    pub airspeed_gain_per_s: f64,
    /// The same, integrated, 1/s².
    pub airspeed_integral_gain_per_s2: f64,
    /// Commanded acceleration per acceleration, against it: the phase lead that
    /// the lag of an engine and its propeller needs.
    pub acceleration_gain: f64,
    /// Throttle that accelerates the aircraft, per m/s².
    pub throttle_per_mps2: f64,
    /// Induced drag at 1 g over weight: the additional drag of a turn is this
    /// times (n² - 1).
    pub induced_drag_ratio: f64,
    /// Largest throttle rate, 1/s.
    pub max_throttle_rate_per_s: f64,
    /// Throttle for level flight at the reference airspeed, 0..=1: used at
    /// engagement if the plant does not measure its throttle.
    pub trim_throttle: f64,
}

impl Default for AirspeedConfig {
    fn default() -> Self {
        Self {
            airspeed_gain_per_s: 0.45,
            airspeed_integral_gain_per_s2: 0.045,
            acceleration_gain: 0.3,
            throttle_per_mps2: 0.370_157, // 3.63 per g
            induced_drag_ratio: 0.035,
            max_throttle_rate_per_s: 1.0,
            trim_throttle: 0.65,
        }
    }
}

/// The inputs of the airspeed loop from the other two loops.
///
/// ```
/// use fcc_fixed_wing::control::ThrottleDemand;
///
/// let cruise = ThrottleDemand {
///     airspeed_mps: 51.4,
///     climb_rate_mps: 0.0,
///     load_factor: 1.0,
///     least_throttle: 0.0,
/// };
/// let turn = ThrottleDemand { load_factor: 1.0 / 30.0_f64.to_radians().cos(), ..cruise };
/// assert!((turn.load_factor - 1.155).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ThrottleDemand {
    /// Commanded indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Commanded climb rate, m/s.
    pub climb_rate_mps: f64,
    /// Load factor of the turn.
    pub load_factor: f64,
    /// The least throttle, 0..=1: full if the aircraft is too slow.
    pub least_throttle: f64,
}

/// The acceleration is smoothed by this, s: a fifth of the engine's lag.
const SMOOTHED_S: f64 = 0.2;

/// Airspeed → throttle, with feed-forward of climb and turn.
///
/// An engine with a propeller follows the throttle after 1 to 2 s (manifold
/// pressure, then speed of rotation), and airspeed integrates thrust. So the
/// throttle answers to the acceleration along the flight path, too, as it
/// does to the rate of total energy in Lambregts 1983: the acceleration is
/// that of the accelerometers, in which gusts and sensor noise are less than
/// in the airspeed's derivative.
///
/// ```
/// use fcc_fixed_wing::control::{AirspeedConfig, AirspeedLoop, ThrottleDemand};
/// use fcc_navigation::Estimate;
///
/// let level = Estimate {
///     airspeed_mps: 51.4,
///     true_airspeed_mps: 53.8,
///     altitude_m: 914.4,
///     ..Estimate::default()
/// };
/// let demand = ThrottleDemand {
///     airspeed_mps: 51.4,
///     climb_rate_mps: 0.0,
///     load_factor: 1.0,
///     least_throttle: 0.0,
/// };
/// let mut airspeed = AirspeedLoop::new(AirspeedConfig::default());
/// airspeed.engage(0.65, &demand, &level);
/// // Engaged at the present throttle; a knot too slow gives more throttle.
/// assert!((airspeed.step(&demand, &level, 0.025) - 0.65).abs() < 1e-9);
/// let slow = Estimate { airspeed_mps: 50.9, ..level };
/// assert!(airspeed.clone().step(&demand, &slow, 0.025) > 0.65);
/// // One that accelerates gets less.
/// let accelerates = Estimate { acceleration_mps2: 1.0, ..level };
/// assert!(airspeed.step(&demand, &accelerates, 0.025) < 0.65);
/// ```
#[derive(Clone, Debug)]
pub struct AirspeedLoop {
    config: AirspeedConfig,
    throttle: Pid,
    acceleration: LowPass,
}

impl AirspeedLoop {
    /// A loop that is not engaged.
    pub const fn new(config: AirspeedConfig) -> Self {
        Self {
            config,
            throttle: Pid::new(PidConfig {
                kp: config.airspeed_gain_per_s * config.throttle_per_mps2,
                ki: config.airspeed_integral_gain_per_s2 * config.throttle_per_mps2,
                output_min: 0.0,
                output_rate_per_s: config.max_throttle_rate_per_s,
                ..SURFACE
            }),
            acceleration: LowPass::new(SMOOTHED_S),
        }
    }

    /// Engages with the present throttle.
    pub fn engage(&mut self, throttle: f64, demand: &ThrottleDemand, estimate: &Estimate) {
        self.restart(estimate);
        let feed_forward = self.feed_forward(demand, estimate, 0.0);
        self.throttle.engage(
            throttle,
            demand.airspeed_mps,
            estimate.airspeed_mps,
            feed_forward,
            1.0,
        );
    }

    /// Continues with the present motion of the aircraft, and with the throttle found
    /// before.
    pub(crate) const fn restart(&mut self, estimate: &Estimate) {
        self.acceleration.reset(estimate.acceleration_mps2);
    }

    /// Performs one step; returns the throttle, 0..=1.
    pub fn step(&mut self, demand: &ThrottleDemand, estimate: &Estimate, dt_s: f64) -> f64 {
        let feed_forward = self.feed_forward(demand, estimate, dt_s);
        let throttle = self.throttle.step_scheduled(
            demand.airspeed_mps,
            estimate.airspeed_mps,
            feed_forward,
            1.0,
            dt_s,
        );
        throttle.max(demand.least_throttle)
    }

    /// The throttle that the loop has found for level flight, 0..=1.
    pub fn trim(&self) -> f64 {
        limit(self.throttle.integral(), 0.0, 1.0)
    }

    /// A climb needs g sin γ, a turn the additional induced drag; against the
    /// present acceleration.
    fn feed_forward(&mut self, demand: &ThrottleDemand, estimate: &Estimate, dt_s: f64) -> f64 {
        let speed = estimate.true_airspeed_mps.max(1.0);
        let climb = GRAVITY_MPS2 * demand.climb_rate_mps / speed;
        let turn = GRAVITY_MPS2
            * self.config.induced_drag_ratio
            * (demand.load_factor * demand.load_factor - 1.0);
        let accelerates = self.config.acceleration_gain
            * self.acceleration.step(estimate.acceleration_mps2, dt_s);
        self.config.throttle_per_mps2 * (climb + turn - accelerates)
    }
}

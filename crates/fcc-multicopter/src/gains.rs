//! Gains from one figure: the delay of control.

use libm::sqrt;
use nalgebra::Vector3;

use crate::airframe::{Airframe, Refusal};

/// Displacement by a gust that accelerates by 1 m/s², m: more cannot be called flown.
const MOST_DISPLACED_M: f64 = 1.0;

/// The gains of the cascade.
///
/// A loop around an integrator with a delay θ has the gain 1/(2θ), answers like a lag of 2θ,
/// and its integral time is 8θ (SIMC with τc = θ; Skogestad 2003, table 1). Each loop is the
/// delay of the next one, so the gains are 1/2θ, 1/4θ, 1/8θ and 1/16θ.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gains {
    /// θ: motors as far as they are not led, sensors and the loop's period, s.
    pub delay_s: f64,
    /// Angular acceleration per rate, 1/s; of yaw the half.
    pub rate: f64,
    /// Of the rate's integral, 1/s².
    pub rate_integral: f64,
    /// Rate per angle of roll and pitch, 1/s; of yaw the half.
    pub attitude: f64,
    /// Acceleration per velocity north, east and down, 1/s.
    pub velocity: Vector3<f64>,
    /// Of the velocity's integral, 1/s².
    pub velocity_integral: Vector3<f64>,
    /// Velocity per position, 1/s.
    pub position: Vector3<f64>,
}

impl Gains {
    /// The gains of an airframe in a loop of a period, with measurements of an age, s.
    ///
    /// # Errors
    /// When a gust would displace it by more than a metre: the displacement is 1/(position
    /// gain · velocity gain) = 128 θ² for 1 m/s².
    pub fn of(airframe: &Airframe, period_s: f64, latency_s: f64) -> Result<Self, Refusal> {
        let delay_s = airframe.led_lag_s() + latency_s + period_s;
        // Thrust is not led.
        let climb_delay_s = airframe.motor_lag_s + latency_s + period_s;
        let longest_s = sqrt(MOST_DISPLACED_M / 128.0);
        if delay_s.is_nan() || delay_s <= 0.0 || delay_s > longest_s {
            return Err(Refusal::TooSlow { delay_s, longest_s });
        }
        let rate = 0.5 / delay_s;
        let sideways = 0.125 / delay_s;
        let velocity = Vector3::new(sideways, sideways, 0.35 / climb_delay_s);
        Ok(Self {
            delay_s,
            rate,
            rate_integral: rate / (8.0 * delay_s),
            attitude: 0.25 / delay_s,
            velocity,
            velocity_integral: velocity / (32.0 * delay_s),
            position: 0.5 * velocity,
        })
    }
}

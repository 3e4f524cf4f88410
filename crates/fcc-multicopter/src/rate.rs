//! Turn rates: from rates to angular accelerations.

use nalgebra::Vector3;

use crate::airframe::Airframe;
use crate::gains::Gains;

/// Of the integral, rad/s²: trims what a displaced load or a weak motor does.
const MOST_INTEGRAL_RADPS2: f64 = 20.0;

/// Proportional and integral control of turn rates. Its gain is one over time: the inertia is
/// in the allocation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct RateLoop {
    gain: Vector3<f64>,
    integral_gain: Vector3<f64>,
    integral_radps2: Vector3<f64>,
    /// Of the motors, s, and what is left of it.
    lag_s: f64,
    led_lag_s: f64,
    /// What is demanded, as late as the led motors give it.
    given_radps2: Vector3<f64>,
}

impl RateLoop {
    pub(crate) fn new(gains: &Gains, airframe: &Airframe) -> Self {
        // Yaw has a tenth of the others' torque, and is not to use it up on noise.
        let axes = Vector3::new(1.0, 1.0, 0.5);
        Self {
            gain: axes * gains.rate,
            integral_gain: axes * gains.rate_integral,
            integral_radps2: Vector3::zeros(),
            lag_s: airframe.motor_lag_s,
            led_lag_s: airframe.led_lag_s(),
            given_radps2: Vector3::zeros(),
        }
    }

    pub(crate) fn reset(&mut self) {
        self.integral_radps2 = Vector3::zeros();
        self.given_radps2 = Vector3::zeros();
    }

    /// The angular acceleration, rad/s², that leads to the wanted rates; `missing` is what was
    /// not allocated last: the integral does not grow towards it. With `learns` false it stays.
    pub(crate) fn step(
        &mut self,
        wanted_radps: &Vector3<f64>,
        rates_radps: &Vector3<f64>,
        missing_radps2: &Vector3<f64>,
        learns: bool,
        dt_s: f64,
    ) -> Vector3<f64> {
        let error = wanted_radps - rates_radps;
        let growth = self.integral_gain.component_mul(&error) * dt_s;
        let axes = self.integral_radps2.iter_mut().zip(growth.iter());
        for ((integral, growth), missing) in axes.zip(missing_radps2.iter()) {
            if learns && (growth * missing <= 0.0 || missing.abs() < 1e-6) {
                *integral = (*integral + growth).clamp(-MOST_INTEGRAL_RADPS2, MOST_INTEGRAL_RADPS2);
            }
        }
        let wanted = self.gain.component_mul(&error) + self.integral_radps2;
        // (1 + lag s)/(1 + led lag s), so that a slow motor answers like a faster one.
        let late = wanted - self.given_radps2;
        self.given_radps2 += late * (dt_s / (self.led_lag_s + dt_s));
        wanted + (wanted - self.given_radps2) * (self.lag_s / self.led_lag_s - 1.0)
    }
}

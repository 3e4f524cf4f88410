//! PID controller.

use super::{limit, limit_abs, smoothing_factor};

/// Prevents the integral from growing while the output is saturated.
///
/// ```
/// use fcc_core::blocks::{AntiWindup, Pid, PidConfig};
///
/// let mut valve = Pid::new(PidConfig {
///     ki: 1.0,
///     output_min: -1.0,
///     output_max: 1.0,
///     anti_windup: AntiWindup::BackCalculation { tracking_tau_s: 0.1 },
///     ..PidConfig::default()
/// });
/// // An error of 10 for 10 s with the output saturated: 100 without anti-windup.
/// for _ in 0..400 {
///     valve.step(10.0, 0.0, 0.025);
/// }
/// assert!(valve.integral() < 2.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum AntiWindup {
    /// The integral is held while it would increase the saturation.
    Clamping,
    /// The integral is reduced by the excess over the limits, with this time
    /// constant in s (Åström and Hägglund 1995, section 3.5).
    BackCalculation {
        /// Tracking time constant, s; positive.
        tracking_tau_s: f64,
    },
}

/// Gains and limits of a [`Pid`]. `kp` is output per error, `ki` output per
/// error and second, `kd` output per error per second.
///
/// ```
/// use fcc_core::blocks::{Pid, PidConfig};
///
/// // Proportional only: other gains are zero and there are no limits by default.
/// let mut rudder = Pid::new(PidConfig { kp: 0.5, ..PidConfig::default() });
/// assert_eq!(rudder.step(3.0, 1.0, 0.025), 1.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PidConfig {
    /// Proportional gain.
    pub kp: f64,
    /// Integral gain, 1/s.
    pub ki: f64,
    /// Derivative gain, s; it acts on the measurement, so that a step of the
    /// set point causes no derivative kick.
    pub kd: f64,
    /// Time constant of the derivative's low pass, s; 0 for none.
    pub derivative_tau_s: f64,
    /// Smallest output.
    pub output_min: f64,
    /// Largest output.
    pub output_max: f64,
    /// Largest rate of the output, units/s; infinite for none.
    pub output_rate_per_s: f64,
    /// The anti-windup method.
    pub anti_windup: AntiWindup,
}

impl Default for PidConfig {
    /// All gains zero, no limits, clamping.
    fn default() -> Self {
        Self {
            kp: 0.0,
            ki: 0.0,
            kd: 0.0,
            derivative_tau_s: 0.0,
            output_min: f64::NEG_INFINITY,
            output_max: f64::INFINITY,
            output_rate_per_s: f64::INFINITY,
            anti_windup: AntiWindup::Clamping,
        }
    }
}

/// PID controller with derivative on measurement, anti-windup, limits on the
/// output and its rate, feed-forward, and bumpless transfer.
///
/// The integral is kept in units of the output, so changing a gain while it runs
/// does not make the output jump.
///
/// ```
/// use fcc_core::blocks::{Pid, PidConfig};
/// let mut heater = Pid::new(PidConfig {
///     kp: 0.5,
///     ki: 0.1,
///     output_min: 0.0,
///     output_max: 1.0,
///     ..PidConfig::default()
/// });
/// let power = heater.step(21.0, 20.0, 0.025);
/// assert!((power - (0.5 + 0.1 * 0.025)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    config: PidConfig,
    integral: f64,
    derivative: f64,
    last_measurement: Option<f64>,
    last_output: Option<f64>,
}

impl Pid {
    /// A controller in its initial state.
    pub const fn new(config: PidConfig) -> Self {
        Self {
            config,
            integral: 0.0,
            derivative: 0.0,
            last_measurement: None,
            last_output: None,
        }
    }

    /// Bumpless transfer from a present output: the next step with the same set
    /// point, measurement, feed-forward and gain scale yields this output.
    pub fn engage(
        &mut self,
        output: f64,
        setpoint: f64,
        measurement: f64,
        feed_forward: f64,
        gain_scale: f64,
    ) {
        let output = self.limit(output);
        let proportional = gain_scale * self.config.kp * (setpoint - measurement);
        self.integral = output - proportional - feed_forward;
        self.derivative = 0.0;
        self.last_measurement = Some(measurement);
        self.last_output = Some(output);
    }

    /// Performs one step; returns the output.
    pub fn step(&mut self, setpoint: f64, measurement: f64, dt_s: f64) -> f64 {
        self.step_scheduled(setpoint, measurement, 0.0, 1.0, dt_s)
    }

    /// Performs one step with a feed-forward (units of the output) and with all
    /// gains multiplied by `gain_scale`, for plants whose response changes in a
    /// known way; returns the output.
    pub fn step_scheduled(
        &mut self,
        setpoint: f64,
        measurement: f64,
        feed_forward: f64,
        gain_scale: f64,
        dt_s: f64,
    ) -> f64 {
        let config = &self.config;
        let error = setpoint - measurement;
        if dt_s > 0.0 {
            let slope = self
                .last_measurement
                .map_or(0.0, |last| (measurement - last) / dt_s);
            let alpha = smoothing_factor(dt_s, config.derivative_tau_s);
            self.derivative += alpha * (slope - self.derivative);
            self.last_measurement = Some(measurement);
        }
        let direct = feed_forward + gain_scale * (config.kp * error - config.kd * self.derivative);
        let increment = gain_scale * config.ki * error * dt_s.max(0.0);
        let wanted = direct + self.integral + increment;
        let output = self.limit_rate(self.limit(wanted), dt_s);
        match self.config.anti_windup {
            AntiWindup::Clamping => {
                let excess = wanted - output;
                if excess * increment <= 0.0 {
                    self.integral += increment;
                }
            }
            AntiWindup::BackCalculation { tracking_tau_s } => {
                let back = smoothing_factor(dt_s, tracking_tau_s) * (output - wanted);
                self.integral += increment + back;
            }
        }
        self.last_output = Some(output);
        output
    }

    /// Changes the limits of the output. An output beyond them is limited in the
    /// next step, and the integral does not grow towards them.
    pub const fn set_output_limits(&mut self, min: f64, max: f64) {
        self.config.output_min = min;
        self.config.output_max = max;
    }

    /// The output that is nearest within the limits.
    pub fn limited(&self, output: f64) -> f64 {
        self.limit(output)
    }

    /// The integral, in units of the output.
    pub const fn integral(&self) -> f64 {
        self.integral
    }

    fn limit(&self, output: f64) -> f64 {
        limit(output, self.config.output_min, self.config.output_max)
    }

    fn limit_rate(&self, output: f64, dt_s: f64) -> f64 {
        match self.last_output {
            Some(last) if self.config.output_rate_per_s.is_finite() => {
                let most = self.config.output_rate_per_s * dt_s.max(0.0);
                last + limit_abs(output - last, most)
            }
            _ => output,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pi(anti_windup: AntiWindup) -> Pid {
        Pid::new(PidConfig {
            kp: 1.0,
            ki: 1.0,
            output_min: -1.0,
            output_max: 1.0,
            anti_windup,
            ..PidConfig::default()
        })
    }

    /// Closed loop on ẋ = (u - x)/T with PI where ki = kp/T cancels the pole:
    /// the step response is 1 - exp(-kp t/T) (a textbook first-order loop).
    #[test]
    fn pole_cancellation_gives_the_textbook_step_response() {
        let (time_constant, kp, dt) = (2.0, 4.0, 1e-4);
        let mut pid = Pid::new(PidConfig {
            kp,
            ki: kp / time_constant,
            ..PidConfig::default()
        });
        let mut x = 0.0;
        for n in 1..=20_000 {
            let u = pid.step(1.0, x, dt);
            x += (u - x) / time_constant * dt;
            let t = f64::from(n) * dt;
            let exact = 1.0 - libm::exp(-kp * t / time_constant);
            assert!((x - exact).abs() < 2e-4, "at {t}: {x} against {exact}");
        }
    }

    #[test]
    fn a_step_of_the_set_point_causes_no_derivative_kick() {
        let config = PidConfig {
            kd: 10.0,
            ..PidConfig::default()
        };
        let mut pid = Pid::new(config);
        pid.step(0.0, 1.0, 0.025);
        assert_eq!(pid.step(5.0, 1.0, 0.025), 0.0);
        // A ramp of the measurement of 0.4/s gives -kd * 0.4.
        assert!((pid.step(5.0, 1.01, 0.025) + 4.0).abs() < 1e-9);
    }

    #[test]
    fn the_integral_does_not_wind_up() {
        for (kind, most) in [
            (AntiWindup::Clamping, 0.05),
            (
                AntiWindup::BackCalculation {
                    tracking_tau_s: 0.5,
                },
                0.6,
            ),
        ] {
            let mut pid = pi(kind);
            for _ in 0..4_000 {
                assert!(pid.step(10.0, 0.0, 0.025) <= 1.0);
            }
            // 100 s of saturation without anti-windup would give 1,000.
            let mut steps = 0;
            while pid.step(-0.5, 0.0, 0.025) >= 1.0 {
                steps += 1;
                assert!(f64::from(steps) * 0.025 < most, "{kind:?} winds up");
            }
        }
    }

    #[test]
    fn the_transfer_is_bumpless() {
        let mut pid = pi(AntiWindup::Clamping);
        pid.engage(0.63, 3.0, 2.9, 0.2, 1.8);
        let output = pid.step_scheduled(3.0, 2.9, 0.2, 1.8, 0.0);
        assert!((output - 0.63).abs() < 1e-12);
    }

    #[test]
    fn the_output_is_limited_in_rate() {
        let mut pid = Pid::new(PidConfig {
            kp: 100.0,
            output_rate_per_s: 2.0,
            ..PidConfig::default()
        });
        pid.engage(0.0, 0.0, 0.0, 0.0, 1.0);
        assert!((pid.step(1.0, 0.0, 0.025) - 0.05).abs() < 1e-12);
        assert!((pid.step(1.0, 0.0, 0.025) - 0.10).abs() < 1e-12);
    }

    #[test]
    fn a_step_of_no_duration_changes_nothing() {
        let mut pid = pi(AntiWindup::Clamping);
        pid.engage(0.1, 0.0, 0.0, 0.0, 1.0);
        let before = pid.integral();
        pid.step(1.0, 0.0, 0.0);
        assert_eq!(pid.integral(), before);
    }
}

//! PID controller.

use fcc_core::blocks::{AntiWindup, Pid, PidConfig};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::{not_negative, passed_s, positive};
use crate::arguments::finite;

/// PID controller with derivative on measurement, anti-windup, limits of the
/// output and its rate, feed-forward, and bumpless engagement.
///
/// `kp` is output per error, `ki` output per error and second, `kd` output per
/// error per second; `derivative_tau_s` is the time constant of the
/// derivative's low pass. In a limit the integral is held, or, if
/// `tracking_tau_s` is given, reduced with that time constant (Åström and
/// Hägglund 1995, section 3.5).
///
/// >>> pid = fcc.Pid(2.0, output_max=1.0)
/// >>> round(pid.step(1.0, 0.8, 0.1), 3), pid.step(5.0, 0.8, 0.1)
/// (0.4, 1.0)
#[pyclass(name = "Pid", module = "fcc")]
pub(crate) struct PyPid(Pid);

#[pymethods]
impl PyPid {
    #[new]
    #[pyo3(signature = (kp = 0.0, ki = 0.0, kd = 0.0, *, derivative_tau_s = 0.0,
        output_min = f64::NEG_INFINITY, output_max = f64::INFINITY,
        output_rate_per_s = f64::INFINITY, tracking_tau_s = None))]
    #[expect(clippy::too_many_arguments, reason = "most are by keyword only")]
    fn new(
        kp: f64,
        ki: f64,
        kd: f64,
        derivative_tau_s: f64,
        output_min: f64,
        output_max: f64,
        output_rate_per_s: f64,
        tracking_tau_s: Option<f64>,
    ) -> PyResult<Self> {
        // False for NaN as well.
        if !matches!(
            output_min.partial_cmp(&output_max),
            Some(std::cmp::Ordering::Less)
        ) {
            return Err(PyValueError::new_err(format!(
                "output_min is {output_min} and output_max {output_max}: the first must be less"
            )));
        }
        if output_rate_per_s.is_nan() || output_rate_per_s <= 0.0 {
            return Err(PyValueError::new_err(format!(
                "output_rate_per_s is {output_rate_per_s}: it must be above 0"
            )));
        }
        Ok(Self(Pid::new(PidConfig {
            kp: finite("kp", kp)?,
            ki: finite("ki", ki)?,
            kd: finite("kd", kd)?,
            derivative_tau_s: not_negative("derivative_tau_s", derivative_tau_s)?,
            output_min,
            output_max,
            output_rate_per_s,
            anti_windup: match tracking_tau_s {
                None => AntiWindup::Clamping,
                Some(tau) => AntiWindup::BackCalculation {
                    tracking_tau_s: positive("tracking_tau_s", tau)?,
                },
            },
        })))
    }

    /// One step, `dt` s after the previous one; returns the output. `feed_forward` is in units
    /// of the output, `gain_scale` multiplies all gains.
    #[pyo3(signature = (setpoint, measurement, dt, *, feed_forward = 0.0, gain_scale = 1.0))]
    fn step(
        &mut self,
        setpoint: f64,
        measurement: f64,
        dt: f64,
        feed_forward: f64,
        gain_scale: f64,
    ) -> PyResult<f64> {
        Ok(self.0.step_scheduled(
            finite("setpoint", setpoint)?,
            finite("measurement", measurement)?,
            finite("feed_forward", feed_forward)?,
            finite("gain_scale", gain_scale)?,
            passed_s(dt)?,
        ))
    }

    /// Engages at the present output: the next step with the same arguments
    /// returns that output.
    #[pyo3(signature = (output, setpoint, measurement, *, feed_forward = 0.0, gain_scale = 1.0))]
    fn engage(
        &mut self,
        output: f64,
        setpoint: f64,
        measurement: f64,
        feed_forward: f64,
        gain_scale: f64,
    ) -> PyResult<()> {
        self.0.engage(
            finite("output", output)?,
            finite("setpoint", setpoint)?,
            finite("measurement", measurement)?,
            finite("feed_forward", feed_forward)?,
            finite("gain_scale", gain_scale)?,
        );
        Ok(())
    }

    /// The integral, in units of the output.
    #[getter]
    fn integral(&self) -> f64 {
        self.0.integral()
    }
}

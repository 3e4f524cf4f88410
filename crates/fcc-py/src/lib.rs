//! The Python module `fcc`: the autopilot in lockstep with whatever simulates
//! the aircraft, as fast as the machine can.

use std::time::Duration;

use fcc_core::flight::{
    Attitude, Autopilot, BodyRates, Measurements, Plant, PlantState, SpecificForce, Surfaces,
};
use fcc_core::framework::{Controller, Reading, Tick, Time};
use fcc_daemon::config::{AutopilotSection, CourseSection};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde::Deserialize;

/// The part of a configuration file that the autopilot needs.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Config {
    autopilot: AutopilotSection,
    course: CourseSection,
}

/// The autopilot, stepped by hand: `engage` once, then `step` per tick.
#[pyclass(name = "Autopilot")]
struct PyAutopilot {
    autopilot: Autopilot,
    tick: Tick,
    plant_time_s: f64,
    engaged: bool,
}

#[pymethods]
impl PyAutopilot {
    /// From the text of a configuration file; only `[autopilot]` and
    /// `[course]` matter here.
    #[new]
    #[pyo3(signature = (config = ""))]
    fn new(config: &str) -> PyResult<Self> {
        let config: Config =
            toml::from_str(config).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let core = config
            .autopilot
            .to_core(&config.course, Duration::from_millis(250));
        Ok(Self {
            autopilot: Autopilot::new(core),
            tick: Tick::default(),
            plant_time_s: 0.0,
            engaged: false,
        })
    }

    /// Takes measurements `dt` seconds after the last, without controlling:
    /// filters settle.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe(&mut self, measurements: [f64; 15], dt: f64) -> PyResult<()> {
        self.take(&measurements, dt).map(|_| ())
    }

    /// Takes over: the present becomes the set points.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn engage(&mut self, measurements: [f64; 15], dt: f64) -> PyResult<()> {
        let taken = self.take(&measurements, dt)?;
        self.autopilot.engage(&self.tick, &taken);
        self.engaged = true;
        Ok(())
    }

    /// One tick of `dt` seconds: (throttle, elevator, aileron, rudder).
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn step(&mut self, measurements: [f64; 15], dt: f64) -> PyResult<(f64, f64, f64, f64)> {
        if !self.engaged {
            return Err(PyRuntimeError::new_err(
                "the autopilot is not engaged: call engage() first",
            ));
        }
        let taken = self.take(&measurements, dt)?;
        self.autopilot.guide(&self.tick, &taken);
        let out = self.autopilot.control(&self.tick, &taken);
        Ok((out.throttle, out.elevator, out.aileron, out.rudder))
    }

    /// Set points: (airspeed m/s, heading rad, altitude m, roll rad, climb
    /// rate m/s, pitch rad).
    fn setpoints(&self) -> (f64, f64, f64, f64, f64, f64) {
        let s = self.autopilot.setpoints();
        (
            s.airspeed_mps,
            s.heading_rad,
            s.altitude_m,
            s.roll_rad,
            s.climb_rate_mps,
            s.pitch_rad,
        )
    }

    /// Estimates: (roll rad, pitch rad, heading rad, airspeed m/s, altitude m,
    /// climb rate m/s, side force m/s²).
    fn estimate(&self) -> (f64, f64, f64, f64, f64, f64, f64) {
        let e = self.autopilot.estimated();
        (
            e.roll_rad,
            e.pitch_rad,
            e.heading_rad,
            e.airspeed_mps,
            e.altitude_m,
            e.climb_rate_mps,
            e.side_force_mps2,
        )
    }
}

impl PyAutopilot {
    /// Pitch, roll, heading (rad), p, q, r (rad/s), specific force x, y, z
    /// (m/s²), airspeed (m/s), altitude (m), throttle, elevator, aileron,
    /// rudder as they stand.
    fn take(&mut self, m: &[f64; 15], dt_s: f64) -> PyResult<Measurements> {
        if !(dt_s > 0.0 && dt_s <= 1.0) {
            return Err(PyValueError::new_err(format!(
                "dt is {dt_s} s: it must be above 0 and at most 1"
            )));
        }
        self.tick.number += 1;
        self.plant_time_s += dt_s;
        let now = Time::from_nanos((self.plant_time_s * 1e9) as i64);
        self.tick.scheduled = now;
        self.tick.woke = now;
        self.tick.dt_s = dt_s;
        let [
            pitch_rad,
            roll_rad,
            heading,
            p,
            q,
            r,
            fx,
            fy,
            fz,
            airspeed,
            altitude,
            th,
            el,
            ai,
            ru,
        ] = *m;
        let measurements = Measurements {
            attitude: Reading::new(
                Attitude {
                    pitch_rad,
                    roll_rad,
                },
                now,
            ),
            heading_rad: Reading::new(heading, now),
            body_rates: Reading::new(
                BodyRates {
                    roll_radps: p,
                    pitch_radps: q,
                    yaw_radps: r,
                },
                now,
            ),
            specific_force: Reading::new(
                SpecificForce {
                    x_mps2: fx,
                    y_mps2: fy,
                    z_mps2: fz,
                },
                now,
            ),
            airspeed_mps: Reading::new(airspeed, now),
            altitude_m: Reading::new(altitude, now),
            surfaces: Reading::new(
                Surfaces {
                    throttle: th,
                    elevator: el,
                    aileron: ai,
                    rudder: ru,
                },
                now,
            ),
            plant: Reading::new(
                Plant {
                    time_s: self.plant_time_s,
                    state: PlantState::Running,
                },
                now,
            ),
            ..Measurements::default()
        };
        self.autopilot.estimate(&self.tick, &measurements);
        Ok(measurements)
    }
}

/// The flight control computer.
#[pymodule]
fn fcc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyAutopilot>()
}

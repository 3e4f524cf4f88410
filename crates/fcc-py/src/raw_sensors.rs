//! Raw sensors for a plant of one's own.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Mutex, PoisonError};

use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_sim::{RawSensorSet, RawSensors, RawTruth};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{seed as seed_of, vector, within};
use crate::values::{PyMeasurements, PyRawTruth, Values as _, as_row, checked, names};

/// The field that is taken without another: of middle latitudes, µT.
const FIELD_UT: [f64; 3] = [21.1, 0.0, 45.3];
/// What both magnetometers can show, µT.
const LARGEST_FIELD_UT: f64 = 800.0;

/// What an aircraft can do of what has no range by itself: smallest and largest
/// value. The sensors' own ranges are 2,000 °/s and 16 g; altitudes and velocities
/// are those that the autopilot takes for possible.
const POSSIBLE: [(&str, f64, f64); 14] = [
    ("pitch_rad", -TAU, TAU),
    ("roll_rad", -TAU, TAU),
    ("roll_rate_radps", -35.0, 35.0),
    ("pitch_rate_radps", -35.0, 35.0),
    ("yaw_rate_radps", -35.0, 35.0),
    ("specific_force_x_mps2", -200.0, 200.0),
    ("specific_force_y_mps2", -200.0, 200.0),
    ("specific_force_z_mps2", -200.0, 200.0),
    ("latitude_rad", -FRAC_PI_2, FRAC_PI_2),
    ("longitude_rad", -PI, PI),
    ("position_altitude_m", -500.0, 20_000.0),
    ("north_mps", -450.0, 450.0),
    ("east_mps", -450.0, 450.0),
    ("down_mps", -450.0, 450.0),
];

/// What a phone's or a board's accelerometer, gyroscope, magnetometer,
/// barometer, pitot tube and satellite navigation give of a true motion: with
/// bias, drift, scale, misalignment, the engine's vibration, noise, resolution,
/// clipping, delay and jitter. The same seed gives the same errors, to the last
/// bit.
///
/// `sensors` is "phone", the thesis' of 2011, "board", a present one, or
/// "board-rtk", the same with a position good to 0.5 m;
/// `field_ut` is the magnetic field in µT, north, east and down, up to 800 each;
/// without it (21.1, 0, 45.3). `seed` is a whole number, 0 to 2⁶⁴ - 1.
///
/// Raises `ValueError` for what is out of its range, with the range.
///
/// >>> at_rest = {"specific_force_z_mps2": -9.81, "static_pressure_pa": 101_325.0}
/// >>> sensors = fcc.RawSensors("board", fcc.RawTruth(**at_rest), seed=1)
/// >>> sensors.step(fcc.RawTruth(time_s=0.1, **at_rest))
/// >>> read = fcc.Measurements()
/// >>> sorted(sensors.read(read))[:2], round(read.raw_specific_force_z_mps2)
/// (['differential_pressure', 'magnetic_field'], -10)
#[pyclass(name = "RawSensors", module = "fcc")]
pub(crate) struct PyRawSensors {
    inner: Mutex<Inner>,
}

struct Inner {
    sensors: RawSensors,
    now_s: f64,
}

#[pymethods]
impl PyRawSensors {
    #[new]
    #[pyo3(signature = (sensors, start, *, seed = None, field_ut = None))]
    fn new(
        sensors: &str,
        start: &PyRawTruth,
        seed: Option<&Bound<'_, PyAny>>,
        field_ut: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let set = match sensors {
            "phone" => RawSensorSet::phone(),
            "board" => RawSensorSet::board(),
            "board-rtk" => RawSensorSet::board_with_precise_position(),
            other => {
                return Err(PyValueError::new_err(format!(
                    "sensors is '{other}': choose \"phone\", \"board\" or \"board-rtk\""
                )));
            }
        };
        let seed = seed.map_or(Ok(1), |given| seed_of("seed", given))?;
        let field_ut = field_ut.map_or(Ok(FIELD_UT), |given| vector("field_ut", given))?;
        for (at, axis) in field_ut.into_iter().enumerate() {
            let name = format!("field_ut[{at}]");
            within(&name, axis, -LARGEST_FIELD_UT, LARGEST_FIELD_UT)?;
        }
        let start = possible(*start)?;
        Ok(Self {
            inner: Mutex::new(Inner {
                sensors: RawSensors::new(&set, seed, &start, field_ut),
                now_s: start.time_s,
            }),
        })
    }

    /// Takes the samples from the last truth to this one, at most 1 s later;
    /// between the two the motion is taken to be linear.
    fn step(&self, truth: &PyRawTruth) -> PyResult<()> {
        let truth = possible(*truth)?;
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        let (before_s, now_s) = (inner.now_s, truth.time_s);
        if !(0.0..=1.0).contains(&(now_s - before_s)) {
            return Err(PyValueError::new_err(format!(
                "time_s is {now_s}, after {before_s}: give a time up to 1 s later"
            )));
        }
        inner.now_s = now_s;
        inner.sensors.step(&truth);
        Ok(())
    }

    /// Writes what arrived since the last time into measurements, NaN for what
    /// did not, and returns when each reading arrived, in s, by its name: the
    /// mean of its samples' arrivals.
    fn read<'py>(
        &self,
        py: Python<'py>,
        into: &Bound<'py, PyMeasurements>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        let mut arrived = Measurements::default();
        // The clock begins where the simulation does.
        let now_s = inner.now_s;
        let now = Time::from_nanos((now_s * 1e9) as i64);
        inner.sensors.read(now, &mut arrived);
        let raw: Measurements = PyMeasurements::from_core(&arrived).into();
        let before: Measurements = (*into.borrow()).into();
        PyMeasurements::assign(
            into,
            Measurements {
                raw_specific_force: raw.raw_specific_force,
                raw_body_rates: raw.raw_body_rates,
                magnetic_field: raw.magnetic_field,
                static_pressure_pa: raw.static_pressure_pa,
                differential_pressure_pa: raw.differential_pressure_pa,
                air_temperature_k: raw.air_temperature_k,
                gnss: raw.gnss,
                range_m: raw.range_m,
                ..before
            },
        );
        let times = PyDict::new(py);
        for (name, taken) in [
            ("raw_specific_force", arrived.raw_specific_force.taken),
            ("raw_body_rates", arrived.raw_body_rates.taken),
            ("magnetic_field", arrived.magnetic_field.taken),
            ("static_pressure", arrived.static_pressure_pa.taken),
            (
                "differential_pressure",
                arrived.differential_pressure_pa.taken,
            ),
            ("air_temperature", arrived.air_temperature_k.taken),
            ("gnss", arrived.gnss.taken),
            ("range", arrived.range_m.taken),
        ] {
            if !taken.is_never() {
                times.set_item(name, taken.as_nanos() as f64 * 1e-9)?;
            }
        }
        Ok(times)
    }
}

/// A truth that an aircraft can have.
fn possible(of: PyRawTruth) -> PyResult<RawTruth> {
    let truth = checked(of.into())?;
    let mut row = Vec::new();
    as_row(of, &mut row);
    for (name, value) in names::<PyRawTruth>().zip(row) {
        if let Some((_, least, most)) = POSSIBLE.iter().find(|(known, ..)| *known == name) {
            within(name, value, *least, *most)?;
        }
    }
    Ok(truth)
}

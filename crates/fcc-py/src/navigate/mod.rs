//! Navigation from arrays of raw samples.

mod kind;
mod magnetism;
mod mounting;
mod no_fix;
mod plausible;
mod result;
mod sources;

use std::time::Duration;

use fcc_core::framework::Time;
use fcc_navigation::inertial::{
    InertialNavigation, Innovation, KalmanConfig, KalmanNavigation, Observation, Solution,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use magnetism::earth_field_ut;
use mounting::Mounting;
use sources::{Event, Given, Sources};

/// Steps between two looks for Ctrl-C.
const PIECE: usize = 16_384;
/// An accelerometer slower than this is not waited for, s.
const LONGEST_WAIT_S: f64 = 0.05;

/// Attitude, velocity, position, wind and biases from arrays of raw samples of
/// sensors: each source is a tuple of its times in s and its values, which are
/// n × 3 or three arrays of n for a vector. Any may be left out, but not both
/// gyroscope and accelerometer; rates and times are as they are. Body axes
/// forward, right, down; the accelerometer shows specific force, (0, 0, -9.8) at
/// rest. Samples that are masked, not finite or not possible are ignored.
///
/// Sources whose times do not meet those of the gyroscope (or the accelerometer), or half a
/// second and more between its samples, are a `ValueError`; samples mostly at other times a
/// `UserWarning`. Units, signs and axes are taken as they are: `normalised_innovations` shows
/// by source how well they agree, by RMS of 1 or less if they do.
///
/// >>> t = np.arange(0.0, 10.0, 0.01)
/// >>> still, up = np.zeros((t.size, 3)), np.tile([0.0, 0.0, -9.81], (t.size, 1))
/// >>> found = fcc.navigate(gyroscope=(t, still), accelerometer=(t, up))
/// >>> round(float(found["pitch_rad"][-1]), 3)
/// 0.0
#[pyfunction]
#[pyo3(signature = (
    *,
    gyroscope = None,
    accelerometer = None,
    magnetometer = None,
    static_pressure = None,
    differential_pressure = None,
    airspeed = None,
    gnss_position = None,
    gnss_velocity = None,
    delays_s = None,
    mounting = None,
    year = None,
))]
#[allow(clippy::too_many_arguments, reason = "named arguments of Python")]
pub(crate) fn navigate<'py>(
    py: Python<'py>,
    gyroscope: Option<Bound<'py, PyAny>>,
    accelerometer: Option<Bound<'py, PyAny>>,
    magnetometer: Option<Bound<'py, PyAny>>,
    static_pressure: Option<Bound<'py, PyAny>>,
    differential_pressure: Option<Bound<'py, PyAny>>,
    airspeed: Option<Bound<'py, PyAny>>,
    gnss_position: Option<Bound<'py, PyAny>>,
    gnss_velocity: Option<Bound<'py, PyAny>>,
    delays_s: Option<&Bound<'py, PyAny>>,
    mounting: Option<&Bound<'py, PyAny>>,
    year: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let mounting = Mounting::read(mounting)?;
    let given = Given {
        gyroscope,
        accelerometer,
        magnetometer,
        static_pressure,
        differential_pressure,
        airspeed,
        gnss_position,
        gnss_velocity,
    };
    let sources = Sources::read(py, &given, delays_s, &mounting)?;
    let field = match sources.first_place() {
        Some(place) if sources.has_field() => Some(earth_field_ut(place, year)?),
        _ => {
            magnetism::check(year)?;
            None
        }
    };
    let reference = match (sources.has_field(), field.is_some(), sources.has_receiver()) {
        (true, true, _) | (false, _, true) => "true",
        (true, ..) => "magnetic",
        _ => "none",
    };
    let config = KalmanConfig {
        delay: Duration::from_secs_f64(sources.delay_s(LONGEST_WAIT_S)),
        earth_field_ut: field,
    };
    let mut run = Run {
        filter: Box::new(KalmanNavigation::new(config)),
        next: 0,
        solutions: Vec::new(),
        innovations: Vec::new(),
    };
    for piece in sources.steps.chunks(PIECE) {
        py.detach(|| run.steps(&sources.events, piece));
        py.check_signals()?;
    }
    result::dict(py, &sources, &run.solutions, &run.innovations, reference)
}

/// The samples of a gyroscope and an accelerometer, each as a tuple of times and
/// values, in the order of their times.
pub(crate) fn inertial_samples<'py>(
    gyroscope: Bound<'py, PyAny>,
    accelerometer: Bound<'py, PyAny>,
) -> PyResult<Vec<(Time, Observation)>> {
    let py = gyroscope.py();
    let given = Given {
        gyroscope: Some(gyroscope),
        accelerometer: Some(accelerometer),
        ..Given::default()
    };
    let sources = Sources::read(py, &given, None, &Mounting::read(None)?)?;
    let samples = sources.events.into_iter();
    Ok(samples
        .map(|event| (event.arrived, event.observation))
        .collect())
}

struct Run {
    filter: Box<KalmanNavigation>,
    next: usize,
    solutions: Vec<Solution>,
    innovations: Vec<Innovation>,
}

impl Run {
    /// Steps at each of these times, with the samples that have arrived.
    fn steps(&mut self, events: &[Event], times: &[Time]) {
        for now in times {
            while let Some(event) = events.get(self.next).filter(|event| event.arrived <= *now) {
                self.filter.observe(event.taken, event.observation);
                self.next += 1;
            }
            self.solutions.push(self.filter.step(*now));
            self.innovations
                .extend_from_slice(self.filter.innovations());
        }
    }
}

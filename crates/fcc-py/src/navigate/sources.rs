//! The sources: arrays of times and of values, checked, as one series.

use std::collections::HashSet;

use fcc_core::framework::Time;
use fcc_navigation::inertial::{GeodeticPosition, Observation};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::kind::{KINDS, Kind, Series};
use super::mounting::Mounting;
use super::no_fix;
use super::plausible;
use crate::arguments::within;

/// The longest delay, s: the filter keeps half a second of samples.
const LONGEST_DELAY_S: f64 = 0.5;
/// Times in s, from that of the first sample.
const LONGEST_S: f64 = 1e9;

/// What was given, in the order of `KINDS`.
#[derive(Default)]
pub(super) struct Given<'py> {
    pub(super) gyroscope: Option<Bound<'py, PyAny>>,
    pub(super) accelerometer: Option<Bound<'py, PyAny>>,
    pub(super) magnetometer: Option<Bound<'py, PyAny>>,
    pub(super) static_pressure: Option<Bound<'py, PyAny>>,
    pub(super) differential_pressure: Option<Bound<'py, PyAny>>,
    pub(super) airspeed: Option<Bound<'py, PyAny>>,
    pub(super) gnss_position: Option<Bound<'py, PyAny>>,
    pub(super) gnss_velocity: Option<Bound<'py, PyAny>>,
}

/// A sample, when it arrived and when it was taken.
pub(super) struct Event {
    pub(super) arrived: Time,
    pub(super) taken: Time,
    pub(super) observation: Observation,
}

/// All samples in the order of their arrival, and the times at which an estimate
/// is wanted: those of the gyroscope, or of the accelerometer.
pub(super) struct Sources {
    pub(super) events: Vec<Event>,
    pub(super) steps: Vec<Time>,
    pub(super) begin_s: f64,
    present: [bool; 8],
    delay_s: f64,
    /// Between samples of the accelerometer, unless they come with the
    /// gyroscope's.
    accelerometer_s: f64,
    first_place: Option<GeodeticPosition>,
}

impl Sources {
    pub(super) fn read(
        py: Python<'_>,
        given: &Given<'_>,
        delays_s: Option<&Bound<'_, PyAny>>,
        mounting: &Mounting,
    ) -> PyResult<Self> {
        let all = [
            &given.gyroscope,
            &given.accelerometer,
            &given.magnetometer,
            &given.static_pressure,
            &given.differential_pressure,
            &given.airspeed,
            &given.gnss_position,
            &given.gnss_velocity,
        ];
        let delays = delays(delays_s)?;
        let mut series = Vec::new();
        for (kind, source) in KINDS.iter().zip(all) {
            series.push(
                source
                    .as_ref()
                    .map(|source| kind.read(source))
                    .transpose()?,
            );
        }
        let present: Vec<bool> = series.iter().map(Option::is_some).collect();
        let present = <[bool; 8]>::try_from(present).unwrap_or_default();
        let [gyroscope, accelerometer, ..] = series.as_slice() else {
            return Err(nothing());
        };
        let driving = gyroscope
            .as_ref()
            .or(accelerometer.as_ref())
            .ok_or_else(nothing)?;
        if given.airspeed.is_some() && given.differential_pressure.is_some() {
            return Err(PyValueError::new_err(
                "airspeed and differential_pressure are both given: give one, they are one sensor",
            ));
        }
        let begin_s = series
            .iter()
            .flatten()
            .filter_map(|series| series.times_s.first().copied())
            .fold(f64::INFINITY, f64::min);
        for (kind, series) in KINDS.iter().zip(&series) {
            let last_s = series.as_ref().and_then(|series| series.times_s.last());
            if let Some(last_s) = last_s.filter(|last_s| **last_s - begin_s > LONGEST_S) {
                return Err(PyValueError::new_err(format!(
                    "{}: times are from {begin_s} s to {last_s:?} s, {LONGEST_S} s at most: are \
                     they in s?",
                    kind.name
                )));
            }
        }
        let mut sources = Self {
            events: Vec::new(),
            steps: driving.times_s.iter().map(|t| time(t - begin_s)).collect(),
            begin_s,
            present,
            delay_s: 0.0,
            accelerometer_s: interval_s(gyroscope.as_ref(), accelerometer.as_ref()),
            first_place: None,
        };
        sources.steps.dedup();
        let of = |name: &str| {
            let mut named = KINDS.iter().zip(&series);
            named
                .find(|(kind, _)| kind.name == name)
                .and_then(|(_, series)| series.as_ref())
        };
        let no_fix = no_fix::times(of("gnss_position"), of("gnss_velocity"));
        for ((kind, series), delay_s) in KINDS.iter().zip(&series).zip(delays) {
            if let Some(series) = series {
                sources.add(kind, series, delay_s, mounting, &no_fix)?;
            }
        }
        // After the samples themselves: in a wrong unit they are not possible.
        plausible::check(py, &series)?;
        sources.events.sort_by_key(|event| event.arrived);
        Ok(sources)
    }

    fn add(
        &mut self,
        kind: &Kind,
        series: &Series,
        delay_s: f64,
        mounting: &Mounting,
        no_fix: &HashSet<u64>,
    ) -> PyResult<()> {
        self.delay_s = self.delay_s.max(delay_s);
        let mut kept = 0;
        for (time_s, row) in series.times_s.iter().zip(&series.rows) {
            if !kind.is_possible(row) {
                continue;
            }
            kept += 1;
            if kind.is_of_receiver() && no_fix.contains(&time_s.to_bits()) {
                continue;
            }
            let since_s = time_s - self.begin_s;
            let observation = observation(kind.name, mounting.body(kind.name, *row));
            if let (Observation::Position(place), None) = (observation, self.first_place) {
                self.first_place = Some(place);
            }
            self.events.push(Event {
                arrived: time(since_s),
                taken: time(since_s - delay_s),
                observation,
            });
        }
        // Some may be spoilt; most are not possible if they are in another unit.
        let shown = series.rows.len() - series.masked;
        if 2 * kept < shown {
            return Err(PyValueError::new_err(format!(
                "{}: {} of {} samples are not possible: it is in {}, each finite{}",
                kind.name,
                shown - kept,
                shown,
                kind.unit,
                kind.bounds()
            )));
        }
        Ok(())
    }

    fn has(&self, name: &str) -> bool {
        let at = KINDS.iter().position(|kind| kind.name == name);
        at.and_then(|at| self.present.get(at))
            .copied()
            .unwrap_or(false)
    }

    pub(super) fn has_field(&self) -> bool {
        self.has("magnetometer")
    }

    pub(super) fn has_receiver(&self) -> bool {
        self.has("gnss_velocity") || self.has("gnss_position")
    }

    pub(super) fn first_place(&self) -> Option<GeodeticPosition> {
        self.first_place
    }

    /// How far the filter has to run behind.
    pub(super) fn delay_s(&self, longest_wait_s: f64) -> f64 {
        self.delay_s.max(self.accelerometer_s.min(longest_wait_s))
    }
}

fn observation(name: &str, row: [f64; 3]) -> Observation {
    let [first, second, third] = row;
    match name {
        "gyroscope" => Observation::Rates(row),
        "accelerometer" => Observation::SpecificForce(row),
        "magnetometer" => Observation::MagneticField(row),
        "static_pressure" => Observation::StaticPressure(first),
        "differential_pressure" => Observation::DifferentialPressure(first),
        "airspeed" => Observation::Airspeed(first),
        "gnss_position" => Observation::Position(GeodeticPosition {
            latitude_rad: first,
            longitude_rad: second,
            altitude_m: third,
        }),
        _ => Observation::Velocity(row),
    }
}

fn nothing() -> PyErr {
    PyValueError::new_err(
        "neither gyroscope nor accelerometer is given: give at least one, as (t_s, values)",
    )
}

fn delays(given: Option<&Bound<'_, PyAny>>) -> PyResult<[f64; 8]> {
    let mut delays = [0.0; 8];
    let Some(given) = given else {
        return Ok(delays);
    };
    let names = || KINDS.map(|kind| kind.name).join(", ");
    let each = given.cast::<PyDict>().map_err(|_| {
        PyTypeError::new_err(format!(
            "delays_s is no dict: give {{name: seconds}}, the names being {}",
            names()
        ))
    })?;
    for (name, delay) in each {
        let name: String = name.extract().unwrap_or_default();
        let at = KINDS.iter().position(|kind| kind.name == name);
        let Some(place) = at.and_then(|at| delays.get_mut(at)) else {
            return Err(PyValueError::new_err(format!(
                "delays_s has {name:?}: choose of {}",
                names()
            )));
        };
        let what = format!("delays_s[{name:?}]");
        let delay: f64 = delay
            .extract()
            .map_err(|_| PyTypeError::new_err(format!("{what} is no number: give seconds")))?;
        *place = within(&what, delay, 0.0, LONGEST_DELAY_S)?;
    }
    Ok(delays)
}

/// Between two samples of an accelerometer that has times of its own, s.
fn interval_s(gyroscope: Option<&Series>, accelerometer: Option<&Series>) -> f64 {
    match (gyroscope, accelerometer) {
        (Some(one), Some(other)) if one.times_s != other.times_s => {
            let (first, last) = (other.times_s.first(), other.times_s.last());
            let span_s = last.zip(first).map_or(0.0, |(last, first)| last - first);
            1.5 * span_s / (other.times_s.len() as f64 - 1.0).max(1.0)
        }
        _ => 0.0,
    }
}

fn time(since_s: f64) -> Time {
    Time::from_nanos((since_s * 1e9).round() as i64)
}

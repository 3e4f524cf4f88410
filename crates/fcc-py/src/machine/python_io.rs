//! What stands in the loop for sensors and actuators: Python's hands.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, Switch, Tick};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::values::{Measured, PyMeasurements};

/// The sensors that can be missing from a tick, by the names they go by in
/// Python.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Attitude,
    Heading,
    BodyRates,
    SpecificForce,
    Airspeed,
    Altitude,
}

impl Part {
    const ALL: [(&'static str, Self); 6] = [
        ("attitude", Self::Attitude),
        ("heading", Self::Heading),
        ("body_rates", Self::BodyRates),
        ("specific_force", Self::SpecificForce),
        ("airspeed", Self::Airspeed),
        ("altitude", Self::Altitude),
    ];

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Which sensors are missing from a tick.
#[derive(Clone, Copy, Default)]
pub(super) struct Missing(u8);

impl Missing {
    /// Reads the names of sensors.
    pub(super) fn named(names: Vec<String>) -> PyResult<Self> {
        let mut missing = Self::default();
        for name in names {
            let part = Part::ALL.iter().find(|(known, _)| *known == name);
            let Some((_, part)) = part else {
                let known: Vec<_> = Part::ALL.iter().map(|(known, _)| *known).collect();
                return Err(PyValueError::new_err(format!(
                    "missing: there is no sensor '{name}'; choose of {}",
                    known.join(", ")
                )));
            };
            missing.0 |= part.bit();
        }
        Ok(missing)
    }

    const fn has(self, part: Part) -> bool {
        self.0 & part.bit() != 0
    }
}

/// What the sensors say in one tick.
#[derive(Clone, Copy)]
pub(super) struct Said {
    pub(super) measurements: PyMeasurements,
    pub(super) missing: Missing,
    /// Where the controls stand; none if the plant does not tell.
    pub(super) standing: Option<Surfaces>,
    /// The engage switch; none if there is none.
    pub(super) switch: Option<Switch>,
    /// The plant's own time, s.
    pub(super) plant_time_s: f64,
}

/// A sensor that says what Python handed over, and nothing in a tick for which
/// nothing was.
pub(super) struct HandedOver {
    said: Consumer<Said>,
}

impl HandedOver {
    pub(super) const NAME: &'static str = "lockstep";

    /// The sensor, and where to put what it says next.
    pub(super) fn new() -> (Producer<Said>, Self) {
        let (hand_over, said) = RingBuffer::new(1);
        (hand_over, Self { said })
    }
}

impl Sensor<Measurements> for HandedOver {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let said = self.said.pop().map_err(|_| SensorFault::Silent)?;
        let new = said.measurements.to_core(&Measured {
            now: tick.woke,
            plant_s: said.plant_time_s,
            standing: said.standing,
            switch: said.switch,
        });
        let missing = said.missing;
        take(&mut into.attitude, new.attitude, missing, Part::Attitude);
        take(
            &mut into.heading_rad,
            new.heading_rad,
            missing,
            Part::Heading,
        );
        take(
            &mut into.body_rates,
            new.body_rates,
            missing,
            Part::BodyRates,
        );
        take(
            &mut into.specific_force,
            new.specific_force,
            missing,
            Part::SpecificForce,
        );
        take(
            &mut into.airspeed_mps,
            new.airspeed_mps,
            missing,
            Part::Airspeed,
        );
        take(
            &mut into.altitude_m,
            new.altitude_m,
            missing,
            Part::Altitude,
        );
        into.plant = new.plant;
        if said.standing.is_some() {
            into.surfaces = new.surfaces;
        }
        if said.switch.is_some() {
            into.engage_switch = new.engage_switch;
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }
}

/// A sensor that is missing leaves its reading as it is: it grows old.
fn take<T>(reading: &mut Reading<T>, new: Reading<T>, missing: Missing, part: Part) {
    if !missing.has(part) {
        *reading = new;
    }
}

/// An actuator that remembers whether the loop holds it; what was sent is in
/// the record of the tick.
pub(super) struct Held(Arc<AtomicBool>);

impl Held {
    pub(super) const NAME: &'static str = "lockstep";

    /// The actuator, and where to see whether it is held.
    pub(super) fn new() -> (Arc<AtomicBool>, Self) {
        let held = Arc::new(AtomicBool::new(false));
        (Arc::clone(&held), Self(held))
    }
}

impl Actuator<Surfaces> for Held {
    fn apply(&mut self, _: &Tick, _: &Surfaces) -> Result<(), ActuatorFault> {
        self.0.store(true, Ordering::Relaxed);
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.store(false, Ordering::Relaxed);
        Ok(())
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }
}

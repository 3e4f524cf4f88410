//! An autopilot that makes one tick per call.

use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Controller, Flags, Tick, Time};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig};
use pyo3::prelude::*;

use crate::errors;
use crate::machine::conditions;
use crate::values::{PyMeasurements, Shape, Values as _, with_plant};

/// An autopilot, and its time.
#[derive(Clone)]
pub(crate) struct Stepped {
    pub(crate) autopilot: Autopilot,
    tick: Tick,
    time_s: f64,
    engaged: bool,
    taken: Measurements,
}

impl Stepped {
    pub(crate) fn new(config: &AutopilotConfig) -> Self {
        Self {
            autopilot: Autopilot::new(*config),
            tick: Tick::default(),
            time_s: 0.0,
            engaged: false,
            taken: Measurements::default(),
        }
    }

    /// Processes measurements without controlling.
    pub(crate) fn observe(&mut self, measured: &PyMeasurements, dt_s: f64) {
        self.take(measured, dt_s, None);
    }

    /// Engages with the controls at these positions.
    pub(crate) fn engage(
        &mut self,
        measured: &PyMeasurements,
        dt_s: f64,
        readback: Surfaces,
    ) -> Result<(), String> {
        self.take(measured, dt_s, Some(readback));
        let engage_inhibits = self.engage_inhibits();
        if !engage_inhibits.is_empty() {
            return Err(format!(
                "not engaged: {}",
                conditions::<Autopilot>(engage_inhibits).join(", ")
            ));
        }
        self.autopilot.engage(&self.tick, &self.taken);
        self.engaged = true;
        Ok(())
    }

    /// One tick of control.
    pub(crate) fn step(&mut self, measured: &PyMeasurements, dt_s: f64) -> Surfaces {
        self.take(measured, dt_s, None);
        self.autopilot.guide(&self.tick, &self.taken);
        self.autopilot.control(&self.tick, &self.taken)
    }

    /// One tick of failsafe.
    pub(crate) fn failsafe(&mut self, measured: &PyMeasurements, dt_s: f64) -> Surfaces {
        self.take(measured, dt_s, None);
        self.autopilot.failsafe(&self.tick, &self.taken)
    }

    /// Disengages.
    pub(crate) fn disengage(&mut self) {
        self.autopilot.disengage();
        self.engaged = false;
    }

    pub(crate) const fn is_engaged(&self) -> bool {
        self.engaged
    }

    pub(crate) fn must_be_engaged(&self) -> PyResult<()> {
        if self.engaged {
            return Ok(());
        }
        Err(errors::ENGAGE.with("the autopilot is not engaged: call engage() first"))
    }

    pub(crate) fn command(&mut self, commands: impl IntoIterator<Item = AutopilotCommand>) {
        for command in commands {
            self.autopilot.command(&command);
        }
    }

    pub(crate) fn engage_inhibits(&self) -> Flags {
        self.autopilot.engage_inhibits(&self.tick, &self.taken)
    }

    pub(crate) fn faults(&self) -> Flags {
        self.autopilot.faults(&self.tick, &self.taken)
    }

    fn take(&mut self, measured: &PyMeasurements, dt_s: f64, readback: Option<Surfaces>) {
        self.time_s += dt_s;
        let now = Time::from_nanos(Duration::from_secs_f64(self.time_s).as_nanos() as i64);
        self.tick = Tick {
            number: self.tick.number + 1,
            scheduled: now,
            woke: now,
            missed: 0,
            dt_s,
        };
        let sample = with_plant(&measured.sample(|_| false), self.time_s, readback, None);
        self.taken = Measurements::default();
        Shape::of::<Measurements>().copy(&sample, &mut self.taken, Some(now));
        self.autopilot.estimate(&self.tick, &self.taken);
    }
}

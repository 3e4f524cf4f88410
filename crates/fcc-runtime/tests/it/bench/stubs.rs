//! The stubs: a sensor, a controller, two actuators and a clock that do as
//! the script on their stage says.

use std::time::Duration;

use fcc_core::framework::{
    Actuator, ActuatorFault, Controller, Flags, Notice, Reading, Sensor, SensorFault, Switch, Tick,
};
use fcc_runtime::Parts;
use fcc_timer::{Expiry, Timer, TimerError};

use super::{Measured, PERIOD, Stage, TimerEnd, expiry};

struct Probe(Stage);

impl Sensor<Measured> for Probe {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        self.0.called("sample");
        let script = self.0.script();
        into.samples += 1;
        if let Some(position) = script.switch {
            into.switch = Reading::new(position, tick.woke);
        }
        script.sample
    }

    fn name(&self) -> &'static str {
        "probe"
    }
}

pub(crate) struct Stub {
    stage: Stage,
    dt_s: f64,
}

impl Controller for Stub {
    type Measurements = Measured;
    type Estimate = ();
    type Setpoints = f64;
    type Outputs = f64;
    type Command = u32;

    fn estimate(&mut self, tick: &Tick, _: &Measured) {
        self.dt_s = tick.dt_s;
        self.stage.called("estimate");
    }

    fn engage_inhibits(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.perhaps_panic("engage_inhibits");
        self.stage.script().engage_inhibits
    }

    fn faults(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.perhaps_panic("faults");
        self.stage.script().faults
    }

    fn failsafe_goes_on(&self) -> bool {
        self.stage.script().goes_on
    }

    fn is_unattended(&self) -> bool {
        self.stage.script().unattended
    }

    fn has_recovered(&self) -> bool {
        self.stage.script().has_recovered
    }

    fn recover(&mut self, _: &Tick, _: &Measured) {
        self.stage.called("recover");
    }

    fn must_release(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.script().must_release
    }

    fn is_taken_over(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.script().taken_over
    }

    fn prepare_release(&mut self, _: &Tick, _: &Measured) -> bool {
        self.stage.called("prepare");
        self.stage.script().prepares_release.is_some()
    }

    fn is_ready_for_release(&self) -> bool {
        self.stage.script().prepares_release == Some(true)
    }

    fn withholds_outputs(&self, _: &Tick, _: &Measured) -> bool {
        self.stage.script().withholds
    }

    fn notices(&self) -> &[Notice] {
        self.stage.script().notices
    }

    fn conditions(&self, _: &Tick, _: &Measured) -> Flags {
        self.stage.script().conditions
    }

    fn flag_name(bit: u32) -> &'static str {
        ["nobody home", "too cold"]
            .get(bit as usize)
            .unwrap_or(&"unknown")
    }

    fn engage(&mut self, _: &Tick, _: &Measured) {
        self.stage.called("engage");
    }

    fn guide(&mut self, _: &Tick, _: &Measured) {
        self.stage.called("guide");
    }

    fn control(&mut self, _: &Tick, _: &Measured) -> f64 {
        self.stage.called("control");
        self.stage.script().output
    }

    fn failsafe(&mut self, _: &Tick, _: &Measured) -> f64 {
        self.stage.called("failsafe");
        self.stage.script().failsafe_output
    }

    fn disengage(&mut self) {
        self.stage.called("disengage");
    }

    fn command(&mut self, command: &u32) {
        self.stage.called("command");
        self.stage.note(|log| log.ordered.push(*command));
    }

    fn setpoints(&self) -> f64 {
        self.stage.perhaps_panic("setpoints");
        self.dt_s
    }

    fn outputs_are_valid(&self, outputs: &f64) -> bool {
        self.stage.perhaps_panic("outputs_are_valid");
        outputs.abs() <= 1.0
    }

    fn switch(&self, measured: &Measured) -> Reading<Switch> {
        measured.switch
    }
}

/// The first lies before the second: what it does must not keep the second
/// from being released.
struct Arm(Stage, usize);

impl Actuator<f64> for Arm {
    fn ready(&self) -> Result<(), ActuatorFault> {
        self.0.script().ready
    }

    fn apply(&mut self, _: &Tick, outputs: &f64) -> Result<(), ActuatorFault> {
        self.0.note(|log| log.held[self.1] = true);
        if self.1 == 1 {
            return Ok(());
        }
        self.0.called("apply");
        self.0.note(|log| log.applied.push(*outputs));
        self.0.script().apply
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.note(|log| log.releases[self.1] += 1);
        if self.1 == 0 {
            self.0.called("release");
            self.0.script().release?;
        }
        self.0.note(|log| log.held[self.1] = false);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "arm"
    }
}

/// Never waits; ends or fails when the script says so.
struct Clock {
    stage: Stage,
    number: u64,
}

impl Timer for Clock {
    fn start(&mut self) -> Result<(), TimerError> {
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        self.stage.perhaps_panic("wait");
        match self.stage.script().timer {
            Some(TimerEnd::Ended) => return Err(TimerError::Ended),
            Some(TimerEnd::Failed) => return Err(TimerError::NotStarted),
            None => self.number += 1,
        }
        self.stage.note(|log| log.took_ns = 0);
        Ok(expiry(self.number))
    }

    fn period(&self) -> Duration {
        PERIOD
    }

    fn now_ns(&self) -> i64 {
        expiry(self.number).woke_ns + self.stage.log().took_ns
    }

    fn name(&self) -> &'static str {
        "bench"
    }
}

pub(crate) fn parts(stage: &Stage) -> Parts<Stub> {
    Parts {
        timer: Box::new(Clock {
            stage: stage.clone(),
            number: 0,
        }),
        sensors: vec![Box::new(Probe(stage.clone()))],
        controller: Stub {
            stage: stage.clone(),
            dt_s: 0.0,
        },
        actuators: vec![
            Box::new(Arm(stage.clone(), 0)),
            Box::new(Arm(stage.clone(), 1)),
        ],
    }
}

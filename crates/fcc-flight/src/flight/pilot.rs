//! The controller of the loop: the autopilot, whose outputs an experiment or a
//! test may replace.

use std::fmt;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Controller, Flags, Notice, Reading, ReadingSet, Switch, Tick};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, Setpoints};
use fcc_navigation::Estimate;

use super::control_override::ControlOverride;

/// The controller of a flight's loop.
pub struct Pilot {
    autopilot: Autopilot,
    control: Option<Box<dyn ControlOverride>>,
}

impl Pilot {
    /// An autopilot, and what replaces its outputs, if anything does.
    pub(super) fn new(autopilot: Autopilot, control: Option<Box<dyn ControlOverride>>) -> Self {
        #[cfg(feature = "fault-injection")]
        let control = control.or_else(super::injection::faulty_control);
        Self { autopilot, control }
    }
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl Controller for Pilot {
    type Measurements = Measurements;
    type Estimate = Estimate;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Command = AutopilotCommand;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        Controller::estimate(&mut self.autopilot, tick, measurements);
    }

    fn engage_inhibits(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.engage_inhibits(tick, measurements)
    }

    fn faults(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.faults(tick, measurements)
    }

    fn conditions(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.conditions(tick, measurements)
    }

    fn must_release(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.must_release(tick, measurements)
    }

    fn releases_on_the_ground(&self) -> bool {
        self.autopilot.releases_on_the_ground()
    }

    /// A controller in place of the autopilot's is released at once: it is not
    /// known to level.
    fn prepare_release(&mut self, tick: &Tick, measurements: &Measurements) -> bool {
        self.control.is_none() && self.autopilot.prepare_release(tick, measurements)
    }

    fn is_ready_for_release(&self) -> bool {
        self.autopilot.is_ready_for_release()
    }

    fn is_taken_over(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.is_taken_over(tick, measurements)
    }

    fn withholds_outputs(&self, tick: &Tick, measurements: &Measurements) -> bool {
        self.autopilot.withholds_outputs(tick, measurements)
    }

    fn failsafe_goes_on(&self) -> bool {
        self.autopilot.failsafe_goes_on()
    }

    fn is_unattended(&self) -> bool {
        self.autopilot.is_unattended()
    }

    fn has_recovered(&self) -> bool {
        self.autopilot.has_recovered()
    }

    fn recover(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.recover(tick, measurements);
    }

    fn notices(&self) -> &[Notice] {
        self.autopilot.notices()
    }

    fn write_notice(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Autopilot::write_notice(notice, f)
    }

    fn flag_name(bit: u32) -> &'static str {
        Autopilot::flag_name(bit)
    }

    fn write_command(command: &AutopilotCommand, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Autopilot::write_command(command, f)
    }

    fn mode(&self) -> u8 {
        self.autopilot.mode()
    }

    fn mode_name(mode: u8) -> &'static str {
        Autopilot::mode_name(mode)
    }

    fn engage(&mut self, tick: &Tick, measurements: &Measurements) {
        if let Some(control) = &mut self.control {
            control.engage(tick);
        }
        self.autopilot.engage(tick, measurements);
    }

    fn warm_up(&self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.warm_up(tick, measurements);
    }

    fn guide(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.guide(tick, measurements);
    }

    fn control(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        let surfaces = self.autopilot.control(tick, measurements);
        match &mut self.control {
            None => surfaces,
            Some(control) => control.control(&self.autopilot, tick, measurements, surfaces),
        }
    }

    fn failsafe(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        self.autopilot.failsafe(tick, measurements)
    }

    fn disengage(&mut self) {
        self.autopilot.disengage();
    }

    fn command(&mut self, command: &AutopilotCommand) {
        self.autopilot.command(command);
    }

    fn estimated(&self) -> Estimate {
        self.autopilot.estimated()
    }

    fn setpoints(&self) -> Setpoints {
        self.autopilot.setpoints()
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        self.autopilot.outputs_are_valid(outputs)
    }

    fn observe_sensor(&mut self, sensor: u8, measurements: &Measurements) {
        self.autopilot.observe_sensor(sensor, measurements);
    }

    fn plausible(&self, sensor: u8, measurements: &Measurements) -> ReadingSet {
        self.autopilot.plausible(sensor, measurements)
    }

    fn of_one_sensor(&self) -> ReadingSet {
        self.autopilot.of_one_sensor()
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        self.autopilot.switch(measurements)
    }
}

// A controller for the examples in the documentation.
use fcc_core::framework::{Controller, Flags, Tick};

pub struct Heating;

impl Controller for Heating {
    type Measurements = f64;
    type Estimate = ();
    type Setpoints = f64;
    type Outputs = f64;
    type Command = f64;

    fn estimate(&mut self, _: &Tick, _: &f64) {}

    fn engage_inhibits(&self, _: &Tick, _: &f64) -> Flags {
        Flags::NONE
    }

    fn faults(&self, _: &Tick, _: &f64) -> Flags {
        Flags::NONE
    }

    fn flag_name(_: u32) -> &'static str {
        "the door is open"
    }

    fn engage(&mut self, _: &Tick, _: &f64) {}

    fn control(&mut self, _: &Tick, _: &f64) -> f64 {
        0.0
    }

    fn failsafe(&mut self, _: &Tick, _: &f64) -> f64 {
        0.0
    }

    fn setpoints(&self) -> f64 {
        21.0
    }

    fn outputs_are_valid(&self, _: &f64) -> bool {
        true
    }
}

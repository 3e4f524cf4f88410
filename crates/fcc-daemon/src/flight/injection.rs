//! Faults on purpose, for tests of what happens then. Only in programs built
//! with the feature `fault-injection`.
//!
//! The environment says what goes wrong:
//! - `FCCD_PANIC_AT_S`: so many seconds after engaging, control panics;
//! - `FCCD_NAN_AT_S`: so many seconds after engaging, control commands NaN;
//! - `FCCD_HANG_AT_S`: so many seconds after engaging, control never returns.

use std::fmt;
use std::time::Duration;

use fcc_core::flight::{Autopilot, Measurements, Order, Setpoints, Surfaces};
use fcc_core::framework::{Controller, Flags, Reading, Switch, Tick, Time};

/// An autopilot that goes wrong when it is told to.
#[derive(Debug)]
pub struct Faulty {
    autopilot: Autopilot,
    panic_at_s: Option<f64>,
    nan_at_s: Option<f64>,
    hang_at_s: Option<f64>,
    engaged_at: Time,
}

impl Faulty {
    /// Reads from the environment what is to go wrong.
    pub fn new(autopilot: Autopilot) -> Self {
        let seconds = |name: &str| std::env::var(name).ok()?.parse().ok();
        Self {
            autopilot,
            panic_at_s: seconds("FCCD_PANIC_AT_S"),
            nan_at_s: seconds("FCCD_NAN_AT_S"),
            hang_at_s: seconds("FCCD_HANG_AT_S"),
            engaged_at: Time::NEVER,
        }
    }

    fn is_due(&self, at_s: Option<f64>, tick: &Tick) -> bool {
        at_s.is_some_and(|at_s| tick.woke.since(self.engaged_at).as_secs_f64() >= at_s)
    }
}

impl Controller for Faulty {
    type Measurements = Measurements;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Order = Order;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        Controller::estimate(&mut self.autopilot, tick, measurements);
    }

    fn blockers(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.blockers(tick, measurements)
    }

    fn faults(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.autopilot.faults(tick, measurements)
    }

    fn flag_name(bit: u32) -> &'static str {
        Autopilot::flag_name(bit)
    }

    fn write_order(order: &Order, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Autopilot::write_order(order, f)
    }

    fn engage(&mut self, tick: &Tick, measurements: &Measurements) {
        self.engaged_at = tick.woke;
        self.autopilot.engage(tick, measurements);
    }

    fn guide(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.guide(tick, measurements);
    }

    fn control(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        assert!(!self.is_due(self.panic_at_s, tick), "injected panic");
        while self.is_due(self.hang_at_s, tick) {
            // One that span under SCHED_FIFO would take the whole CPU with it.
            std::thread::sleep(Duration::from_millis(10));
        }
        let mut surfaces = self.autopilot.control(tick, measurements);
        if self.is_due(self.nan_at_s, tick) {
            surfaces.elevator = f64::NAN;
        }
        surfaces
    }

    fn failsafe(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        self.autopilot.failsafe(tick, measurements)
    }

    fn disengage(&mut self) {
        self.autopilot.disengage();
    }

    fn command(&mut self, order: &Order) {
        self.autopilot.command(order);
    }

    fn setpoints(&self) -> Setpoints {
        self.autopilot.setpoints()
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        self.autopilot.outputs_are_valid(outputs)
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        self.autopilot.switch(measurements)
    }
}

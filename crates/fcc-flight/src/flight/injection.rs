//! Fault injection for tests. Only in programs built with the feature
//! `fault-injection`.
//!
//! The environment selects the fault:
//! - `FCCD_PANIC_AT_S`: this many seconds after engaging, control panics;
//! - `FCCD_NAN_AT_S`: this many seconds after engaging, control commands NaN;
//! - `FCCD_HANG_AT_S`: this many seconds after engaging, control never returns;
//! - `FCCD_SLOW_AT_S`: this many seconds after engaging, control begins to take
//!   `FCCD_SLOW_MS` longer, in `FCCD_SLOW_TICKS` ticks (all, if not given);
//! - `FCCD_BLOCK_AT_S`: this many seconds after the first tick, a sensor
//!   blocks;
//! - `FCCD_PAUSE_AT_S`: this many seconds after the loop's start, its messages
//!   are not read, for `FCCD_PAUSE_S` (for ever, if not given).

use std::fmt;
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::flight::navigation::Estimate;
use fcc_core::flight::{Autopilot, AutopilotCommand, Measurements, Setpoints, Surfaces};
use fcc_core::framework::{Controller, Flags, Reading, Sensor, SensorFault, Switch, Tick, Time};

/// An autopilot with injected faults.
#[derive(Debug)]
pub struct Faulty {
    autopilot: Autopilot,
    panic_at_s: Option<f64>,
    nan_at_s: Option<f64>,
    hang_at_s: Option<f64>,
    slow: Slow,
    engaged_at: Time,
}

/// An injected delay of control.
#[derive(Debug)]
struct Slow {
    at_s: Option<f64>,
    by: Duration,
    ticks_left: u64,
}

impl Slow {
    fn from_environment() -> Self {
        Self {
            at_s: number("FCCD_SLOW_AT_S"),
            by: Duration::from_secs_f64(number("FCCD_SLOW_MS").unwrap_or(0.0) * 1e-3),
            ticks_left: number("FCCD_SLOW_TICKS").map_or(u64::MAX, |ticks| ticks as u64),
        }
    }

    fn take_longer(&mut self) {
        if self.ticks_left > 0 {
            self.ticks_left -= 1;
            thread::sleep(self.by);
        }
    }
}

/// A sensor without readings that blocks at a given time.
#[derive(Debug)]
pub(super) struct Blocking {
    at_s: Option<f64>,
    began: Time,
}

impl Default for Blocking {
    /// Reads the time of blocking from the environment.
    fn default() -> Self {
        Self {
            at_s: number("FCCD_BLOCK_AT_S"),
            began: Time::NEVER,
        }
    }
}

impl Sensor<Measurements> for Blocking {
    fn sample(&mut self, tick: &Tick, _: &mut Measurements) -> Result<(), SensorFault> {
        if self.began.is_never() {
            self.began = tick.woke;
        }
        let since_s = tick.woke.since(self.began).as_secs_f64();
        if self.at_s.is_some_and(|at_s| since_s >= at_s) {
            thread::sleep(Duration::from_secs(3_600));
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "injection"
    }
}

/// An injected pause of the main thread, which reads no messages meanwhile.
#[derive(Debug)]
pub(super) struct Pause {
    at_s: Option<f64>,
    begun: Instant,
}

impl Pause {
    pub(super) fn from_environment() -> Self {
        Self {
            at_s: number("FCCD_PAUSE_AT_S"),
            begun: Instant::now(),
        }
    }

    /// Waits when it is due.
    pub(super) fn look(&mut self) {
        if self
            .at_s
            .take_if(|at_s| self.begun.elapsed().as_secs_f64() >= *at_s)
            .is_some()
        {
            thread::sleep(Duration::from_secs_f64(
                number("FCCD_PAUSE_S").unwrap_or(3_600.0),
            ));
        }
    }
}

fn number(name: &str) -> Option<f64> {
    std::env::var(name).ok()?.parse().ok()
}

impl Faulty {
    /// Reads the faults from the environment.
    pub fn new(autopilot: Autopilot) -> Self {
        Self {
            autopilot,
            panic_at_s: number("FCCD_PANIC_AT_S"),
            nan_at_s: number("FCCD_NAN_AT_S"),
            hang_at_s: number("FCCD_HANG_AT_S"),
            slow: Slow::from_environment(),
            engaged_at: Time::NEVER,
        }
    }

    fn is_due(&self, at_s: Option<f64>, tick: &Tick) -> bool {
        at_s.is_some_and(|at_s| tick.woke.since(self.engaged_at).as_secs_f64() >= at_s)
    }
}

impl Controller for Faulty {
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
        self.engaged_at = tick.woke;
        self.autopilot.engage(tick, measurements);
    }

    fn warm_up(&self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.warm_up(tick, measurements);
    }

    fn guide(&mut self, tick: &Tick, measurements: &Measurements) {
        self.autopilot.guide(tick, measurements);
    }

    fn control(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        assert!(!self.is_due(self.panic_at_s, tick), "injected panic");
        while self.is_due(self.hang_at_s, tick) {
            std::hint::spin_loop();
        }
        if self.is_due(self.slow.at_s, tick) {
            self.slow.take_longer();
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

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        self.autopilot.switch(measurements)
    }
}
